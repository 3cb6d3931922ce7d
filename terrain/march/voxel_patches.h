// The surface of a voxel grid, met by rays cell by cell: an exact cubic in each.
#pragma once

#include "terrain/fields/voxel_field.h"
#include "terrain/surface.h"

#include <memory>
#include <vector>

namespace hoodoo
{

/// Blocks of 8 x 8 x 8 cells that the surface of a grid crosses, each with the box of its crossed cells: memory follows the area of the surface. The
/// verbs are those of Surface, with the same contracts. Immutable, thread-safe; the grid must not change meanwhile.
class VoxelPatches
{
public:
    explicit VoxelPatches(std::shared_ptr<const VoxelGrid> grid);

    std::uint32_t patch_count() const { return static_cast<std::uint32_t>(patches_.size()); }
    Box3d patch_bounds(std::uint32_t index) const;
    bool intersect(std::uint32_t index, const Ray& ray, Hit& hit) const;
    /// Proved: |F| of the grid's field is at most this at a reported t, rounding of the point itself aside.
    double value_error() const { return value_error_; }
    std::uint64_t crossed_cells() const { return crossed_; }
    std::uint64_t memory_bytes() const { return patches_.capacity() * sizeof(Patch); }

private:
    struct Patch {
        Index3 block;
        std::array<std::uint8_t, 3> lo, hi;    ///< crossed cells lie in [lo, hi] of the block
        std::array<std::uint64_t, 8> crossed;  ///< a bit a cell, k lowest
    };
    bool is_crossed_cell(const Patch& patch, const Index3& c) const;

    std::shared_ptr<const VoxelGrid> grid_;
    std::vector<Patch> patches_;
    std::uint64_t crossed_ = 0;
    double value_error_ = 0.0, rounding_ = 0.0;
};

}  // namespace hoodoo
