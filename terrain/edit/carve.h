// The first tool: a ball moved along a line removes what it touches. Arches, caves and overhangs begin with it.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// World metres. One radius for all points, or one for each; between two points place and radius change evenly.
struct Sweep {
    std::vector<Vec3d> points;
    std::vector<double> radii;
    double roughness = 0.0;   ///< share of the radius by which noise moves the wall, in [0, 1)
    double wavelength = 1.0;  ///< of that noise, metres
    std::uint32_t seed = 0;
};

/// Turns everything inside the sweep to air, then settles the columns it changed (merge_and_sort). Nothing below the stack's origin can be removed.
/// Returns the columns that changed. Throws Error (scene) if the sweep makes no sense or would take more than 1e7 steps.
ColumnSet carve(MaterialStack& stack, const Sweep& sweep);

}  // namespace hoodoo
