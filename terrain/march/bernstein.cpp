// First sign change of a cubic by the variation of its Bernstein coefficients and halving (Lane1981).
//
// No variation: no root. One variation: exactly one root, which Newton's method finds inside a bracket that only shrinks. Else halve.
// The halving ends after 52 levels, when the interval is one unit in the last place of [0, 1].

#include "terrain/march/bernstein.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kHalvings = 52;

double derivative(const Cubic& b, double u)
{
    const double v = 1.0 - u;
    return 3.0 * (((b[1] - b[0]) * v + 2.0 * (b[2] - b[1]) * u) * v + (b[3] - b[2]) * u * u);
}

/// The root of a cubic with b[0] >= 0 > b[3] and one variation.
double only_root(const Cubic& b)
{
    double lo = 0.0, hi = 1.0;
    double u = b[0] / (b[0] - b[3]);
    for (int i = 0; i < 100; ++i) {
        const double value = evaluate(b, u);
        (value < 0.0 ? hi : lo) = u;
        const double slope = derivative(b, u);
        double next = slope != 0.0 ? u - value / slope : lo;
        if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
        if (std::abs(next - u) <= 0x1p-52 || next == lo || next == hi) return next;
        u = next;
    }
    return hi;
}

bool descend(const Cubic& b, double u0, double u1, int depth, double& u)
{
    if (b[0] < 0.0) {
        u = u0;
        return true;
    }
    if (std::min({b[1], b[2], b[3]}) >= 0.0) return false;
    const bool n1 = b[1] < 0.0, n2 = b[2] < 0.0, n3 = b[3] < 0.0;
    if (n3 && (!n1 || n2)) {
        u = u0 + (u1 - u0) * only_root(b);
        return true;
    }
    if (depth == kHalvings) {
        u = u1;
        return n3;
    }
    const double m = 0.5 * (b[1] + b[2]);
    const double l1 = 0.5 * (b[0] + b[1]), r2 = 0.5 * (b[2] + b[3]);
    const double l2 = 0.5 * (l1 + m), r1 = 0.5 * (m + r2);
    const double middle = 0.5 * (l2 + r1), um = 0.5 * (u0 + u1);
    return descend({b[0], l1, l2, middle}, u0, um, depth + 1, u) || descend({middle, r1, r2, b[3]}, um, u1, depth + 1, u);
}

}  // namespace

bool first_change(const Cubic& b, bool inside, double& u)
{
    if (inside) return descend({-b[0], -b[1], -b[2], -b[3]}, 0.0, 1.0, 0, u);
    return descend(b, 0.0, 1.0, 0, u);
}

}  // namespace hoodoo
