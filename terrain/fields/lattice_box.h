// A box of a sparse lattice as a plain array, and a grid's values as shares of matter: what simulations on voxels work with.
#pragma once

#include "terrain/fields/voxel_grid.h"

#include <vector>

namespace hoodoo
{

/// Points of a lattice from `lo` on, `size` of them along each axis, k fastest. May reach beyond the lattice.
struct LatticeBox {
    Index3 lo{}, size{};
    std::vector<float> values;

    std::size_t index(int i, int j, int k) const  ///< counted from lo
    {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) * static_cast<std::size_t>(size[2]) +
               static_cast<std::size_t>(k);
    }
    /// Reads the box from the lattice, row by row of its blocks.
    void read(const SparseLattice<float>& lattice);
};

/// Share of matter of every sample, in [0, 1]: 1/2 - F / (slope cell), where the slope is the grid's own mean. 1/2 where F is 0; a flat surface's
/// samples hold what lies in their cubes.
SparseLattice<float> matter_shares(const VoxelGrid& grid);

/// F = 1/2 - share: the grid becomes a density, trimmed. Rim samples of the lattice must hold no matter.
void set_matter_shares(VoxelGrid& grid, const SparseLattice<float>& shares);

/// The mean of |grad F| at the centres of cells that the surface crosses, per metre; 0 without a surface.
double mean_slope(const VoxelGrid& grid);

}  // namespace hoodoo
