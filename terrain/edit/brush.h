// The point primitive of sculpting, met along the axis of a column.
#pragma once

#include "terrain/stack/axis_profile.h"

#include <vector>

namespace hoodoo
{

/// A ball of influence over one column. Lengths are in units of height of the stack.
struct Brush {
    double centre = 0.0;    ///< height of the ball's centre
    double radius = 0.0;    ///< R > 0
    double distance = 0.0;  ///< of the column's axis from the centre
    bool adds = true;       ///< matter; otherwise it takes it away

    /// g(r) = (1 - (r/R)^2)^2 inside the ball, 0 outside (Peytavie2009, section 4.1), at height z of the axis.
    double potential(double z) const;
};

/// All heights in the ball at which f~ = f - g (adding) or f + g (taking away) changes its side, ascending. Each is isolated between extremes of f~
/// and found to the last bits: none is missed except a pair that rounding cannot tell from a touch.
std::vector<double> brushed_roots(const AxisProfile& f, const Brush& brush);

/// A piece of the axis that changes its side; lower < upper. `lower_is_old` says that its lower end lies where f itself changes its side, not where
/// f~ does or the ball ends; likewise `upper_is_old`.
struct BrushedPiece {
    double lower, upper;
    bool lower_is_old, upper_is_old;
};

/// Where f and f~ lie on different sides, ascending and disjoint: air that becomes matter, or matter that becomes air.
std::vector<BrushedPiece> brushed_pieces(const AxisProfile& f, const Brush& brush);

}  // namespace hoodoo
