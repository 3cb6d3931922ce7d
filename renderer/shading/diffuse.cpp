// Diffuse reflection: Lambert, and the energy-preserving Oren-Nayar model EON (Portsmouth2025).
//
// EON, with s = cos(wi, wo) - mu_i mu_o, t = max(mu_i, mu_o) if s > 0 else 1, roughness r, albedo rho:
//     f_single = rho / pi A (1 + r s / t),                            A = 1 / (1 + (1/2 - 2 / (3 pi)) r)
//     E(mu)    = A (1 + r G(mu) / pi),                                G(mu) = sin (th - sin cos) + 2/3 (tan (1 - sin^3) - sin)
//     E_mean   = A (1 + (2/3 - 28 / (15 pi)) r)
//     f_multi  = rho' / pi (1 - E(mu_i)) (1 - E(mu_o)) / (1 - E_mean),  rho' = rho^2 E_mean / (1 - rho (1 - E_mean))
// Albedo 1 loses nothing at any roughness. Deviation: sampled by the cosine lobe and, at grazing angles, by an even share,
// not by the paper's clipped transform; a weight is at most 7 and rarely over 2.
//
// Two normals. A shading normal s that differs from the geometric g breaks two things: directions of the lobe fall below the surface (lost light),
// and directions below the horizon of g but above that of s are cut off hard (the terminator; Hanika2021 shows the cases, Chiang2019 fades them at
// the price of energy). Here the lobe is capped by k times the geometric cosine and what the cap takes is given back as a cosine lobe around g:
//     p = (min(w.s, k w.g)+ + l (w.g)+) / pi.
// The loss has a closed form: the plane w.(s - k g) = 0 separates the parts, the projected area of a half disc cut by a plane of normal m is
// pi/2 (1 + m.n), so with d = |s - k g|:
//     integral of min / pi = (k (1 + (s.g - k) / d) + 1 - (1 - k s.g) / d) / 2 = (k + 1 - d) / 2,       l = (1 - k + d) / 2.
// k = 2: a facet may catch at most twice the light of the flat surface; k = 1 would flatten bumps in low sun, k = infinity is the hard edge.
// As with every shading normal the model is not reciprocal where s and g differ.

#include "renderer/shading/diffuse.h"

#include "terrain/math/hash.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kCap = 2.0;  // k

/// Cosines of directions on the horizon, where the rough model divides by them.
constexpr double kSmallestCosine = 1e-4;

Vec3d around(const Vec3d& normal, const Vec3d& local)
{
    Vec3d tangent, bitangent;
    orthonormal_frame(normal, tangent, bitangent);
    return tangent * local.x + bitangent * local.y + normal * local.z;
}

}  // namespace

Vec3d cosine_hemisphere(double u, double v)
{
    const double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0;
    double radius = 0.0, angle = 0.0;
    if (std::abs(a) > std::abs(b)) {
        radius = a;
        angle = 0.25 * kPi * (b / a);
    } else if (b != 0.0) {
        radius = b;
        angle = 0.5 * kPi - 0.25 * kPi * (a / b);
    }
    const double x = radius * std::cos(angle), y = radius * std::sin(angle);
    return Vec3d(x, y, std::sqrt(std::max(0.0, 1.0 - radius * radius)));
}

CosineLobe::CosineLobe(const Vec3d& shading, const Vec3d& geometric) : s_(shading), g_(geometric)
{
    tilted_ = s_ != g_;
    if (tilted_) lost_ = std::max(0.0, 0.5 * (1.0 - kCap + (s_ - g_ * kCap).length()));
}

double CosineLobe::density(const Vec3d& w) const
{
    const double cos_g = w.dot(g_);
    if (!(cos_g > 0.0)) return 0.0;
    if (!tilted_) return cos_g / kPi;
    return (std::clamp(w.dot(s_), 0.0, kCap * cos_g) + lost_ * cos_g) / kPi;
}

