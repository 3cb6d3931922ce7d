// The cubic that rises from 0 to 1 and is level at both ends.
#pragma once

#include "terrain/math/interval.h"

namespace hoodoo
{

/// 0 at a <= 0, 1 at a >= 1, 3 a^2 - 2 a^3 between; once continuously differentiable.
inline double smoothstep(double a)
{
    a = std::clamp(a, 0.0, 1.0);
    return a * a * (3.0 - 2.0 * a);
}

inline double smoothstep_slope(double a)
{
    return a > 0.0 && a < 1.0 ? 6.0 * a * (1.0 - a) : 0.0;
}

/// The largest slope over an interval: 3/2 if it holds the middle.
inline double smoothstep_steepest(const Interval& a)
{
    if (a.hi <= 0.0 || a.lo >= 1.0) return 0.0;
    return smoothstep_slope(std::clamp(0.5, a.lo, a.hi));
}

}  // namespace hoodoo
