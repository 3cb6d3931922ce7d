// A straight line through the cells of a lattice, and a trilinear function along its piece in one of them.
#pragma once

#include "terrain/fields/voxel_grid.h"

#include <cmath>

namespace hoodoo
{

/// Calls visit(cell, t0, t1) for the cells that o + t d passes for t in [a, b], in order, as long as it returns true and the cells lie between
/// `first` and `last`. Coordinates are in cells. Every t at which a plane is crossed is computed from that plane alone (no sum that drifts): pieces
/// join without a gap. A line in a plane between cells passes those on the plane's upper side.
template <class Visit>
void walk_cells(const Vec3d& o, const Vec3d& d, double a, double b, const Index3& first, const Index3& last, const Visit& visit)
{
    Index3 c;
    std::array<double, 3> next;
    const auto plane = [&](int k) {
        const auto at = static_cast<std::size_t>(k);
        if (d[k] == 0.0) return kInfinity;
        return ((d[k] > 0.0 ? c[at] + 1.0 : c[at]) - o[k]) / d[k];
    };
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const double p = o[k] + d[k] * a;
        c[at] = p > first[at] ? (p < last[at] ? static_cast<int>(std::floor(p)) : last[at]) : first[at];
        next[at] = plane(k);
    }
    double t = a;
    for (;;) {
        const int k = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        const auto at = static_cast<std::size_t>(k);
        const double end = std::min(std::max(next[at], t), b);
        if (!visit(c, t, end) || !(next[at] < b)) return;
        c[at] += d[k] > 0.0 ? 1 : -1;
        if (c[at] < first[at] || c[at] > last[at]) return;
        t = end;
        next[at] = plane(k);
    }
}

/// A point of a cell in its own coordinates; what rounding put outside comes back to the face.
inline Vec3d in_cell(const Vec3d& p, const Index3& c)
{
    return {std::clamp(p.x - c[0], 0.0, 1.0), std::clamp(p.y - c[1], 0.0, 1.0), std::clamp(p.z - c[2], 0.0, 1.0)};
}

/// The Bernstein coefficients of the cubic that the trilinear function is on the straight way from p to q. Each is a mean of the corners with weights
/// that are not negative (the function's polar form), so a cell of one sign has a cubic of that sign, rounding included.
inline std::array<double, 4> cubic_between(const std::array<float, 8>& f, const Vec3d& p, const Vec3d& q)
{
    return {trilinear(f, p.x, p.y, p.z), (trilinear(f, q.x, p.y, p.z) + trilinear(f, p.x, q.y, p.z) + trilinear(f, p.x, p.y, q.z)) / 3.0,
            (trilinear(f, p.x, q.y, q.z) + trilinear(f, q.x, p.y, q.z) + trilinear(f, q.x, q.y, p.z)) / 3.0, trilinear(f, q.x, q.y, q.z)};
}

}  // namespace hoodoo
