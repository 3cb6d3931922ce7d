// Where loose material comes to rest: a thickness for each column, from the ground below it.
#pragma once

#include "terrain/math/vec.h"

#include <vector>

namespace hoodoo
{

struct Drift {
    double thickness;    ///< metres, on flat ground
    double flat, steep;  ///< radians: all of it up to `flat`, nothing from `steep` on
    double fill;         ///< share of a hollow that is filled
    double reach;        ///< metres: half-width of the square whose mean height defines a hollow
};

/// `ground` in metres, i fastest, size.x * size.y values. Returns metres.
std::vector<double> drift_thickness(const std::vector<double>& ground, Vec2i size, double cell, const Drift& drift);

}  // namespace hoodoo
