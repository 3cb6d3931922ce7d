// Each sample of the surface loses matter at a rate that grows with the air around it; a face sees half a ball of it, an edge three quarters.
//
// Beardall2007, as maths A9 reads it: "the decay rate of a surface voxel is the share of air in a bubble around it; it goes when what has decayed
// exceeds its durability". Here a sample keeps its remaining share of matter, so that the surface moves smoothly between samples:
//   d share / dt = -(2 e)^power |n|_1 / durability,   e the air in the bubble, n the direction towards that air, |n|_1 = |nx| + |ny| + |nz|.
// Only samples decay that have nothing left beside them along an axis. Such a layer has 1 / |n|_1 samples for each face of a cell that the surface
// would cover, so the factor |n|_1 makes a face go back equally fast whichever way it looks (2 e = 1 on a face: by one cell a unit of time).
// The air is summed by columns of the ball, from running sums along z, in tiles of 32^3 samples with a margin; a tile without surface is skipped, so
// time and memory follow the surface. Deviations: the paper removes whole voxels, and wears concave corners by curvature (Jones2010), which we do
// not. Missing: deposits of what decayed; what falls vanishes.
#include "terrain/edit/weather.h"

#include "terrain/error.h"
#include "terrain/fields/lattice_box.h"
#include "terrain/math/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hoodoo
{

namespace
{

constexpr int kTile = 32;
constexpr double kStep = 0.25;  ///< of a cell, by which a flat face goes back in one step

/// A column of the ball, relative to its centre.
struct BallColumn {
    int i, j, half;
};

struct Ball {
    std::vector<BallColumn> columns;
    int reach = 0;
    double count = 0.0;
};

Ball make_ball(double radius)
{
    Ball ball;
    ball.reach = static_cast<int>(std::floor(radius));
    for (int i = -ball.reach; i <= ball.reach; ++i)
        for (int j = -ball.reach; j <= ball.reach; ++j) {
            const double rest = radius * radius - i * i - j * j;
            if (rest < 0.0) continue;
            const int half = static_cast<int>(std::floor(std::sqrt(rest)));
            ball.columns.push_back({i, j, half});
            ball.count += 2 * half + 1;
        }
    return ball;
}

struct Change {
    Index3 at;
    float share;    ///< below 0: more than all of it decayed
    Index3 behind;  ///< the sample farther from the air, which loses the rest
};

/// Air in the ball: how much, and which way.
struct Air {
    double share = 0.0;
    Vec3d towards{0.0};
};

/// A tile's samples with running sums of air, and of air times height, along z.
class AirTile
{
public:
    AirTile(const SparseLattice<float>& shares, const Index3& corner, const Index3& size, const Ball& ball, int ground)
        : ball_(ball), margin_(ball.reach + 1)
    {
        for (std::size_t k = 0; k < 3; ++k) {
            box_.lo[k] = corner[k] - margin_;
            box_.size[k] = size[k] + 2 * margin_;
        }
        box_.read(shares);
        ground_ = std::clamp(ground - box_.lo[2], 0, box_.size[2]);
    }

    void sum()
    {
        sums_.resize(box_.values.size());
        moments_.resize(box_.values.size());
        for (std::size_t row = 0; row < box_.values.size(); row += static_cast<std::size_t>(box_.size[2])) {
            double air = 0.0, moment = 0.0;
            for (int k = 0; k < box_.size[2]; ++k) {
                const std::size_t n = row + static_cast<std::size_t>(k);
                const double here = k < ground_ ? 0.0 : 1.0 - box_.values[n];
                sums_[n] = air += here;
                moments_[n] = moment += here * k;
            }
        }
    }

    float share(const Index3& p) const { return box_.values[at(p)]; }

    /// Whether nothing is left at one of the six samples beside it.
    bool is_bare(const Index3& p) const
    {
        const int k = p[2] - box_.lo[2];
        const std::size_t n = at(p), x = static_cast<std::size_t>(box_.size[1]) * static_cast<std::size_t>(box_.size[2]),
                          y = static_cast<std::size_t>(box_.size[2]);
        const std::vector<float>& v = box_.values;
        return v[n - x] <= 0.0f || v[n + x] <= 0.0f || v[n - y] <= 0.0f || v[n + y] <= 0.0f || v[n + 1] <= 0.0f || (k > ground_ && v[n - 1] <= 0.0f);
    }

    Air air(const Index3& p) const
    {
        Air out;
        const int i = p[0] - box_.lo[0], j = p[1] - box_.lo[1], k = p[2] - box_.lo[2];
        for (const BallColumn& c : ball_.columns) {
            const std::size_t top = box_.index(i + c.i, j + c.j, k + c.half), below = box_.index(i + c.i, j + c.j, k - c.half - 1);
            const double here = sums_[top] - sums_[below], moment = moments_[top] - moments_[below];
            out.share += here;
            out.towards += Vec3d(c.i * here, c.j * here, moment - k * here);
        }
        out.share /= ball_.count;
        return out;
    }

private:
    std::size_t at(const Index3& p) const { return box_.index(p[0] - box_.lo[0], p[1] - box_.lo[1], p[2] - box_.lo[2]); }

    const Ball& ball_;
    int margin_, ground_;
    LatticeBox box_;
    std::vector<double> sums_, moments_;
};

/// Tiles that hold a sample between matter and air, by their corners.
std::vector<Index3> tiles_with_surface(const SparseLattice<float>& shares)
{
    std::vector<Index3> tiles;
    const Index3& n = shares.size();
    constexpr int kBlocks = kTile / 8;
    for (int x = 0; x < n[0]; x += kTile)
        for (int y = 0; y < n[1]; y += kTile)
            for (int z = 0; z < n[2]; z += kTile) {
                // With the blocks around: two constant blocks of different values meet in a surface.
                std::optional<float> first;
                bool mixed = false;
                for (int i = x / 8 - 1; i <= x / 8 + kBlocks && !mixed; ++i)
                    for (int j = y / 8 - 1; j <= y / 8 + kBlocks && !mixed; ++j)
                        for (int k = z / 8 - 1; k <= z / 8 + kBlocks && !mixed; ++k) {
                            const auto view = shares.block({i, j, k});
                            if (!first) first = view.constant;
                            mixed = view.block || view.constant != *first;
                        }
                if (mixed) tiles.push_back({x, y, z});
            }
    return tiles;
}

void check(const VoxelGrid& grid, const WeatherOptions& o)
{
    const double bubble = o.bubble / grid.cell, depth = o.depth / grid.cell;
    if (!(bubble >= 1.0 && bubble <= 32.0))
        throw Error(ErrorKind::scene, Problem{{},
                                              "the bubble in which weathering counts the air",
                                              fmt::format("1 to 32 cells ({:.6g} to {:.6g} m)", grid.cell, 32.0 * grid.cell),
                                              fmt::format("{:.6g} m", o.bubble),
                                              {}});
    if (!(depth >= 0.0 && depth <= 1000.0))
        throw Error(ErrorKind::scene, Problem{{},
                                              "the depth to which weathering goes",
                                              fmt::format("0 to 1000 cells ({:.6g} m)", 1000.0 * grid.cell),
                                              fmt::format("{:.6g} m", o.depth),
                                              {}});
}

/// Lowest sample that decays, counted along z. Below it, even below the lattice, the air counts as rock.
int ground_sample(const VoxelGrid& grid, double ground)
{
    return static_cast<int>(std::clamp(std::ceil(grid.local(Vec3d(0.0, 0.0, ground)).z), 1.0, static_cast<double>(grid.values.size()[2])));
}

/// What one tile loses in a step; `loss` is what a flat face of durability 1 does.
std::vector<Change> decay(const VoxelGrid& grid, const SparseLattice<float>& shares, const Index3& corner, const Ball& ball, int ground, double loss,
                          const WeatherOptions& o)
{
    std::vector<Change> changes;
    Index3 size;
    for (std::size_t k = 0; k < 3; ++k) size[k] = std::min(kTile, shares.size()[k] - corner[k]);
    AirTile tile(shares, corner, size, ball, ground);
    bool summed = false;
    for (int i = corner[0]; i < corner[0] + size[0]; ++i)
        for (int j = corner[1]; j < corner[1] + size[1]; ++j)
            for (int k = std::max(corner[2], ground); k < corner[2] + size[2]; ++k) {
                const Index3 p{i, j, k};
                const float share = tile.share(p);
                if (share <= 0.0f || !tile.is_bare(p)) continue;
                if (!summed) tile.sum(), summed = true;
                const Air air = tile.air(p);
                const double length = air.towards.length();
                const double faces = length > 0.0 ? (std::abs(air.towards.x) + std::abs(air.towards.y) + std::abs(air.towards.z)) / length : 1.0;
                const double lasts = o.durability ? o.durability(grid.world(Vec3d(i, j, k))) : 1.0;
                const double rest = share - loss * std::pow(2.0 * air.share, o.power) * faces / lasts;
                std::size_t axis = 0;
                for (std::size_t a = 1; a < 3; ++a)
                    if (std::abs(air.towards[static_cast<int>(a)]) > std::abs(air.towards[static_cast<int>(axis)])) axis = a;
                Index3 behind = p;
                behind[axis] += air.towards[static_cast<int>(axis)] > 0.0 ? -1 : 1;
                changes.push_back({p, static_cast<float>(rest), behind});
            }
    return changes;
}

}  // namespace

double exposure(const VoxelGrid& grid, const Index3& sample, double bubble)
{
    const Ball ball = make_ball(bubble / grid.cell);
    AirTile tile(matter_shares(grid), sample, {1, 1, 1}, ball, -(1 << 20));
    tile.sum();
    return tile.air(sample).share;
}

void weather(VoxelGrid& grid, const WeatherOptions& o)
{
    check(grid, o);
    SparseLattice<float> shares = matter_shares(grid);
    const Ball ball = make_ball(o.bubble / grid.cell);
    const int ground = ground_sample(grid, o.ground), steps = static_cast<int>(std::ceil(o.depth / (kStep * grid.cell)));
    const double loss = steps > 0 ? o.depth / grid.cell / steps : 0.0;
    for (int step = 0; step < steps; ++step) {
        const std::vector<Index3> tiles = tiles_with_surface(shares);
        std::vector<std::vector<Change>> changes(tiles.size());
        parallel_items(tiles.size(), [&](std::size_t n) { changes[n] = decay(grid, shares, tiles[n], ball, ground, loss, o); });
        for (const auto& list : changes)
            for (const Change& change : list) shares.set(change.at, std::max(0.0f, change.share));
        // What decayed beyond a sample's own share: without it every layer would last up to a step too long.
        for (const auto& list : changes)
            for (const Change& change : list) {
                if (change.share >= 0.0f || change.behind[2] < ground) continue;
                if (const float left = shares.at(change.behind); left > 0.0f) shares.set(change.behind, std::max(0.0f, left + change.share));
            }
        if (step % 16 == 15) shares.prune();
        if (o.progress) o.progress((step + 1.0) / steps);
    }
    set_matter_shares(grid, shares);
    if (o.drop) drop_unsupported(grid, o.ground);
}

}  // namespace hoodoo
