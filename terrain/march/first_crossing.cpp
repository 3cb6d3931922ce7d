// The two certificates of certified marching: how far a function can stray between two known values.
// First order: Hart1996's step turned round (from both ends at once; better near grazing). Second order: f >= 0 at both ends, |f''| <= K; among the
// functions that reach zero the one that starts lowest is a parabola of curvature K with its foot on zero: fa = K x^2 / 2, fb = K (h - x)^2 / 2.
#include "terrain/march/first_crossing.h"

namespace hoodoo
{

bool keeps_sign(const Stretch& s, const PieceBound& bound)
{
    const double a = std::abs(s.fa), b = std::abs(s.fb), width = s.b - s.a;
    if (a + b > bound.slope * width) return true;
    // (sqrt a + sqrt b)^2 = a + b + 2 sqrt(a b), without two roots. An infinite curvature says no.
    return 2.0 * (a + b + 2.0 * std::sqrt(a * b)) > bound.curvature * width * width;
}

bool is_monotone(const Stretch& s, const PieceBound& bound)
{
    const double width = s.b - s.a;
    return 2.0 * std::abs(s.fb - s.fa) > bound.curvature * width * width;
}

}  // namespace hoodoo
