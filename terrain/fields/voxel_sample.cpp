// A field is asked for its range over a block and a cell around it: if zero is not in it, no cell that has a corner in the block is crossed, and the
// sign is all that a grid keeps of such a block. Blocks are asked in halves from the whole lattice down, so empty space costs its surface.
#include "terrain/fields/voxel_sample.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

class Sampler
{
public:
    Sampler(const Field& field, VoxelGrid& grid) : field_(field), grid_(grid), size_(grid.values.size()) {}

    /// Blocks in [lo, hi), halved along the longest side.
    void fill(const Index3& lo, const Index3& hi)
    {
        const Interval range = field_.range(around(lo, hi));
        if (range.lo > 0.0) return;
        const bool solid = range.hi < 0.0;
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
        if (hi[axis] - lo[axis] == 1) {
            sample(lo, solid);
            return;
        }
        if (solid) {
            for (int i = lo[0]; i < hi[0]; ++i)
                for (int j = lo[1]; j < hi[1]; ++j)
                    for (int k = lo[2]; k < hi[2]; ++k) sample({i, j, k}, true);
            return;
        }
        Index3 first = hi, second = lo;
        first[axis] = second[axis] = (lo[axis] + hi[axis]) / 2;
        fill(lo, first);
        fill(second, hi);
    }

private:
    Box3d around(const Index3& lo, const Index3& hi) const
    {
        return {grid_.world(Vec3d(8 * lo[0] - 1, 8 * lo[1] - 1, 8 * lo[2] - 1)), grid_.world(Vec3d(8 * hi[0], 8 * hi[1], 8 * hi[2]))};
    }

    void sample(const Index3& b, bool solid)
    {
        const bool inner =
            8 * b[0] > 0 && 8 * b[1] > 0 && 8 * b[2] > 0 && 8 * b[0] + 8 < size_[0] && 8 * b[1] + 8 < size_[1] && 8 * b[2] + 8 < size_[2];
        if (solid && inner) {
            grid_.values.set_block(b, -grid_.values.outside());
            return;
        }
        for (int i = std::max(1, 8 * b[0]); i < std::min(size_[0] - 1, 8 * b[0] + 8); ++i)
            for (int j = std::max(1, 8 * b[1]); j < std::min(size_[1] - 1, 8 * b[1] + 8); ++j)
                for (int k = std::max(1, 8 * b[2]); k < std::min(size_[2] - 1, 8 * b[2] + 8); ++k)
                    grid_.set({i, j, k}, static_cast<float>(field_.value(grid_.world(Vec3d(i, j, k)))));
    }

    const Field& field_;
    VoxelGrid& grid_;
    Index3 size_;
};

}  // namespace

VoxelGrid sample_field(const Field& field, const Box3d& region, double cell)
{
    Index3 inner{};
    const Vec3d size = region.size() / cell;
    for (int k = 0; k < 3; ++k) inner[static_cast<std::size_t>(k)] = static_cast<int>(std::clamp(std::floor(size[k] + 1e-9) + 1.0, 0.0, 1e6));
    VoxelGrid grid(inner, cell, region.min, static_cast<float>(cell));
    Sampler(field, grid).fill({0, 0, 0}, grid.values.blocks());
    grid.trim();
    return grid;
}

}  // namespace hoodoo
