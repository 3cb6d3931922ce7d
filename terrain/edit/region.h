// Where a tool acts: a ball, box or capsule moved along a line, seen from the columns it crosses.
#pragma once

#include "terrain/error.h"
#include "terrain/schema.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// World metres. Between two points place and size change evenly.
struct Region {
    enum class Shape : std::uint8_t { ball, box, capsule };
    Shape shape = Shape::ball;
    std::vector<Vec3d> points;       ///< at least one
    std::vector<double> radii = {};  ///< ball, capsule: one, or one for each point
    Vec3d half_size{1.0};            ///< box: before it is turned about the vertical
    double heading = 0.0;            ///< box: radians, counter-clockwise from x
    Vec3d axis{0.0};                 ///< capsule: from one end of its core to the other
    double roughness = 0.0;          ///< share of its size by which noise moves its wall, in [0, 1)
    double wavelength = 1.0;         ///< of that noise, metres
    std::uint32_t seed = 0;
};

/// What a region is to one column: the heights it spans there, world metres, low < high; and how far out the column lies, from 0 under the line to 1
/// at the region's edge.
struct ColumnSpan {
    Vec2i column;
    double low, high, distance;
};

/// The columns whose middle the region crosses, row by row. A part of a bent line may cross a column twice; then there are two spans, low one first,
/// disjoint. Columns outside the grid are left out.
std::vector<ColumnSpan> column_spans(const MaterialStack& stack, const Region& region);

/// The parameters of a region, for a tool's schema, and the region that checked ones describe. With `drape` its line follows the top of the ground.
/// Throws Error (scene) at the value that makes no sense.
std::vector<Parameter> region_parameters();
Region region_of(const MaterialStack& stack, const Values& edit, std::uint64_t seed);

/// The error of a tool that meets no column of the grid.
Error outside_the_terrain(const MaterialStack& stack, const Values& edit, const std::string& key);

}  // namespace hoodoo
