// Pixel filters by importance sampling: a sample is moved inside its filter instead of being splatted, so it belongs to one pixel alone.
#pragma once

#include "terrain/math/vec.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// A separable, non-negative filter around a pixel's centre. Every sample has weight 1. Immutable, thread-safe.
class Filter
{
public:
    /// `kind`: "box", "gaussian" or "blackman-harris". `width`: diameter in pixels; 0 takes the kind's own (default_width).
    /// Throws Error (scene) on an unknown kind or a width that is negative or not finite.
    explicit Filter(const std::string& kind = "blackman-harris", double width = 0.0);

    /// Offset from the pixel's centre, in pixels, distributed as the filter. `u` in [0, 1)^2.
    Vec2d sample(const Vec2d& u) const { return Vec2d(offset(u.x), offset(u.y)); }

    /// Density of one coordinate of sample() at `x` pixels from the centre.
    double density(double x) const;

    double width() const { return width_; }
    static double default_width(const std::string& kind);

private:
    double offset(double u) const;

    double width_;
    std::vector<double> quantiles_;  ///< offsets in pixels of equal shares of the filter; the density is constant between
};

}  // namespace hoodoo
