// A dielectric boundary, smooth or of GGX facets (Walter2007), whose visible facets are sampled (Heitz2018a, by the caps of Dupuy2023).
//
// For a facet m between wo and wi, with D(m) of GGX, Smith's heights correlated, G2 = 1 / (1 + L(wo) + L(wi)), and c = cosine with the normal,
//     reflected:  f cos = F D G2 / (4 c_o),            m = (wo + wi) / |.|
//     refracted:  f cos = (1 - F) D G2 |wo.m| |wi.m| eta^2 / (c_o (wo.m + eta wi.m)^2),   m = -(wo + eta wi) / |.|
// in basic radiance: Walter2007 (21) times n_i^2 / n_o^2. A sample draws m from the facets that wo sees, D G1 (wo.m) / c_o, then Fresnel, then keeps
// the direction with the probability G2 / G1: what is kept has exactly the density f cos and weight 1. What is not kept has met another facet.
// Deviation: such light leaves in the direction it had, mirrored at the surface where it would go through it; weight 1, density infinity, so that
// only what its ray meets lights it. A walk from facet to facet (Heitz2016) would spread it wider; here no energy is lost at the price of that shape.
// The shading normal is turned towards wo where wo is below it. Reciprocity: f eta-weighted holds for the kept part with one normal.
#include "renderer/shading/dielectric.h"

#include "renderer/shading/coat.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

/// Cosine with the view below which the shading normal is turned: facets seen from further behind would be seen through the surface.
constexpr double kGrazing = 1e-3;

struct Facets {
    double alpha;

    double distribution(double cos_m) const
    {
        const double t = 1.0 + cos_m * cos_m * (alpha * alpha - 1.0);
        return alpha * alpha / (kPi * t * t);
    }
    double lambda(double cosine) const
    {
        const double c2 = cosine * cosine, tan2 = std::max(0.0, 1.0 - c2) / c2;
        return 0.5 * (std::sqrt(1.0 + alpha * alpha * tan2) - 1.0);
    }
    /// A facet as wo (local, z up) sees them.
    Vec3d visible(const Vec3d& wo, double u, double v) const
    {
        const Vec3d stretched = Vec3d(alpha * wo.x, alpha * wo.y, wo.z).normalized();
        const double z = (1.0 - v) * (1.0 + stretched.z) - stretched.z, sine = std::sqrt(std::clamp(1.0 - z * z, 0.0, 1.0)), angle = 2.0 * kPi * u;
        const Vec3d h = Vec3d(sine * std::cos(angle), sine * std::sin(angle), z) + stretched;
        return Vec3d(alpha * h.x, alpha * h.y, std::max(h.z, 1e-12)).normalized();
    }
};

}  // namespace

Vec3d refracted(const Vec3d& wo, const Vec3d& m, double eta)
{
    const double c = wo.dot(m), inside2 = 1.0 - (1.0 - c * c) / (eta * eta);
    if (!(inside2 > 0.0)) return Vec3d(0.0);
    return (m * (c / eta - std::sqrt(inside2)) - wo / eta).normalized();
}

Vec3d Dielectric::normal_towards(const Vec3d& wo) const
{
    const double c = wo.dot(s_);
    if (c >= kGrazing) return s_;
    return (s_ + wo * (kGrazing - c)).normalized();
}

BsdfValue Dielectric::evaluate(const Vec3d& wo, const Vec3d& wi) const
{
    if (alpha_ == 0.0) return {};
    const Vec3d n = normal_towards(wo);
    const double co = wo.dot(n), ci = wi.dot(n), side = wi.dot(g_);
    const bool reflects = side > 0.0;
    if (co <= 0.0 || ci == 0.0 || reflects != (ci > 0.0)) return {};

    Vec3d m = reflects ? wo + wi : -(wo + wi * eta_);
    const double length = m.length();
    if (!(length > 0.0)) return {};
    m /= length;
    if (m.dot(n) < 0.0) m = -m;
    const double om = wo.dot(m), im = wi.dot(m);
    if (!(om > 0.0) || reflects != (im > 0.0)) return {};

    const Facets facets{alpha_};
    const double mirror = fresnel_dielectric(om, eta_);
    const double dg = facets.distribution(m.dot(n)) / (1.0 + facets.lambda(co) + facets.lambda(ci));
    double value = 0.0;
    if (reflects) {
        value = mirror * dg / (4.0 * co);
    } else {
        const double path = om + eta_ * im;
        value = (1.0 - mirror) * dg * om * -im * eta_ * eta_ / (co * path * path);
    }
    return {Vec3f(static_cast<float>(value)), value};
}

BsdfSample Dielectric::sample(const Vec3d& wo, const std::array<double, 3>& u) const
{
    const Vec3d n = normal_towards(wo);
    Vec3d m = n, tangent, bitangent;
    const Facets facets{alpha_};
    if (alpha_ > 0.0) {
        orthonormal_frame(n, tangent, bitangent);
        const Vec3d local = facets.visible(Vec3d(wo.dot(tangent), wo.dot(bitangent), wo.dot(n)), u[0], u[1]);
        m = tangent * local.x + bitangent * local.y + n * local.z;
    }
    const double om = wo.dot(m), mirror = fresnel_dielectric(om, eta_);
    Vec3d wi = refracted(wo, m, eta_);
    const bool reflects = u[2] < mirror || wi == Vec3d(0.0);
    if (reflects) wi = m * (2.0 * om) - wo;
    const double side = reflects ? 1.0 : -1.0;

    // Kept: a single facet, both ends in the open.
    if (alpha_ > 0.0 && wi.dot(n) * side > 0.0 && wi.dot(g_) * side > 0.0) {
        const double again = reflects ? u[2] / mirror : (u[2] - mirror) / (1.0 - mirror);
        const double lo = facets.lambda(wo.dot(n)), li = facets.lambda(wi.dot(n));
        if (again * (1.0 + lo + li) < 1.0 + lo) {
            const double pdf = evaluate(wo, wi).pdf;
            if (pdf > 0.0) return {wi, Vec3f(1.0f), pdf};
        }
    }
    if (wi.dot(g_) * side < 0.0) wi -= g_ * (2.0 * wi.dot(g_));
    BsdfSample out{wi, Vec3f(1.0f), kInfinity};
    out.stray = alpha_ > 0.0;
    return out;
}

}  // namespace hoodoo
