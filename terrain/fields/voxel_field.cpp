// Bounds of a trilinear function are those of its corners; of many cells, those of blocks that were added up before.
//
// In a cell F is affine in each coordinate, so over any part [lo, hi] of the cell it takes its extremes at the part's corners, and so does each
// component of its gradient (bilinear in the other two). A box is split into whole nodes, whole blocks and parts of cells. Along a segment F is a
// cubic in each cell, and its slope lies between the coefficients of the cubic's derivative in Bernstein form. Deviation: none. Missing: a curvature
// bound, since the gradient jumps from cell to cell.
#include "terrain/fields/voxel_field.h"

#include "terrain/fields/voxel_walk.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr int kEdge = SparseLattice<float>::kEdge, kNodeEdge = SparseLattice<float>::kNodeEdge;

Interval padded(const Interval& i)
{
    const double rounding = 0x1p-48 * i.magnitude();
    return {i.lo - rounding, i.hi + rounding};
}

int floor_clamped(double x, int most)
{
    return x > 0.0 ? (x < most ? static_cast<int>(std::floor(x)) : most) : 0;
}

}  // namespace

void VoxelField::Summary::add(const Summary& other)
{
    if (other.empty) return;
    if (empty) {
        *this = other;
        return;
    }
    value = Interval::hull(value, other.value);
    for (std::size_t k = 0; k < 3; ++k) rise[k] = Interval::hull(rise[k], other.rise[k]);
}

VoxelField::Summary VoxelField::of_part(const Part& part)
{
    const auto& [f, lo, hi] = part;
    Summary s;
    s.empty = false;
    s.value = {kInfinity, -kInfinity};
    for (Interval& rise : s.rise) rise = {kInfinity, -kInfinity};
    const auto include = [](Interval& i, double x) { i = {std::min(i.lo, x), std::max(i.hi, x)}; };
    for (int n = 0; n < 8; ++n) {
        const Vec3d p(n & 4 ? hi.x : lo.x, n & 2 ? hi.y : lo.y, n & 1 ? hi.z : lo.z);
        include(s.value, trilinear(f, p.x, p.y, p.z));
        include(s.rise[0], trilinear(f, 1.0, p.y, p.z) - trilinear(f, 0.0, p.y, p.z));
        include(s.rise[1], trilinear(f, p.x, 1.0, p.z) - trilinear(f, p.x, 0.0, p.z));
        include(s.rise[2], trilinear(f, p.x, p.y, 1.0) - trilinear(f, p.x, p.y, 0.0));
    }
    return s;
}

VoxelField::Summary VoxelField::of_block(const Index3& b) const
{
    const Index3& size = grid_->values.size();
    Summary s;
    bool constant = true;
    const float first = grid_->values.block(b).constant;
    for (int n = 0; n < 8 && constant; ++n) {
        const auto view = grid_->values.block({b[0] + (n >> 2), b[1] + ((n >> 1) & 1), b[2] + (n & 1)});
        constant = !view.block && view.constant == first;
    }
    if (constant) {
        s.empty = false;
        s.value = {first, first};
        return s;
    }
    for (int i = kEdge * b[0]; i < std::min(kEdge * (b[0] + 1), size[0] - 1); ++i)
        for (int j = kEdge * b[1]; j < std::min(kEdge * (b[1] + 1), size[1] - 1); ++j)
            for (int k = kEdge * b[2]; k < std::min(kEdge * (b[2] + 1), size[2] - 1); ++k)
                s.add(of_part({cell_corners(grid_->values, {i, j, k}), Vec3d(0.0), Vec3d(1.0)}));
    return s;
}

VoxelField::VoxelField(std::shared_ptr<const VoxelGrid> grid) : grid_(std::move(grid)), nodes_(grid_->values.nodes())
{
    const SparseLattice<float>& values = grid_->values;
    values.each_node([&](const Index3& n) {
        NodeSummary node;
        float constant = 0.0f;
        bool all_constant = values.constant_node(n, constant);
        const float first = constant;
        for (int m = 1; m < 8 && all_constant; ++m)
            all_constant = values.constant_node({n[0] + (m >> 2), n[1] + ((m >> 1) & 1), n[2] + (m & 1)}, constant) && constant == first;
        if (all_constant) {
            node.all.empty = false;
            node.all.value = {first, first};
        } else {
            node.blocks.resize(kNodeEdge * kNodeEdge * kNodeEdge);
            values.each_block_of(n, [&](const Index3& b) {
                Summary& s = node.blocks[static_cast<std::size_t>(((b[0] & 15) * kNodeEdge + (b[1] & 15)) * kNodeEdge + (b[2] & 15))];
                s = of_block(b);
                node.all.add(s);
            });
        }
        table_.push_back(std::move(node));
    });
}

