// A voxel grid as a surface, for whoever has one: the catalogue's row, Python.
#pragma once

#include "terrain/fields/voxel_grid.h"
#include "terrain/surface.h"

#include <memory>

namespace hoodoo
{

struct VoxelSurfaceOptions {
    double normal_width = 0.75;  ///< cells: half-width of the differences that give shading normals
    double build_seconds = 0.0;  ///< spent so far, for info()
};

/// The surface of the grid's field, closed. The grid must not change while the surface is used.
std::unique_ptr<Surface> make_voxel_surface(std::shared_ptr<const VoxelGrid> grid, const VoxelSurfaceOptions& options = {});

}  // namespace hoodoo
