// Fresnel's share F(wo.s) of the light goes by the mirror about the shading normal s, the rest by the matte base:
//     f(wo, wi) cos = (1 - c F(wo)) f_base(wo, wi) cos,   and with the probability c F(wo) the mirrored direction, of weight 1.
// The sum of the two is c F + (1 - c F) rho: albedo 1 loses nothing, for any two normals. A mirrored direction that a bent normal sends below the
// surface is mirrored at the surface itself, which loses nothing either.
// Deviations: light that enters the film is not weighted by 1 - F(wi), so the base is not reciprocal (a low sun lights the bed of a lake a little too
// well); light reflected inside the film is part of the base's albedo. For wet ground and opaque water; water with a depth is a Dielectric.
#include "renderer/shading/coat.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

double fresnel_dielectric(double cosine, double eta)
{
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double g = std::sqrt(std::max(0.0, eta * eta - 1.0 + c * c));  // eta times the cosine beyond; 0 where reflection is total
    const double parallel = (eta * eta * c - g) / (eta * eta * c + g), across = (c - g) / (c + g);
    return 0.5 * (parallel * parallel + across * across);
}

double Coated::mirrored(const Vec3d& wo) const
{
    return coat_ * fresnel_dielectric(wo.dot(lobe_.shading()), kWaterIndex);
}

BsdfValue Coated::evaluate(const Vec3d& wo, const Vec3d& wi) const
{
    const double through = 1.0 - mirrored(wo);
    const BsdfValue base = base_.evaluate(wo, wi);
    return {base.value * static_cast<float>(through), base.pdf * through};
}

BsdfSample Coated::sample(const Vec3d& wo, const std::array<double, 3>& u) const
{
    const double mirror = mirrored(wo);
    if (u[2] < mirror) {
        const Vec3d& s = lobe_.shading();
        const Vec3d& g = lobe_.geometric();
        Vec3d wi = s * (2.0 * wo.dot(s)) - wo;
        if (wi.dot(g) < 0.0) wi -= g * (2.0 * wi.dot(g));
        return {wi, Vec3f(1.0f), kInfinity};
    }
    BsdfSample base = base_.sample(wo, {u[0], u[1], (u[2] - mirror) / (1.0 - mirror)});
    base.pdf *= 1.0 - mirror;
    return base;
}

}  // namespace hoodoo
