// A sampled solid as a field, with bounds as tight as its cells.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/voxel_grid.h"

#include <memory>

namespace hoodoo
{

/// The trilinear interpolation F of a grid's samples; negative in matter, continuous, the value of air beyond the grid. Its unit is the samples' own.
/// Exact in double up to rounding. Bounds of a box or a segment are those of the pieces of cells in it.
class VoxelField final : public Field
{
public:
    /// Reads the grid once for its bounds: it must not change while the field is used.
    explicit VoxelField(std::shared_ptr<const VoxelGrid> grid);

    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override { return grid_->box(); }
    std::array<Interval, 3> gradient_range(const Box3d& box) const override;

    const VoxelGrid& grid() const { return *grid_; }
    std::uint64_t memory_bytes() const;

    /// Central differences of half-width `width` (metres): continuous. Not normalised.
    Vec3d smoothed_gradient(const Vec3d& p, double width) const;

private:
    /// Of all cells of a block: of values, and of differences along an edge, a component each.
    struct Summary {
        Interval value{0.0, 0.0};
        std::array<Interval, 3> rise{};
        bool empty = true;
        void add(const Summary& other);
    };
    /// A part of a cell: its corners, and the part in [0, 1]^3.
    struct Part {
        std::array<float, 8> corners;
        Vec3d lo, hi;
    };
    static Summary of_part(const Part& part);
    Summary of_block(const Index3& b) const;
    Summary over(const Box3d& box) const;

    std::shared_ptr<const VoxelGrid> grid_;
    Index3 nodes_{};
    struct NodeSummary {
        Summary all;
        std::vector<Summary> blocks;  ///< none: all blocks are like `all`
    };
    std::vector<NodeSummary> table_;
};

}  // namespace hoodoo
