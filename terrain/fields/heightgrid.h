// Heights sampled on a grid, two triangles a cell, kept at the precision of their source and in blocks that lie together in memory.
#pragma once

#include "terrain/fields/height.h"
#include "terrain/math/pages.h"

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace hoodoo
{

/// Where samples lie: node (i, j) is the point origin + (i cell.x, j cell.y, scale * sample), i towards east, j towards north.
struct GridFrame {
    Vec3d origin{0.0};   ///< metres
    Vec2d cell{1.0};     ///< metres, above 0
    double scale = 1.0;  ///< metres for a sample's 1, above 0
};

class HeightGrid;

/// Every other node, with the binomial mean (1/4, 1/2, 1/4) of the heights about it; the area may grow by one old cell to the east and north.
std::unique_ptr<HeightGrid> halved(const HeightGrid& grid);

/// What is known of a square of cells, in the units of the samples.
struct GridSummary {
    float lo = 0.0f, hi = 0.0f;  ///< of its nodes, exact
    float slope = 0.0f;          ///< steepest triangle, metres a metre, rounded up
};

/// The samples' own type: what the file had.
enum class SampleType { u8, u16, i16, f32 };

/// Cell (i, j) has the nodes i, i+1 and j, j+1; its diagonal goes from (i+1, j) to (i, j+1). Filled once, then immutable and thread-safe.
/// Samples lie in blocks of kBlock x kBlock cells that repeat the nodes on their borders: a block is one piece of memory.
class HeightGrid final : public Height
{
public:
    template <class T>
    using Samples = std::vector<T, HugePages<T>>;

    static constexpr int kBlock = 16;           ///< cells along the side of a block
    static constexpr int kStride = kBlock + 1;  ///< nodes along it
    static constexpr int kNodes = kStride * kStride;

    /// At least 2 x 2 nodes. Throws Error (memory) for more than 2^31.
    HeightGrid(const GridFrame& frame, int columns, int rows, SampleType type);

    /// Copies samples of the grid's own type: `width` x `height` of them, the first at node (column, row), `row_step` bytes from a row to the next
    /// (negative: rows go south). Parts beyond the grid are left out.
    void fill(int column, int row, int width, int height, const void* samples, std::ptrdiff_t row_step);
    void set(int column, int row, double sample);

    /// After the last sample: finds what is known of blocks and of squares of them.
    void summarise();

    int columns() const { return columns_; }  ///< nodes
    int rows() const { return rows_; }
    const GridFrame& frame() const { return frame_; }
    /// Columns, rows and samples a metre: rays are turned into these with products.
    const Vec3d& per_metre() const { return per_metre_; }
    SampleType type() const { return static_cast<SampleType>(samples_.index()); }
    double sample(int column, int row) const;
    double node_height(int column, int row) const { return frame_.origin.z + frame_.scale * sample(column, row); }

    int blocks_across() const { return across_; }
    int blocks_up() const { return up_; }
    const GridSummary& summary(int block) const { return levels_[0][static_cast<std::size_t>(block)]; }
    const GridSummary& whole() const { return levels_.back()[0]; }
    /// The nodes of a block, row by row, if T is the samples' type.
    template <class T>
    const T* block(int index) const
    {
        return std::get<Samples<T>>(samples_).data() + static_cast<std::size_t>(index) * kNodes;
    }
    std::uint64_t sample_bytes() const;
    std::uint64_t summary_bytes() const;

    /// The upward normal, by central differences, blended between the four nodes about `p`: the shading normal of an even terrain. Unit length.
    Vec3d smooth_normal(const Vec2d& p) const;

    double height(const Vec2d& p) const override;
    Vec2d gradient(const Vec2d& p) const override;
    Interval range(const Box2d& area) const override;
    double slope_bound(const Box2d& area) const override;
    Box2d domain() const override;

    /// The triangle over a point, as a plane: height at `p` and gradient. In grid coordinates the cell is clamped into the grid.
    struct Facet {
        double height = 0.0;
        Vec2d gradient{0.0};
    };
    Facet facet(int column, int row, bool upper, const Vec2d& p) const;

private:
    struct Cells {
        int i0, i1, j0, j1;  ///< inclusive
    };
    std::size_t index(int column, int row) const;
    Cells cells_of(const Box2d& area) const;
    GridSummary over(const Cells& cells) const;
    GridSummary gather(const Cells& cells, std::size_t level, int bi, int bj) const;
    template <class T>
    GridSummary summarise_block(int bi, int bj) const;
    float steepness(double h00, double h10, double h01, double h11) const;
    Vec2d grid_point(const Vec2d& p) const;

    GridFrame frame_;
    Vec3d per_metre_;
    int columns_, rows_, across_, up_;
    std::variant<Samples<std::uint8_t>, Samples<std::uint16_t>, Samples<std::int16_t>, Samples<float>> samples_;
    std::vector<std::vector<GridSummary>> levels_;  ///< blocks, squares of 2 x 2 blocks, ...
    std::vector<std::pair<int, int>> sizes_;        ///< of the levels
};

}  // namespace hoodoo