std::uint64_t VoxelField::memory_bytes() const
{
    std::uint64_t bytes = table_.size() * sizeof(NodeSummary);
    for (const NodeSummary& node : table_) bytes += node.blocks.size() * sizeof(Summary);
    return bytes;
}

double VoxelField::value(const Vec3d& p) const
{
    const Vec3d q = grid_->local(p);
    const Index3& n = grid_->values.size();
    for (int k = 0; k < 3; ++k)
        if (!(q[k] >= 0.0 && q[k] <= n[static_cast<std::size_t>(k)] - 1)) return grid_->values.outside();
    const Index3 c{floor_clamped(q.x, n[0] - 2), floor_clamped(q.y, n[1] - 2), floor_clamped(q.z, n[2] - 2)};
    const Vec3d u = in_cell(q, c);
    return trilinear(cell_corners(grid_->values, c), u.x, u.y, u.z);
}

Vec3d VoxelField::gradient(const Vec3d& p) const
{
    const Vec3d q = grid_->local(p);
    const Index3& n = grid_->values.size();
    for (int k = 0; k < 3; ++k)
        if (!(q[k] >= 0.0 && q[k] <= n[static_cast<std::size_t>(k)] - 1)) return Vec3d(0.0);
    const Index3 c{floor_clamped(q.x, n[0] - 2), floor_clamped(q.y, n[1] - 2), floor_clamped(q.z, n[2] - 2)};
    const Vec3d u = in_cell(q, c);
    const std::array<float, 8> f = cell_corners(grid_->values, c);
    return Vec3d(trilinear(f, 1.0, u.y, u.z) - trilinear(f, 0.0, u.y, u.z), trilinear(f, u.x, 1.0, u.z) - trilinear(f, u.x, 0.0, u.z),
                 trilinear(f, u.x, u.y, 1.0) - trilinear(f, u.x, u.y, 0.0)) /
           grid_->cell;
}

Vec3d VoxelField::smoothed_gradient(const Vec3d& p, double width) const
{
    Vec3d g;
    for (int k = 0; k < 3; ++k) {
        Vec3d step(0.0);
        step[k] = width;
        g[k] = (value(p + step) - value(p - step)) / (2.0 * width);
    }
    return g;
}

double VoxelField::slope_bound(const Segment& segment) const
{
    const Vec3d a = grid_->local(segment.a), d = grid_->local(segment.b) - a;
    const double length = (segment.b - segment.a).length();
    const Index3& n = grid_->values.size();
    if (!(length > 0.0)) {
        const std::array<Interval, 3> g = gradient_range(Box3d(segment.a));
        return Vec3d(g[0].magnitude(), g[1].magnitude(), g[2].magnitude()).length();
    }
    double t0 = 0.0, t1 = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double most = n[static_cast<std::size_t>(k)] - 1;
        if (d[k] == 0.0) {
            if (a[k] < 0.0 || a[k] > most) return 0.0;
            continue;
        }
        const double s0 = (0.0 - a[k]) / d[k], s1 = (most - a[k]) / d[k];
        t0 = std::max(t0, std::min(s0, s1));
        t1 = std::min(t1, std::max(s0, s1));
    }
    if (!(t0 <= t1)) return 0.0;
    double steepest = 0.0, largest = 0.0;
    walk_cells(a, d, t0, t1, {0, 0, 0}, {n[0] - 2, n[1] - 2, n[2] - 2}, [&](const Index3& c, double s0, double s1) {
        const std::array<float, 8> f = cell_corners(grid_->values, c);
        const Vec3d p = in_cell(a + d * s0, c), q = in_cell(a + d * s1, c);
        // The derivative along d, in cells: affine in each coordinate, so its extremes over the piece's box are at the corners.
        for (int m = 0; m < 8; ++m) {
            const Vec3d u(m & 4 ? q.x : p.x, m & 2 ? q.y : p.y, m & 1 ? q.z : p.z);
            const double rate = d.x * (trilinear(f, 1.0, u.y, u.z) - trilinear(f, 0.0, u.y, u.z)) +
                                d.y * (trilinear(f, u.x, 1.0, u.z) - trilinear(f, u.x, 0.0, u.z)) +
                                d.z * (trilinear(f, u.x, u.y, 1.0) - trilinear(f, u.x, u.y, 0.0));
            steepest = std::max(steepest, std::abs(rate));
        }
        for (const float x : f) largest = std::max(largest, static_cast<double>(std::abs(x)));
        return true;
    });
    return (steepest + 0x1p-46 * largest) / length;
}

