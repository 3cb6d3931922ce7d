// A cubic on [0, 1] in Bernstein form: its first change of sign, found without a tolerance.
#pragma once

#include <array>

namespace hoodoo
{

/// Coefficients of the Bernstein polynomials of degree 3.
using Cubic = std::array<double, 4>;

inline double evaluate(const Cubic& b, double u)
{
    const double v = 1.0 - u;
    return ((b[0] * v + 3.0 * b[1] * u) * v + 3.0 * b[2] * u * u) * v + b[3] * u * u * u;
}

/// Smallest u in [0, 1] at which the cubic is on the other side: negative if `inside` is false, above zero if `inside` is true.
/// False if there is none. Exact up to the rounding of the coefficients: an excursion it does not see is below 4 units in the last place of
/// the largest coefficient.
bool first_change(const Cubic& b, bool inside, double& u);

}  // namespace hoodoo