Vec3d CosineLobe::sample(const std::array<double, 3>& u) const
{
    const Vec3d w = around(s_, cosine_hemisphere(u[0], u[1]));
    if (!tilted_) return w;

    // What the cap rejects has the mass l and is drawn anew around the geometric normal.
    const double cos_s = w.dot(s_), keep = std::max(0.0, kCap * w.dot(g_));
    if (u[2] * cos_s < keep) return w;
    const double accept = keep / cos_s;
    const double again = std::clamp((u[2] - accept) / (1.0 - accept), 0.0, 1.0);
    const double fresh = unit_real(hash_combine(std::bit_cast<std::uint64_t>(u[0]), std::bit_cast<std::uint64_t>(u[1])));
    return around(g_, cosine_hemisphere(again, fresh));
}

BsdfValue Lambert::evaluate(const Vec3d&, const Vec3d& wi) const
{
    const double density = lobe_.density(wi);
    return {albedo_ * static_cast<float>(density), density};
}

BsdfSample Lambert::sample(const Vec3d&, const std::array<double, 3>& u) const
{
    const Vec3d wi = lobe_.sample(u);
    return {wi, albedo_, lobe_.density(wi)};
}

RoughDiffuse::RoughDiffuse(const CosineLobe& lobe, const Vec3f& albedo, float roughness) : lobe_(lobe), albedo_(albedo), roughness_(roughness)
{
    a_ = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * kPi)) * roughness_);
    const double mean = a_ * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * kPi)) * roughness_);
    for (int k = 0; k < 3; ++k) {
        const double rho = albedo_[k];
        multiple_[k] = static_cast<float>(rho * rho * mean / ((1.0 - rho * (1.0 - mean)) * std::max(1e-12, 1.0 - mean)));
    }
}

double RoughDiffuse::escape_probability(double mu) const
{
    const double si = std::sqrt(std::max(0.0, 1.0 - mu * mu));
    const double g = si * (std::acos(std::min(1.0, mu)) - si * mu) + 2.0 / 3.0 * (si / mu * (1.0 - si * si * si) - si);
    return a_ * (1.0 + roughness_ * g / kPi);
}

Vec3f RoughDiffuse::shape(double mu_i, double mu_o, double c) const
{
    const double s = c - mu_i * mu_o;
    const double t = s > 0.0 ? std::max(mu_i, mu_o) : 1.0;
    const double single = a_ * (1.0 + roughness_ * s / t);
    const double multi = (1.0 - escape_probability(mu_i)) * (1.0 - escape_probability(mu_o));
    return albedo_ * static_cast<float>(single) + multiple_ * static_cast<float>(multi);
}

/// Share of samples that are spread evenly: at grazing angles the model looks back along wo with values that a cosine lobe would meet too rarely.
double RoughDiffuse::even_share(double mu_o) const
{
    return 0.3 * roughness_ * (1.0 - mu_o) * (1.0 - mu_o);
}

BsdfValue RoughDiffuse::evaluate(const Vec3d& wo, const Vec3d& wi) const
{
    const double density = lobe_.density(wi);
    if (density == 0.0) return {};
    // The cosine of wi is the one the lobe has given it: its own could be small where the lobe is not, and the model divides by it.
    const double mu_i = std::clamp(kPi * density, kSmallestCosine, 1.0), mu_o = std::clamp(wo.dot(lobe_.shading()), kSmallestCosine, 1.0);
    const double even = even_share(mu_o);
    return {shape(mu_i, mu_o, wi.dot(wo)) * static_cast<float>(density), (1.0 - even) * density + even / (2.0 * kPi)};
}

BsdfSample RoughDiffuse::sample(const Vec3d& wo, const std::array<double, 3>& u) const
{
    const double even = even_share(std::clamp(wo.dot(lobe_.shading()), kSmallestCosine, 1.0));
    Vec3d wi;
    if (u[2] < even) {
        const double sine = std::sqrt(u[0] * (2.0 - u[0])), angle = 2.0 * kPi * u[1];
        wi = around(lobe_.geometric(), Vec3d(sine * std::cos(angle), sine * std::sin(angle), 1.0 - u[0]));
    } else {
        wi = lobe_.sample({u[0], u[1], (u[2] - even) / (1.0 - even)});
    }
    const BsdfValue value = evaluate(wo, wi);
    if (value.pdf == 0.0) return {};
    return {wi, value.value / static_cast<float>(value.pdf), value.pdf};
}

}  // namespace hoodoo
