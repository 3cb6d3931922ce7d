// What an implicit function answers. NEGATIVE INSIDE matter, so the gradient points to air, everywhere.
#pragma once

#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

#include <array>

namespace hoodoo
{

/// An implicit function of space with proved bounds; matter is where value < 0. Pure and thread-safe. Points in metres, world space.
class Field
{
public:
    virtual ~Field() = default;

    /// The function at `p` (its unit is the field's own; a convolution field has none, it lies in [-1, 1]).
    virtual double value(const Vec3d& p) const = 0;

    /// Its gradient, per metre; one-sided where the function is only C0.
    virtual Vec3d gradient(const Vec3d& p) const = 0;

    /// A proved upper bound of |value(p) - value(q)| / |p - q| over all p, q on the segment.
    virtual double slope_bound(const Segment& segment) const = 0;

    /// A proved enclosure of the values over the box.
    virtual Interval range(const Box3d& box) const = 0;

    /// Encloses all matter that can be hit; may be infinite.
    virtual Box3d bounds() const = 0;

    /// Proved enclosures of the gradient's components over the box, one-sided gradients included. The default knows nothing.
    virtual std::array<Interval, 3> gradient_range(const Box3d&) const
    {
        return {Interval{-kInfinity, kInfinity}, Interval{-kInfinity, kInfinity}, Interval{-kInfinity, kInfinity}};
    }

    /// A proved upper bound of |gradient(p) - gradient(q)| / |p - q| in the box; infinite where the gradient jumps or nothing is known.
    virtual double curvature_bound(const Box3d&) const { return kInfinity; }
};

}  // namespace hoodoo