VoxelField::Summary VoxelField::over(const Box3d& box) const
{
    const Vec3d lo = grid_->local(box.min), hi = grid_->local(box.max);
    const Index3& n = grid_->values.size();
    Summary all;
    Index3 first, last;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const double most = n[at] - 1;
        if (lo[k] < 0.0 || hi[k] > most) {
            all.empty = false;
            all.value = {grid_->values.outside(), grid_->values.outside()};
        }
        if (hi[k] < 0.0 || lo[k] > most) return all;
        first[at] = floor_clamped(lo[k], n[at] - 2);
        last[at] = floor_clamped(hi[k], n[at] - 2);
    }
    const auto covers = [&](const Index3& at, int edge) {
        for (int k = 0; k < 3; ++k) {
            const auto a = static_cast<std::size_t>(k);
            if (lo[k] > edge * at[a] || hi[k] < std::min(edge * (at[a] + 1), n[a] - 1)) return false;
        }
        return true;
    };
    const auto add_cells = [&](const Index3& b) {
        for (int i = std::max(first[0], kEdge * b[0]); i <= std::min(last[0], kEdge * b[0] + kEdge - 1); ++i)
            for (int j = std::max(first[1], kEdge * b[1]); j <= std::min(last[1], kEdge * b[1] + kEdge - 1); ++j)
                for (int k = std::max(first[2], kEdge * b[2]); k <= std::min(last[2], kEdge * b[2] + kEdge - 1); ++k) {
                    const Index3 c{i, j, k};
                    all.add(of_part({cell_corners(grid_->values, c), in_cell(lo, c), in_cell(hi, c)}));
                }
    };
    constexpr int kNodeCells = kEdge * kNodeEdge;
    for (int x = first[0] / kNodeCells; x <= last[0] / kNodeCells; ++x)
        for (int y = first[1] / kNodeCells; y <= last[1] / kNodeCells; ++y)
            for (int z = first[2] / kNodeCells; z <= last[2] / kNodeCells; ++z) {
                const NodeSummary& node = table_[static_cast<std::size_t>((x * nodes_[1] + y) * nodes_[2] + z)];
                if (node.blocks.empty() || covers({x, y, z}, kNodeCells)) {
                    all.add(node.all);
                    continue;
                }
                for (int i = std::max(kNodeEdge * x, first[0] / kEdge); i <= std::min(kNodeEdge * x + kNodeEdge - 1, last[0] / kEdge); ++i)
                    for (int j = std::max(kNodeEdge * y, first[1] / kEdge); j <= std::min(kNodeEdge * y + kNodeEdge - 1, last[1] / kEdge); ++j)
                        for (int k = std::max(kNodeEdge * z, first[2] / kEdge); k <= std::min(kNodeEdge * z + kNodeEdge - 1, last[2] / kEdge); ++k) {
                            const Summary& s = node.blocks[static_cast<std::size_t>(((i & 15) * kNodeEdge + (j & 15)) * kNodeEdge + (k & 15))];
                            if (covers({i, j, k}, kEdge) || s.value.lo == s.value.hi) {
                                all.add(s);
                            } else {
                                add_cells({i, j, k});
                            }
                        }
            }
    return all;
}

Interval VoxelField::range(const Box3d& box) const
{
    return padded(over(box).value);
}

std::array<Interval, 3> VoxelField::gradient_range(const Box3d& box) const
{
    const Summary s = over(box);
    std::array<Interval, 3> g;
    for (std::size_t k = 0; k < 3; ++k) g[k] = padded(s.rise[k].scaled(1.0 / grid_->cell));
    return g;
}

}  // namespace hoodoo
