// What floats in the air or lies on water without a surface of its own: droplets and bubbles, as a density with proved upper bounds.
#pragma once

#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

namespace hoodoo
{

/// A density of space and time. Pure and thread-safe. Points in metres, world space; time as Ray::time (0 and 1: the shutter's opening and closing).
class Density
{
public:
    virtual ~Density() = default;

    /// >= 0 and at most 1: the share of the medium's full density at `p`. 0 outside bounds().
    virtual double value(const Vec3d& p, double time) const = 0;

    /// A proved upper bound of value() over the box and the times; what delta tracking takes as its majorant.
    virtual double majorant(const Box3d& box, const Interval& times) const = 0;

    /// Encloses every point of density above 0; finite.
    virtual Box3d bounds() const = 0;
};

}  // namespace hoodoo
