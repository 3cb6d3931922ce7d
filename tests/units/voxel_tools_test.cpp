// The tools of voxels against what they must do to solids that can be worked out by hand or by three loops.
#include "terrain/edit/voxel_tools.h"
#include "terrain/edit/weather.h"
#include "terrain/fields/lattice_box.h"
#include "terrain/fields/voxel_field.h"
#include "terrain/math/hash.h"
#include "tests/edits.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace hoodoo
{
namespace
{

using testing::error_of;
using testing::list;
using testing::number;
using testing::table;

/// n^3 samples of a cell of 0.1 m from the origin on, values of the function `f` of the world point.
template <class F>
VoxelGrid solid(int n, F&& f)
{
    VoxelGrid grid({n, n, n}, 0.1, Vec3d(0.0), 0.1f);
    for (int i = 1; i <= n; ++i)
        for (int j = 1; j <= n; ++j)
            for (int k = 1; k <= n; ++k) grid.set({i, j, k}, static_cast<float>(f(grid.world(Vec3d(i, j, k)))));
    return grid;
}

double box_distance(const Vec3d& p, const Vec3d& low, const Vec3d& high)
{
    double most = -kInfinity;
    for (int k = 0; k < 3; ++k) most = std::max({most, low[k] - p[k], p[k] - high[k]});
    return most;
}

/// A block from 0.45 m to 0.45 m below the end of n samples: its faces lie half way between samples.
VoxelGrid block(int n = 40)
{
    return solid(n, [&](const Vec3d& p) { return std::clamp(box_distance(p, Vec3d(0.45), Vec3d(0.1 * n - 0.45)), -0.05, 0.05); });
}

/// Where the surface is first met from `from` along a direction, metres.
double surface_from(const VoxelGrid& grid, const Vec3d& from, const Vec3d& direction)
{
    const VoxelField field(std::make_shared<VoxelGrid>(grid.copy()));
    double a = 0.0;
    while (a < 8.0 && field.value(from + direction * a) > 0.0) a += 0.01;
    double b = a - 0.01;
    for (int k = 0; k < 60; ++k) (field.value(from + direction * (0.5 * (a + b))) > 0.0 ? b : a) = 0.5 * (a + b);
    return b;
}

bool same(const VoxelGrid& a, const VoxelGrid& b)
{
    if (a.values.size() != b.values.size()) return false;
    const Index3 n = a.values.size();
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j)
            for (int k = 0; k < n[2]; ++k)
                if (a.at({i, j, k}) != b.at({i, j, k})) return false;
    return true;
}

TEST(VoxelTools, sculpt_adds_a_ball_and_takes_one_away)
{
    VoxelGrid grid({41, 41, 41}, 0.1, Vec3d(-2.0), 0.1f);
    // In the air there is no slope to match: 0.1 a cell of 0.1 m is one a metre, so F is the distance.
    apply_voxel_edit(grid, "sculpt", table({{"points", testing::list({list({0.02, 0.01, -0.03})})}, {"radius", {1.2}}, {"mode", "add"}}), 1, 0);
    const VoxelField field(std::make_shared<VoxelGrid>(grid.copy()));
    // Trilinear interpolation of the distance to a ball of radius r bends by at most 3 cell^2 / (8 r) from it.
    for (int n = 0; n < 200; ++n) {
        const double z = 1.0 - 2.0 * (n + 0.5) / 200.0, phi = 2.39996 * n, s = std::sqrt(1.0 - z * z);
        const Vec3d d(s * std::cos(phi), s * std::sin(phi), z);
        EXPECT_NEAR(field.value(Vec3d(0.02, 0.01, -0.03) + d * 1.2), 0.0, 3.0 * 0.01 / (8.0 * 1.2));
    }
    apply_voxel_edit(grid, "sculpt", table({{"points", testing::list({list({0.0, 0.0, 1.2}), list({0.0, 0.0, 3.0})})}, {"radius", {0.5}}}), 1, 1);
    EXPECT_NEAR(surface_from(grid, Vec3d(0.0, 0.0, 1.9), Vec3d(0, 0, -1)), 1.9 - 0.7, 0.01) << "the bottom of what was taken";
    EXPECT_NEAR(surface_from(grid, Vec3d(0.02, 0.01, -1.9), Vec3d(0, 0, 1)), 1.9 - 1.23, 0.005) << "elsewhere nothing changed";
}

TEST(VoxelTools, smooth_is_the_mean_over_a_cube_of_samples)
{
    // Three loops over a knotted solid against the tool's running sums, over several of its tiles of 32 samples.
    VoxelGrid grid = solid(43, [](const Vec3d& p) {
        return std::clamp(0.05 * (std::sin(4.0 * p.x) + std::sin(5.0 * p.y) * std::cos(3.0 * p.z) + 0.2 * std::sin(17.0 * p.x * p.z)), -0.05, 0.05);
    });
    const SparseLattice<float> shares = matter_shares(grid);
    VoxelGrid smooth = grid.copy();
    apply_voxel_edit(smooth, "smooth", table({{"radius", 0.2}}), 1, 0);
    int crossed = 0;
    each_doubtful_block(smooth.values, [&](const Index3& b) {
        each_crossed_cell(smooth.values, b, [&](const Index3& c, const std::array<float, 8>& f) {
            if (c[0] < 1 || c[1] < 1 || c[2] < 1) return;
            double sum = 0.0;
            for (int i = -2; i <= 2; ++i)
                for (int j = -2; j <= 2; ++j)
                    for (int k = -2; k <= 2; ++k) sum += shares.at({c[0] + i, c[1] + j, c[2] + k});
            EXPECT_NEAR(f[0], 0.5 - sum / 125.0, 1e-5);
            ++crossed;
        });
    });
    EXPECT_GT(crossed, 3000);
    EXPECT_FALSE(same(smooth, grid));
}

TEST(VoxelTools, smoothing_rounds_corners_and_leaves_flat_faces_where_they_are)
{
    VoxelGrid grid = block();
    apply_voxel_edit(grid, "smooth", table({{"radius", 0.3}}), 1, 0);
    EXPECT_NEAR(surface_from(grid, Vec3d(2.0, 2.0, 3.9), Vec3d(0, 0, -1)), 3.9 - 3.55, 0.01);
    // At a corner a cube holds 1/8 of matter, so the surface retreats.
    const Vec3d inwards = Vec3d(-1, -1, -1).normalized();
    EXPECT_GT(surface_from(grid, Vec3d(3.9), inwards), (3.9 - 3.55) * std::sqrt(3.0) + 0.1);
}

TEST(VoxelTools, exposure_is_a_half_on_faces_three_quarters_at_edges_seven_eighths_at_corners)
{
    // The ball stands in the middle of a face's samples, half a cell inside of the face; 8 cells of radius make that 3/(4 16) of a ball.
    const VoxelGrid grid = block();
    const double bubble = 0.8;
    const auto at = [&](double x, double y, double z) {
        const Vec3d q = grid.local(Vec3d(x, y, z));
        return exposure(grid, {static_cast<int>(std::lround(q.x)), static_cast<int>(std::lround(q.y)), static_cast<int>(std::lround(q.z))}, bubble);
    };
    EXPECT_NEAR(at(2.0, 2.0, 3.5), 0.5, 0.05);
    EXPECT_NEAR(at(2.0, 3.5, 3.5), 0.75, 0.05);
    EXPECT_NEAR(at(3.5, 3.5, 3.5), 0.875, 0.05);
    EXPECT_NEAR(at(2.0, 2.0, 2.0), 0.0, 1e-6);
}

TEST(VoxelTools, weathering_takes_its_depth_from_faces_more_from_edges_most_from_corners)
{
    VoxelGrid grid = block();
    apply_voxel_edit(grid, "weather", table({{"depth", 0.4}, {"bubble", 0.4}}), 1, 0);
    const auto retreat = [&](const Vec3d& d) {
        const Vec3d from = Vec3d(2.0) + d * 1.95;
        return surface_from(grid, from, -d.normalized()) - (1.95 - 1.55) * d.length();
    };
    const double face = retreat(Vec3d(0, 0, 1)), edge = retreat(Vec3d(0, 1, 1)), corner = retreat(Vec3d(1, 1, 1));
    // A face goes back by the depth, to a quarter of a cell; along the diagonal an edge has sqrt(2) times as far to go at the least.
    EXPECT_NEAR(face, 0.4, 0.025);
    EXPECT_GT(edge, 1.15 * std::sqrt(2.0) * face);
    EXPECT_GT(corner, 1.15 * std::sqrt(3.0) * face);
    EXPECT_GT(corner, edge);
}

TEST(VoxelTools, hard_beds_last_longer_and_nothing_decays_below_the_ground)
{
    // From 0.45 to 5.55 m; beds are thick against the bubble, so that each goes back as if it were alone.
    VoxelGrid grid = block(60);
    const Node beds = table(
        {{"depth", 0.4}, {"bubble", 0.2}, {"ground", 0.9}, {"bed_heights", {3.2}}, {"bed_durabilities", {1.0, 2.0}}, {"drop", testing::flag(false)}});
    apply_voxel_edit(grid, "weather", beds, 1, 0);
    const auto side = [&](double z) { return surface_from(grid, Vec3d(5.9, 3.0, z), Vec3d(-1, 0, 0)) - (5.9 - 5.55); };
    EXPECT_NEAR(side(0.6), 0.0, 0.005) << "below the ground";
    EXPECT_NEAR(side(2.05), 0.4, 0.025);
    EXPECT_NEAR(side(4.3), 0.2, 0.025) << "twice as durable";
}

TEST(VoxelTools, what_has_lost_its_support_vanishes)
{
    VoxelGrid grid = solid(40, [](const Vec3d& p) {
        const double low = box_distance(p, Vec3d(0.45, 0.45, -1.0), Vec3d(3.55, 3.55, 1.05)),
                     high = box_distance(p, Vec3d(1.45, 1.45, 2.45), Vec3d(2.55));
        return std::clamp(std::min(low, high), -0.05, 0.05);
    });
    const VoxelGrid before = grid.copy();
    // 11 x 11 x 1 samples float: x and y from 1.5 to 2.5, z = 2.5.
    EXPECT_EQ(drop_unsupported(grid, 0.5), 121u);
    EXPECT_EQ(drop_unsupported(grid, 0.5), 0u);
    EXPECT_NEAR(surface_from(grid, Vec3d(2.0, 2.0, 3.5), Vec3d(0, 0, -1)), 3.5 - 1.05, 0.005);
    EXPECT_NEAR(surface_from(before, Vec3d(2.0, 2.0, 3.5), Vec3d(0, 0, -1)), 3.5 - 2.55, 0.005);
}

TEST(VoxelTools, weathering_gives_the_same_bits_for_any_number_of_threads_and_noise_depends_on_seed_and_name)
{
    const auto weathered = [](std::uint64_t seed, const char* name, std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        VoxelGrid grid = block();
        apply_voxel_edit(grid, "weather", table({{"depth", 0.3}, {"bubble", 0.3}, {"noise", 0.7}, {"noise_wavelength", 0.8}, {"name", name}}), seed,
                         0);
        return grid;
    };
    const VoxelGrid one = weathered(1, "rain", 1);
    EXPECT_TRUE(same(one, weathered(1, "rain", 4)));
    EXPECT_FALSE(same(one, weathered(2, "rain", 1)));
    EXPECT_FALSE(same(one, weathered(1, "wind", 1)));
}

TEST(VoxelTools, errors_name_what_cannot_be_and_leave_the_grid_alone)
{
    VoxelGrid grid = block();
    const auto refusal = [&](const char* tool, const Node& parameters) { return error_of([&] { apply_voxel_edit(grid, tool, parameters, 1, 0); }); };
    EXPECT_EQ(refusal("smooth", table({{"radius", 0.01}})), "the radius of a smoothing, expected 1 to 16 cells (0.1 to 1.6 m), got 0.01 m");
    EXPECT_EQ(refusal("smooth", table({{"radius", 1.7}})), "the radius of a smoothing, expected 1 to 16 cells (0.1 to 1.6 m), got 1.7 m");
    EXPECT_EQ(refusal("sculpt", table({{"points", list({list({0.0, 0.0, 0.0})})}, {"radius", {1.0, 2.0}}})),
              "the radii of a path, expected one, or one for each of its points, got 2 for 1 points");
    EXPECT_EQ(refusal("weather", table({{"depth", 0.1}, {"bubble", 0.05}})),
              "the bubble in which weathering counts the air, expected 1 to 32 cells (0.1 to 3.2 m), got 0.05 m");
    EXPECT_EQ(refusal("weather", table({{"depth", 101.0}, {"bubble", 0.3}})),
              "the depth to which weathering goes, expected 0 to 1000 cells (100 m), got 101 m");
    EXPECT_EQ(refusal("weather", table({{"depth", 0.1}, {"bubble", 0.3}, {"bed_heights", {1.0, 2.0}}, {"bed_durabilities", {1.0, 2.0}}})),
              "the durabilities of the beds, expected one more than bed_heights: 3, got 2");
    EXPECT_EQ(refusal("weather", table({{"depth", 0.1}, {"bubble", 0.3}, {"bed_heights", {2.0, 1.0}}, {"bed_durabilities", {1.0, 2.0, 1.0}}})),
              "the heights between beds, expected heights that rise");
    EXPECT_EQ(refusal("wether", table({})).substr(0, 4), "tool");
    EXPECT_TRUE(same(grid, block()));
}

}  // namespace
}  // namespace hoodoo
