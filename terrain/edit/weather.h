// Spheroidal weathering: what sees more air decays faster, until blocks are goblins.
#pragma once

#include "terrain/fields/voxel_grid.h"

#include <functional>

namespace hoodoo
{

struct WeatherOptions {
    double depth = 0.5;          ///< metres by which a flat face of durability 1 goes back in all
    double bubble = 0.4;         ///< metres: radius of the ball in which the air is counted
    double power = 1.0;          ///< of the exposure in the rate: larger rounds faster, smaller goes back evenly
    double ground = -kInfinity;  ///< world z below which nothing decays and air counts as rock; by default that of the lattice's lowest inner samples
    /// How much longer than others the rock at a point lasts, above 0; empty: 1 everywhere. Pure and thread-safe.
    std::function<double(const Vec3d&)> durability = {};
    bool drop = true;  ///< what is left without support falls, out of the picture
    std::function<void(double fraction)> progress = {};
};

/// Share of air in the ball around a sample, each sample counting by its share of matter: 1/2 on a flat face, 3/4 at an edge, 7/8 at a corner, up to
/// the lattice's grain. For tests and for pictures of the exposure; weather() uses the same sums.
double exposure(const VoxelGrid& grid, const Index3& sample, double bubble);

/// Lets time pass. The grid becomes a density (F = 1/2 - share of matter). The same bits for any number of threads. Throws Error (scene): a bubble of
/// less than one cell or more than 32, a depth of less than 0 or more than 1000 cells.
void weather(VoxelGrid& grid, const WeatherOptions& options);

/// Takes away matter that is not connected (by faces) with matter at or below the height `ground`, or, with `ground` at minus infinity, with the
/// lowest there is. Returns the number of samples that went.
std::uint64_t drop_unsupported(VoxelGrid& grid, double ground);

}  // namespace hoodoo
