// Matte surfaces: Lambert, and a rough diffuse model that loses no energy; both around a normal that may differ from the surface's own.
#pragma once

#include "terrain/math/vec.h"

#include <array>

namespace hoodoo
{

/// A cosine lobe around the shading normal that stays above the surface and loses nothing. Its density over solid angle is
///     p(w) = (min(max(w.s, 0), k max(w.g, 0)) + l max(w.g, 0)) / pi,    s shading, g geometric normal, k = 2,
/// and l such that it integrates to one over the geometric hemisphere. With s = g it is the cosine lobe. It is continuous and goes to zero at the
/// horizon of the geometry: no light leaks through, and the shadow's edge on a smoothed surface fades instead of breaking off.
class CosineLobe
{
public:
    CosineLobe(const Vec3d& shading, const Vec3d& geometric);

    double density(const Vec3d& w) const;  ///< per steradian; 0 below the geometric horizon
    /// Distributed as density(); `u` in [0, 1)^3.
    Vec3d sample(const std::array<double, 3>& u) const;

    const Vec3d& shading() const { return s_; }
    const Vec3d& geometric() const { return g_; }

private:
    Vec3d s_, g_;
    double lost_ = 0.0;  ///< l
    bool tilted_ = false;
};

struct BsdfValue {
    Vec3f value{0.0f};  ///< BSDF times cosine, 1/sr: what radiance from wi is multiplied by
    double pdf = 0.0;   ///< of sample(), per steradian
};

struct BsdfSample {
    Vec3d direction{0.0};
    Vec3f weight{0.0f};  ///< value / pdf
    double pdf = 0.0;    ///< 0: no sample (the rounding of a direction on the horizon)
    bool stray = false;  ///< spread, though of density infinity: no mirror image of what it meets
};

class Lambert
{
public:
    Lambert(const CosineLobe& lobe, const Vec3f& albedo) : lobe_(lobe), albedo_(albedo) {}
    /// Zero if wi is below the geometric surface. Precondition: wo is above it.
    BsdfValue evaluate(const Vec3d& wo, const Vec3d& wi) const;
    BsdfSample sample(const Vec3d& wo, const std::array<double, 3>& u) const;

private:
    CosineLobe lobe_;
    Vec3f albedo_;
};

/// `albedo` is the single-scattering albedo of the facets, `roughness` in [0, 1].
class RoughDiffuse
{
public:
    RoughDiffuse(const CosineLobe& lobe, const Vec3f& albedo, float roughness);
    BsdfValue evaluate(const Vec3d& wo, const Vec3d& wi) const;
    BsdfSample sample(const Vec3d& wo, const std::array<double, 3>& u) const;

    /// pi times the BSDF for cosines mu_i, mu_o in (0, 1] with the shading normal and `c` between the directions.
    Vec3f shape(double mu_i, double mu_o, double c) const;

private:
    double even_share(double mu_o) const;
    double escape_probability(double mu) const;  ///< the directional albedo of the single-scattering lobe for albedo 1

    CosineLobe lobe_;
    Vec3f albedo_, multiple_;  ///< multiple_: colour of the multiple-scattering lobe over its normalisation
    double roughness_, a_;
};

/// The unit square -> the cosine-weighted hemisphere around z; strata stay connected (Shirley1997).
Vec3d cosine_hemisphere(double u, double v);

}  // namespace hoodoo
