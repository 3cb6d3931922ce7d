// Where water would run on a grid of heights, how much ground each cell drains, and how wet that makes it.
#pragma once

#include "terrain/analysis/elevation.h"

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// The heights with every pit raised until it drains over its rim (Barnes2014), each raised cell by the smallest step above the next. The rim of the
/// grid drains outwards.
std::vector<double> fill_pits(const Elevation& elevation);

struct Drainage {
    std::vector<double> area;              ///< m2 that drain through the cell, itself included
    std::vector<double> slope;             ///< towards the cell it drains to, metres a metre, on the filled heights; 0 where water leaves the grid
    std::vector<std::int64_t> downstream;  ///< index of that cell; -1 where water leaves the grid
};

/// Eight directions: each cell drains to the neighbour of steepest descent, diagonal ones sqrt(2) cells away; of equally steep ones to the first, row
/// by row from the north-west. Throws what check_elevation throws.
Drainage drainage(const Elevation& elevation);

enum class WetnessKind : std::uint8_t {
    tangent,  ///< ln(A / s), s = the slope, at least 0.001: the topographic wetness index
    cover,    ///< ln(A / sqrt(1 + s^2)): the slope as the length of (grad h, 1), never 0
};

/// A is the area drained by a metre of contour: area / cell. Natural logarithm of metres.
std::vector<double> wetness(const Drainage& drainage, double cell, WetnessKind kind);

}  // namespace hoodoo
