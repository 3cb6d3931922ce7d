// Numbers on a regular grid of space, for other programs.
#pragma once

#include "terrain/io/georeference.h"
#include "terrain/math/vec.h"

#include <array>
#include <string>
#include <vector>

namespace hoodoo
{

/// Samples at the nodes origin + (i, j, k) * step, z fastest: value (i, j, k) is values[(i ny + j) nz + k]. `count` is 1 along an axis that is not
/// sampled.
struct SampledGrid {
    std::array<int, 3> count{1, 1, 1};
    Vec3d origin{0.0}, step{1.0};
    std::vector<double> values;
    GeoReference place = {};  ///< of the pixels of a flat .exr, row 0 = the largest y; unknown: not written
};

/// By the ending, replaced in one step: .npy (float64, indexed [i, j, k]; [i, j] where nz = 1), .exr (float; one channel a height, z0000 upwards, row
/// 0 = the largest y; Y where nz = 1) or .vdb (a float grid called "field" whose transform is the grid's). Throws Error (file): another ending, over
/// 1000 heights in an EXR; Error (internal): .vdb without OpenVDB.
void write_grid_file(const std::string& path, const SampledGrid& grid);

/// The same for .vdb only.
void write_vdb_grid(const std::string& path, const SampledGrid& grid);

}  // namespace hoodoo
