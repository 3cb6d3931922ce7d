// A sampled solid, and what of it the surface needs.
//
// Voxels as in Jones2010: a material function on a grid, here as the values of an implicit function, so that densities (1/2 - mu) and signed
// distances are kept alike. A cell is crossed by the surface if its corners differ in sign: F is trilinear in it, a mean of the corners. Trimming
// follows from that: a sample of no crossed cell only decides the side of its cells, so its value may be anything of its sign. It becomes the band's
// edge, equal values are stored once, and what is stored are the blocks that the surface visits (and their rims). Missing: several resolutions in one
// grid.
#include "terrain/fields/voxel_grid.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

namespace
{

constexpr int kMostSamples = 1 << 16;  // along an axis

Index3 with_rim(const Index3& inner)
{
    for (const int n : inner)
        if (n < 1 || n > kMostSamples)
            throw Error(ErrorKind::scene, Problem{{},
                                                  "the size of a voxel grid",
                                                  fmt::format("1 to {} samples along each axis", kMostSamples),
                                                  fmt::format("{} x {} x {}", inner[0], inner[1], inner[2]),
                                                  {}});
    return {inner[0] + 2, inner[1] + 2, inner[2] + 2};
}

}  // namespace

VoxelGrid::VoxelGrid(const Index3& inner, double width, const Vec3d& first, float air)
    : cell(width), origin(first - Vec3d(width)), values(with_rim(inner), air), names{"bedrock"}
{
    if (!(cell > 0.0 && std::isfinite(cell)))
        throw Error(ErrorKind::scene, Problem{{}, "the cell of a voxel grid", "a finite number above 0 (metres)", fmt::format("{:.6g}", cell), {}});
}

VoxelGrid VoxelGrid::copy() const
{
    const Index3& n = values.size();
    VoxelGrid other({n[0] - 2, n[1] - 2, n[2] - 2}, cell, origin + Vec3d(cell), values.outside());
    other.origin = origin;
    other.values = values.copy();
    if (materials) other.materials = materials->copy();
    other.names = names;
    return other;
}

Box3d VoxelGrid::box() const
{
    const Index3& n = values.size();
    return {origin, origin + Vec3d(n[0] - 1, n[1] - 1, n[2] - 1) * cell};
}

double VoxelGrid::band() const
{
    float most = 0.0f;
    each_doubtful_block(values, [&](const Index3& b) {
        each_crossed_cell(values, b, [&](const Index3&, const std::array<float, 8>& f) {
            for (const float x : f) most = std::max(most, std::abs(x));
        });
    });
    return most;
}

void VoxelGrid::trim()
{
    const auto edge = static_cast<float>(band());
    if (edge == 0.0f) {
        values = SparseLattice<float>(values.size(), values.outside());
        return;
    }
    // The rim keeps its value, so that the function stays continuous where the lattice ends.
    const float air = std::min(values.outside(), edge);
    // Points that are corners of crossed cells, by blocks.
    SparseLattice<std::uint8_t> needed(values.size(), 0);
    each_doubtful_block(values, [&](const Index3& b) {
        each_crossed_cell(values, b, [&](const Index3& c, const std::array<float, 8>&) {
            for (int n = 0; n < 8; ++n) needed.set({c[0] + (n >> 2), c[1] + ((n >> 1) & 1), c[2] + (n & 1)}, 1);
        });
    });
    SparseLattice<float> kept(values.size(), air);
    const auto within_band = [&](float x) { return x < 0.0f ? std::max(x, -edge) : std::clamp(x, just_air, std::max(edge, just_air)); };
    const auto trim_block = [&](const Index3& b) {
        const auto view = values.block(b);
        if (!needed.block(b).block) {
            // All of its points are on one side, or one of its cells would be crossed.
            const float any = view.block ? (*view.block)[0] : view.constant;
            kept.set_block(b, any < 0.0f ? -edge : air);
        } else if (!view.block) {
            kept.set_block(b, within_band(view.constant));
        } else {
            SparseLattice<float>::Block& out = kept.touch(b);
            std::transform(view.block->begin(), view.block->end(), out.begin(), within_band);
        }
    };
    values.each_node([&](const Index3& n) {
        float constant = 0.0f;
        std::uint8_t none = 0;
        if (values.constant_node(n, constant) && needed.constant_node(n, none)) {
            kept.set_node(n, constant < 0.0f ? -edge : air);
        } else {
            values.each_block_of(n, trim_block);
        }
    });
    kept.prune();
    values = std::move(kept);
}

}  // namespace hoodoo
