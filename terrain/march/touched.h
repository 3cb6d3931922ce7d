// Which tiles of an intersector an edit of columns touches.
#pragma once

#include "terrain/stack/column_set.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hoodoo
{

/// Tiles ty * tiles.x + tx, ascending, that read any of the columns. `along_x(i)` and `along_y(j)` give the first and the last tile along one axis
/// that reads column i (or j) and may lie outside the grid of tiles.
template <class AlongX, class AlongY>
std::vector<std::uint32_t> touched_tiles(const ColumnSet& columns, Vec2i tiles, const AlongX& along_x, const AlongY& along_y)
{
    std::vector<std::uint32_t> touched;
    for (const std::uint32_t index : columns.indices()) {
        const Vec2i at = columns.column(index), x = along_x(at.x), y = along_y(at.y);
        for (int ty = std::max(0, y.x); ty <= std::min(tiles.y - 1, y.y); ++ty) {
            for (int tx = std::max(0, x.x); tx <= std::min(tiles.x - 1, x.y); ++tx) {
                const auto tile = static_cast<std::uint32_t>(ty) * static_cast<std::uint32_t>(tiles.x) + static_cast<std::uint32_t>(tx);
                if (touched.empty() || touched.back() != tile) touched.push_back(tile);
            }
        }
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    return touched;
}

}  // namespace hoodoo
