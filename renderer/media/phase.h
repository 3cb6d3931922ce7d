// Where light goes after a droplet: forward by a single number, the mean cosine (Henyey1941).
#pragma once

#include "terrain/math/vec.h"

namespace hoodoo
{

/// A phase function that integrates to one over the sphere. Directions point away from the point: light that goes on straight has wi = -wo.
class HenyeyGreenstein
{
public:
    /// `asymmetry`: mean cosine, in (-1, 1); 0 is even.
    explicit HenyeyGreenstein(double asymmetry) : g_(asymmetry) {}

    double value(const Vec3d& wo, const Vec3d& wi) const;  ///< 1/sr, also the density of sample()
    Vec3d sample(const Vec3d& wo, const Vec2d& u) const;   ///< `u` in [0, 1)^2

private:
    double g_;
};

}  // namespace hoodoo
