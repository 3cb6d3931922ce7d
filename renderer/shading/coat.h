// A matte surface under a smooth film of water: a mirror where Fresnel says so, the matte surface for the rest.
#pragma once

#include "renderer/shading/diffuse.h"

namespace hoodoo
{

/// Unpolarised reflectance of a smooth boundary; `eta`: refractive index beyond it over that on this side, `cosine` in [0, 1] with the normal on this
/// side. 1 where reflection is total.
double fresnel_dielectric(double cosine, double eta);

/// Index of water in the middle of the visible spectrum at 20 degrees (Hale1973).
constexpr double kWaterIndex = 1.333;

/// The mirror is ideal: evaluate() does not know it, sample() finds it with the density infinity, as a camera ray has. What its direction meets is
/// lit as if the path had gone on undisturbed.
class Coated
{
public:
    /// `coat` in [0, 1]: the share of the surface under the film.
    Coated(const CosineLobe& lobe, const Vec3f& albedo, float coat) : lobe_(lobe), base_(lobe, albedo), coat_(coat) {}

    /// Of the matte part. Zero if wi is below the geometric surface. Precondition: wo is above it.
    BsdfValue evaluate(const Vec3d& wo, const Vec3d& wi) const;
    BsdfSample sample(const Vec3d& wo, const std::array<double, 3>& u) const;

    double mirrored(const Vec3d& wo) const;  ///< share of the light towards wo that the film reflects

private:
    CosineLobe lobe_;
    Lambert base_;
    double coat_;
};

}  // namespace hoodoo
