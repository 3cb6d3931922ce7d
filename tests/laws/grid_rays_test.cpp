// Rays against height grids and against two oracles that share nothing with the walk; and mutants of it that must be caught.

#include "terrain/march/grid_rays.h"
#include "tests/counts.h"
#include "tests/expect_law.h"
#include "terrain/math/hash.h"
#include "tests/support/grid_oracle.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// All blocks, in the given order.
double nearest(const HeightGrid& grid, const Ray& ray, bool backwards = false)
{
    const GridRay walk(grid, ray);
    const int blocks = grid.blocks_across() * grid.blocks_up();
    double t = kInfinity;
    std::uint32_t cells = 0;
    for (int k = 0; k < blocks; ++k) {
        GridCrossing found;
        if (walk.first_in_block(backwards ? blocks - 1 - k : k, t, found, cells)) t = found.t;
    }
    return t;
}

class GridRays : public ::testing::TestWithParam<SampleType>
{
};

TEST_P(GridRays, find_the_nearest_crossing_and_nothing_else)
{
    // Sizes that end within a block and at its border.
    for (const auto& [columns, rows] : {std::pair{37, 41}, std::pair{33, 17}, std::pair{2, 2}}) {
        const HeightGrid grid = rugged_grid(GetParam(), columns, rows, Vec3d(-3.0, 7.0, 100.0));
        const int rays = count(columns > 2 ? 4000 : 500, columns > 2 ? 120000 : 10000);
        int hits = 0;
        for (int n = 0; n < rays; ++n) {
            const Ray ray = grid_ray(grid, 31, static_cast<std::uint64_t>(n));
            const double t = nearest(grid, ray);
            hits += std::isfinite(t);
            const Verdict v = is_nearest_on_grid(grid, ray, t);
            ASSERT_TRUE(v.holds()) << columns << " x " << rows << ", ray " << n << ": " << v.fault;
            ASSERT_EQ(t, nearest(grid, ray, true)) << "ray " << n << " depends on the order of blocks";
        }
        EXPECT_GT(hits, rays / 3);
    }
}

TEST_P(GridRays, hold_far_from_the_origin)
{
    const HeightGrid grid = rugged_grid(GetParam(), 37, 41, Vec3d(4e6, 3e6, 1000.0));
    for (int n = 0; n < count(1000, 20000); ++n) {
        const Ray ray = grid_ray(grid, 32, static_cast<std::uint64_t>(n));
        const Verdict v = is_nearest_on_grid(grid, ray, nearest(grid, ray));
        ASSERT_TRUE(v.holds()) << "ray " << n << ": " << v.fault;
    }
}

std::string type_name(const ::testing::TestParamInfo<SampleType>& i)
{
    static const std::vector<std::string> names{"u8", "u16", "i16", "f32"};
    return names[static_cast<std::size_t>(i.param)];
}
INSTANTIATE_TEST_SUITE_P(Samples, GridRays, ::testing::Values(SampleType::u8, SampleType::u16, SampleType::i16, SampleType::f32), type_name);

/// From certainly above to certainly below, straight through nodes, edges and the corners where four blocks meet: some triangle must be met.
TEST(GridRaysEdges, no_ray_slips_between_triangles_or_blocks)
{
    HeightGrid grid({Vec3d(0.0), {1.0, 1.0}, 1.0}, 49, 49, SampleType::f32);
    for (int j = 0; j < 49; ++j)
        for (int i = 0; i < 49; ++i) grid.set(i, j, unit_real(hash_cell(3, i, j)));
    grid.summarise();
    int met = 0, rays = 0;
    for (int n = 0; n < count(20000, 400000); ++n) {
        // Nodes at the corners of blocks every other time; the target lies on the node, or on an edge or a diagonal from it.
        const auto h = static_cast<std::uint64_t>(n);
        const double share = n % 3 == 0 ? 0.0 : unit_real(hash_cell(5, n, 1));
        const int i = n % 2 ? 16 * (1 + n / 2 % 2) : 1 + static_cast<int>(46.0 * unit_real(hash_cell(5, n, 2)));
        const int j = n % 2 ? 16 * (1 + n / 4 % 2) : 1 + static_cast<int>(46.0 * unit_real(hash_cell(5, n, 3)));
        const int di = n % 5 == 0 ? 1 : n % 5 == 1 ? 0 : -1, dj = n % 5 == 0 ? 0 : 1;
        const double lift = grid.sample(i, j) * (1.0 - share) + grid.sample(i + di, j + dj) * share;
        const Vec3d target(i + di * share, j + dj * share, lift);
        // Directions of simple fractions: passings of lines coincide.
        const Vec3d direction =
            Vec3d(static_cast<double>(mix64(h) % 9) - 4.0, static_cast<double>(mix64(h + 7) % 9) - 4.0, -1.0 - static_cast<double>(mix64(h + 9) % 5))
                .normalized();
        Ray ray;
        ray.direction = direction;
        ray.origin = target - direction * ((2.0 - lift) / -direction.z);
        ray.t_max = 3.5 / -direction.z;
        const Vec3d end = ray.at(ray.t_max);
        if (std::min({ray.origin.x, ray.origin.y, end.x, end.y}) < 0.0 || std::max({ray.origin.x, ray.origin.y, end.x, end.y}) > 48.0) continue;
        ++rays;
        met += std::isfinite(nearest(grid, ray));
    }
    EXPECT_EQ(met, rays);
    EXPECT_GT(rays, count(10000, 200000));
}

// -- Mutants: what the oracle must catch --------------------------------------------------------------------------------------------------

TEST(GridOracle, catches_a_walk_that_forgets_diagonals_or_cells)
{
    const HeightGrid grid = rugged_grid(SampleType::u16, 37, 41, Vec3d(0.0));
    int pushed = 0, missed = 0, early = 0;
    for (int n = 0; n < 400; ++n) {
        const Ray ray = grid_ray(grid, 33, static_cast<std::uint64_t>(n));
        const double t = nearest(grid, ray);
        if (!std::isfinite(t)) continue;
        pushed += !is_nearest_on_grid(grid, ray, t + 1e-6).holds();
        early += !is_nearest_on_grid(grid, ray, t - 1e-6).holds();
        missed += !is_nearest_on_grid(grid, ray, kInfinity).holds();
    }
    EXPECT_GT(pushed, 150);
    EXPECT_GT(early, 150);
    EXPECT_GT(missed, 150);
}

}  // namespace
}  // namespace hoodoo
