// Boxes are read in runs of up to eight points, as blocks store them. Shares of matter: the volume a flat surface leaves in the cube around a sample
// is 1/2 - d / cell for the distance d, exactly for a surface along the axes and to within a tenth for others.
#include "terrain/fields/lattice_box.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

void LatticeBox::read(const SparseLattice<float>& lattice)
{
    values.resize(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]));
    const Index3& n = lattice.size();
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < size[1]; ++j) {
            float* row = values.data() + index(i, j, 0);
            const int x = lo[0] + i, y = lo[1] + j;
            if (x < 0 || y < 0 || x >= n[0] || y >= n[1]) {
                std::fill(row, row + size[2], lattice.outside());
                continue;
            }
            for (int k = 0; k < size[2];) {
                const int z = lo[2] + k;
                if (z < 0 || z >= n[2]) {
                    row[k++] = lattice.outside();
                    continue;
                }
                const int run = std::min({8 - (z & 7), size[2] - k, n[2] - z});
                const auto view = lattice.block({x / 8, y / 8, z / 8});
                if (view.block) {
                    const float* from = view.block->data() + SparseLattice<float>::within({x, y, z});
                    std::copy(from, from + run, row + k);
                } else {
                    std::fill(row + k, row + k + run, view.constant);
                }
                k += run;
            }
        }
}

double mean_slope(const VoxelGrid& grid)
{
    double sum = 0.0;
    std::uint64_t count = 0;
    each_doubtful_block(grid.values, [&](const Index3& b) {
        each_crossed_cell(grid.values, b, [&](const Index3&, const std::array<float, 8>& f) {
            const Vec3d g(trilinear(f, 1.0, 0.5, 0.5) - trilinear(f, 0.0, 0.5, 0.5), trilinear(f, 0.5, 1.0, 0.5) - trilinear(f, 0.5, 0.0, 0.5),
                          trilinear(f, 0.5, 0.5, 1.0) - trilinear(f, 0.5, 0.5, 0.0));
            sum += g.length();
            ++count;
        });
    });
    return count > 0 ? sum / static_cast<double>(count) / grid.cell : 0.0;
}

SparseLattice<float> matter_shares(const VoxelGrid& grid)
{
    const SparseLattice<float>& values = grid.values;
    SparseLattice<float> shares(values.size(), 0.0f);
    const double slope = mean_slope(grid) * grid.cell;
    const double scale = slope > 0.0 ? 1.0 / slope : 0.0;
    const auto share = [&](float f) { return static_cast<float>(std::clamp(0.5 - f * scale, 0.0, 1.0)); };
    values.each_node([&](const Index3& n) {
        float constant = 0.0f;
        if (values.constant_node(n, constant)) {
            shares.set_node(n, share(constant));
            return;
        }
        values.each_block_of(n, [&](const Index3& b) {
            const auto view = values.block(b);
            if (!view.block) {
                shares.set_block(b, share(view.constant));
            } else {
                std::transform(view.block->begin(), view.block->end(), shares.touch(b).begin(), share);
            }
        });
    });
    return shares;
}

void set_matter_shares(VoxelGrid& grid, const SparseLattice<float>& shares)
{
    SparseLattice<float> values(shares.size(), 0.5f);
    const auto value = [](float share) { return 0.5f - share; };
    shares.each_node([&](const Index3& n) {
        float constant = 0.0f;
        if (shares.constant_node(n, constant)) {
            values.set_node(n, value(constant));
            return;
        }
        shares.each_block_of(n, [&](const Index3& b) {
            const auto view = shares.block(b);
            if (!view.block) {
                values.set_block(b, value(view.constant));
            } else {
                std::transform(view.block->begin(), view.block->end(), values.touch(b).begin(), value);
            }
        });
    });
    grid.values = std::move(values);
    grid.trim();
}

}  // namespace hoodoo
