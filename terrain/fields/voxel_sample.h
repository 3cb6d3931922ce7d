// Any field as voxels.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/voxel_grid.h"

namespace hoodoo
{

/// The field's values at the points of a lattice of that cell (metres) over the region, trimmed to what the surface needs. Blocks in which the field
/// has proved not to vanish are never sampled. Where matter reaches the region's faces it is cut off there. Throws Error (scene) as VoxelGrid does.
VoxelGrid sample_field(const Field& field, const Box3d& region, double cell);

}  // namespace hoodoo
