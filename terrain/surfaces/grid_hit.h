// What is known of a hit on a height grid: shared by every surface that shows one.
#pragma once

#include "terrain/march/grid_rays.h"
#include "terrain/surface.h"

namespace hoodoo
{

/// The first crossing in a block before hit.t: sets hit.t and returns true, else leaves it alone. The patch is the caller's to set.
bool meet_grid(const HeightGrid& grid, int block, const Ray& ray, Hit& hit);

/// t, position and its error, geometric normal, spawn offset. The rest is the surface's.
Interaction grid_interaction(const HeightGrid& grid, int block, const Ray& ray, const Hit& hit);

}  // namespace hoodoo
