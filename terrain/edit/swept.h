// Solids between cross sections, met along the axes of columns.
#pragma once

#include "terrain/edit/overwrite.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hoodoo
{

/// A closed cross section in space: corners in order, all in one plane. Rings of one tube have the same number of corners.
struct Ring {
    std::vector<Vec3d> corners;
};

/// What one column loses or gains: heights in units of the stack, ascending and disjoint.
struct AxisRuns {
    std::uint32_t column = 0;  ///< j * size.x + i
    std::vector<Run> runs;
};

/// The union of the prisms between neighbouring rings of each tube, cut along the axes of the stack's columns: one entry for each column that it
/// meets between heights 0 and `most` units, sorted by column. Prisms may overlap, turn back and have non-convex sections.
std::vector<AxisRuns> swept_runs(const MaterialStack& stack, std::span<const std::vector<Ring>> tubes, std::int32_t most);

}  // namespace hoodoo
