// Priority-flood (Barnes2014, with an epsilon that is the next double), steepest descent in eight directions (O'Callaghan and Mark 1984),
// accumulation from the highest cell to the lowest. Filled heights strictly fall along every path of water, so one pass in that order is enough and
// no path closes. Slopes are those of the filled heights: on a filled lake they are as good as 0, and the index of wetness takes its smallest slope
// there. Missing: flow that divides (multiple directions), the length of contour by direction.
#include "terrain/analysis/drainage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace hoodoo
{

namespace
{

constexpr double kLeastSlope = 1e-3;

/// Calls visit(column, row, distance in cells) for the neighbours inside the grid, row by row from the north-west.
template <class Visit>
void for_neighbours(const Elevation& e, int column, int row, const Visit& visit)
{
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const int c = column + dx, r = row + dy;
            if ((dx == 0 && dy == 0) || c < 0 || r < 0 || c >= e.columns || r >= e.rows) continue;
            visit(c, r, dx != 0 && dy != 0 ? std::sqrt(2.0) : 1.0);
        }
    }
}

}  // namespace

std::vector<double> fill_pits(const Elevation& e)
{
    check_elevation(e);
    // From the rim inwards, always on at the lowest place reached: what is lower than where it was reached from is a pit.
    struct Reached {
        double z;
        std::size_t index;
        bool operator<(const Reached& o) const { return z != o.z ? z > o.z : index > o.index; }
    };
    std::vector<double> filled(e.z.begin(), e.z.end());
    std::vector<char> seen(filled.size());
    std::priority_queue<Reached> open;
    for (int row = 0; row < e.rows; ++row) {
        for (int column = 0; column < e.columns; ++column) {
            if (row > 0 && column > 0 && row < e.rows - 1 && column < e.columns - 1) continue;
            seen[e.index(column, row)] = 1;
            open.push({e.at(column, row), e.index(column, row)});
        }
    }
    while (!open.empty()) {
        const Reached from = open.top();
        open.pop();
        const auto columns = static_cast<std::size_t>(e.columns);
        for_neighbours(e, static_cast<int>(from.index % columns), static_cast<int>(from.index / columns), [&](int c, int r, double) {
            const std::size_t to = e.index(c, r);
            if (seen[to]) return;
            seen[to] = 1;
            filled[to] = std::max(filled[to], std::nextafter(from.z, std::numeric_limits<double>::infinity()));
            open.push({filled[to], to});
        });
    }
    return filled;
}

Drainage drainage(const Elevation& elevation)
{
    const std::vector<double> filled = fill_pits(elevation);
    Elevation e = elevation;
    e.z = filled;
    Drainage out;
    out.area.assign(filled.size(), e.cell * e.cell);
    out.slope.assign(filled.size(), 0.0);
    out.downstream.assign(filled.size(), -1);
    for (int row = 0; row < e.rows; ++row) {
        for (int column = 0; column < e.columns; ++column) {
            const std::size_t here = e.index(column, row);
            for_neighbours(e, column, row, [&](int c, int r, double distance) {
                const double descent = (filled[here] - e.at(c, r)) / (distance * e.cell);
                if (!(descent > out.slope[here])) return;
                out.slope[here] = descent;
                out.downstream[here] = static_cast<std::int64_t>(e.index(c, r));
            });
        }
    }
    std::vector<std::size_t> order(filled.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return filled[a] != filled[b] ? filled[a] > filled[b] : a < b; });
    for (const std::size_t k : order)
        if (out.downstream[k] >= 0) out.area[static_cast<std::size_t>(out.downstream[k])] += out.area[k];
    return out;
}

std::vector<double> wetness(const Drainage& drainage, double cell, WetnessKind kind)
{
    std::vector<double> out(drainage.area.size());
    for (std::size_t k = 0; k < out.size(); ++k) {
        const double s = drainage.slope[k];
        out[k] = std::log(drainage.area[k] / cell / (kind == WetnessKind::tangent ? std::max(s, kLeastSlope) : std::sqrt(1.0 + s * s)));
    }
    return out;
}

}  // namespace hoodoo
