// The surface of something light passes through: it reflects and refracts, sharply or by facets too small to see.
#pragma once

#include "renderer/shading/diffuse.h"

namespace hoodoo
{

/// Radiance is counted as basic radiance, L / n^2, which a boundary changes by nothing but Fresnel's share: paths need no factor n^2, and lights,
/// which are in air, none either. Loses nothing for any roughness and any two normals.
class Dielectric
{
public:
    /// `shading`, `geometric`: unit, in one hemisphere, geometric on wo's side. `eta`: refractive index beyond the surface over that on wo's side.
    /// `roughness`: root mean square slope of the facets (alpha of GGX); under kSmooth the surface is ideal and evaluate() knows nothing of it.
    Dielectric(const Vec3d& shading, const Vec3d& geometric, double eta, double roughness)
        : s_(shading), g_(geometric), eta_(eta), alpha_(roughness < kSmooth ? 0.0 : roughness)
    {
    }

    /// Light that takes one facet, reflected or refracted; wi on either side. The density is that of such samples and equals the value.
    BsdfValue evaluate(const Vec3d& wo, const Vec3d& wi) const;
    /// Weight 1. A smooth surface samples with the density infinity; a rough one too where light met several facets, and then says so: `stray`.
    BsdfSample sample(const Vec3d& wo, const std::array<double, 3>& u) const;

    static constexpr double kSmooth = 1e-3;  ///< a twentieth of a degree

private:
    Vec3d normal_towards(const Vec3d& wo) const;

    Vec3d s_, g_;
    double eta_, alpha_;
};

/// The direction into which light from `wo` goes beyond a boundary with normal `m` (m.wo > 0), `eta` as above; zero if it is reflected totally. Unit.
Vec3d refracted(const Vec3d& wo, const Vec3d& m, double eta);

}  // namespace hoodoo
