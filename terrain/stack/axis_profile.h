// The field of a layer stack along a vertical line, whole: what editing asks, column by column.
#pragma once

#include "terrain/stack/material_stack.h"

#include <span>
#include <vector>

namespace hoodoo
{

/// f along the vertical line through (x, y): linear between knots, constant beyond the first and the last. NEGATIVE INSIDE matter.
/// Heights are in units above the stack's origin, fractions allowed. At least one knot. Immutable, thread-safe.
class AxisProfile
{
public:
    struct Knot {
        double z, f;
    };

    /// x and y in cells of the stack: (i + 0.5, j + 0.5) is the axis of column (i, j). `sigma` in metres, > 0, as ConvolutionField's.
    AxisProfile(const Ground& ground, double sigma, double x, double y);

    double at(double z) const;
    std::span<const Knot> knots() const { return knots_; }

    /// All heights at which the side changes (matter is f < 0), ascending. Exact up to rounding: one linear root a change.
    std::vector<double> roots() const;

private:
    std::vector<Knot> knots_;
};

}  // namespace hoodoo
