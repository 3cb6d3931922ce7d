// A solid sampled on a lattice: one number a sample, negative in matter, and on demand what it is made of.
#pragma once

#include "terrain/fields/sparse_lattice.h"
#include "terrain/math/vec.h"

#include <optional>
#include <string>
#include <vector>

namespace hoodoo
{

/// Sample (i, j, k) stands at origin + cell (i, j, k) for the values of an implicit function F: matter where F < 0. Between samples F is trilinear.
/// The outermost layer of samples is air, so every solid is closed. Reading is thread-safe, writing is not.
struct VoxelGrid {
    /// `inner` samples along each axis, surrounded by a layer of air; all are `air` (above 0) at first. `first` is where the first inner one stands.
    /// Throws Error (scene): a cell that is not above 0, a lattice with no sample or with more than 2^16 along an axis.
    VoxelGrid(const Index3& inner, double cell, const Vec3d& first, float air);

    double cell;   ///< metres between neighbouring samples
    Vec3d origin;  ///< of sample (0, 0, 0), which is air
    SparseLattice<float> values;
    std::optional<SparseLattice<std::uint8_t>> materials;  ///< of each sample, an index into `names`; absent: all is names[0]
    std::vector<std::string> names;

    VoxelGrid copy() const;

    Vec3d local(const Vec3d& p) const { return (p - origin) / cell; }  ///< in cells
    Vec3d world(const Vec3d& q) const { return origin + q * cell; }
    Box3d box() const;  ///< of all samples, world space

    /// Value of a sample that may lie beyond the lattice.
    float at(const Index3& p) const { return values.at(p); }
    /// Precondition: an inner sample. A value of exactly 0 is air, and becomes just_air.
    void set(const Index3& p, float value) { values.set(p, value == 0.0f ? just_air : value); }
    /// Samples at the level itself would make whole faces of cells vanish, which are neither side: instead of 0 they have this, above 0.
    static constexpr float just_air = 1e-30f;

    /// Keeps what the surface is made of: samples of cells that the surface crosses keep their values, all others at least their side of it, and what
    /// is farther than a block keeps nothing else. Values become at most `band()` in magnitude. The surface itself keeps its bits. Memory then
    /// follows the area of the surface.
    void trim();

    /// The largest |F| among samples of cells that the surface crosses; 0 without a surface.
    double band() const;

    std::uint64_t memory_bytes() const { return values.memory_bytes() + (materials ? materials->memory_bytes() : 0); }
};

/// The corners of a cell.
inline std::array<float, 8> cell_corners(const SparseLattice<float>& values, const Index3& c)
{
    std::array<float, 8> f;
    if ((c[0] & 7) < 7 && (c[1] & 7) < 7 && (c[2] & 7) < 7 && values.holds(c)) {
        const auto view = values.block({c[0] / 8, c[1] / 8, c[2] / 8});
        if (!view.block) {
            f.fill(view.constant);
            return f;
        }
        if (values.holds({c[0] + 1, c[1] + 1, c[2] + 1})) {
            const float* p = view.block->data() + SparseLattice<float>::within(c);
            return {p[0], p[1], p[8], p[9], p[64], p[65], p[72], p[73]};
        }
    }
    for (int n = 0; n < 8; ++n) f[static_cast<std::size_t>(n)] = values.at({c[0] + (n >> 2), c[1] + ((n >> 1) & 1), c[2] + (n & 1)});
    return f;
}

/// Whether the surface passes through a cell with these corners: some are matter and some are not.
inline bool is_crossed(const std::array<float, 8>& f)
{
    int inside = 0;
    for (const float x : f) inside += x < 0.0f;
    return inside != 0 && inside != 8;
}

/// Blocks of cells that can hold a crossing: visit(b) for each block b such that cells 8 b to 8 b + 7 have corners of both signs, or are in doubt.
template <class Visit>
void each_doubtful_block(const SparseLattice<float>& values, const Visit& visit)
{
    using Lattice = SparseLattice<float>;
    // One sign over the eight blocks (or nodes) that a block (node) of cells has its corners in: no crossing.
    const auto one_sign = [](const Index3& at, const auto& sign) {
        int sum = 0;
        for (int n = 0; n < 8; ++n) sum += sign({at[0] + (n >> 2), at[1] + ((n >> 1) & 1), at[2] + (n & 1)});
        return sum == 8 || sum == -8;
    };
    const auto node_sign = [&](const Index3& n) {
        float constant = 0.0f;
        return values.constant_node(n, constant) ? (constant < 0.0f ? -1 : 1) : 0;
    };
    const auto block_sign = [&](const Index3& b) {
        const Lattice::View view = values.block(b);
        return view.block ? 0 : (view.constant < 0.0f ? -1 : 1);
    };
    values.each_node([&](const Index3& n) {
        if (one_sign(n, node_sign)) return;
        values.each_block_of(n, [&](const Index3& b) {
            if (!one_sign(b, block_sign)) visit(b);
        });
    });
}

/// visit(c, corners) for every cell of a block of cells that the surface crosses, k fastest.
template <class Visit>
void each_crossed_cell(const SparseLattice<float>& values, const Index3& b, const Visit& visit)
{
    const Index3& size = values.size();
    for (int i = 8 * b[0]; i < std::min(8 * b[0] + 8, size[0] - 1); ++i)
        for (int j = 8 * b[1]; j < std::min(8 * b[1] + 8, size[1] - 1); ++j)
            for (int k = 8 * b[2]; k < std::min(8 * b[2] + 8, size[2] - 1); ++k) {
                const std::array<float, 8> f = cell_corners(values, {i, j, k});
                if (is_crossed(f)) visit(Index3{i, j, k}, f);
            }
}

/// The trilinear interpolation of corners at (u, v, w) in [0, 1]^3. A combination of the corners with weights that are not negative: it never leaves
/// their range, by a rounding at most.
inline double trilinear(const std::array<float, 8>& f, double u, double v, double w)
{
    const auto mix = [](double a, double b, double t) { return a * (1.0 - t) + b * t; };
    const double y0 = mix(mix(f[0], f[1], w), mix(f[2], f[3], w), v);
    const double y1 = mix(mix(f[4], f[5], w), mix(f[6], f[7], w), v);
    return mix(y0, y1, u);
}

}  // namespace hoodoo
