// All that is between the surfaces of a scene: haze, regions of foam and mist, and what fills the bodies that light passes through.
#pragma once

#include "renderer/media/haze.h"
#include "renderer/media/region.h"

#include <optional>
#include <vector>

namespace hoodoo
{

/// The inside of a body with a surface that reflects and refracts: water.
struct Interior {
    double ior = 1.333;
    bool smooth = true;  ///< no roughness of its own: the sun is looked for through it (transport/manifold.h)
    Coefficients medium;
};

/// What happened to a path on a piece of its way.
struct Passage {
    double t = kInfinity;  ///< metres: where it scattered, or the end of the way
    bool scattered = false;
    Vec3f weight{1.0f};      ///< factor of the path's throughput
    double asymmetry = 0.0;  ///< of the scattering
};

/// Immutable after the scene is built, thread-safe. Media add up: a collision is the first of theirs. Haze is where there is air, regions everywhere.
class Media
{
public:
    std::optional<Haze> haze;
    std::vector<Region> regions;

    bool empty() const { return !haze && regions.empty(); }

    /// The first `t_max` metres of the ray, in `inside` or in air (nullptr). `u` in [0, 1)^2 for the even media, `random` for the regions.
    Passage pass(const Ray& ray, double t_max, const Interior* inside, const Vec2d& u, NumberStream& random) const;

    /// An unbiased estimate of the share of light that passes.
    Vec3f transmittance(const Ray& ray, double t_max, const Interior* inside, NumberStream& random) const;

    /// Over all regions; 0 if their bounds hold.
    std::uint64_t samples_above_bound() const;
};

}  // namespace hoodoo
