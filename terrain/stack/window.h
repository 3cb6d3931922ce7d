// The columns under a kernel along one horizontal axis.
#pragma once

#include <algorithm>
#include <cmath>

namespace hoodoo
{

/// The window of one horizontal axis, in cells: columns first..last overlap [low, high].
struct Window {
    double low, high;
    int first, last;
    double weight(int i) const { return std::min(high, i + 1.0) - std::max(low, static_cast<double>(i)); }
};

/// `u` in cells. Positions beyond the grid by more than the kernel all see the same columns, so they may be moved to it: no overflow, no NaN.
inline double confined(double u, double half, int n)
{
    const double low = -half - 2.0, high = n + half + 2.0;
    return !(u > low) ? low : (u < high ? u : high);
}

inline Window window(double u, double half, int n)
{
    u = confined(u, half, n);
    Window w{u - half, u + half, 0, 0};
    w.first = static_cast<int>(std::floor(w.low));
    w.last = static_cast<int>(std::floor(w.high));
    return w;
}

}  // namespace hoodoo
