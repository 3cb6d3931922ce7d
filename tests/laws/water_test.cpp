// Water as an interface of its own: the laws of surfaces, and that it meets the ground without a gap and without fighting it.
#include "tests/counts.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/numbers.h"
#include "tests/expect_law.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

constexpr double kLevel = 3.0;

/// A bowl with an island, filled to 3 m, a pit beside it that stays dry, and a cave whose mouth lies under water.
RowInstance tarn(const std::string& more)
{
    return {"convolution", "tarn", [more](const Vec3d& s) {
                const auto at = [&](double x, double y, double z) { return fmt::format("[{}, {}, {}]", x + s.x, y + s.y, z + s.z); };
                return fmt::format(
                    "columns = [40, 40]\ncell = 0.5\nunit = 0.015625\norigin = {}\n{}\n"
                    "[[layer]]\nshape = \"flat\"\ntop = 5.0\n"
                    "[[edit]]\ntool = \"sweep\"\npoints = [{}, {}]\nradius = [3.6, 2.6]\n"
                    "[[edit]]\ntool = \"sweep\"\npoints = [{}]\nradius = [1.7]\n"
                    "[[edit]]\ntool = \"sweep\"\npoints = [{}, {}]\nradius = [0.8]\n"
                    "[[edit]]\ntool = \"deposit\"\nmaterial = \"rock\"\npoints = [{}]\nradius = [1.2]\namount = 2.5\n"
                    "[[edit]]\ntool = \"fill\"\nseed = {}\nlevel = {}\n",
                    at(0, 0, 0), more, at(6, 9, 4.4), at(12, 11, 4.2), at(17, 4, 4.6), at(9, 13, 2.4), at(9, 18, 2.4), at(7, 8, 5), at(9, 10, 4.5),
                    kLevel + s.z);
            }};
}

class WaterLaws : public ::testing::TestWithParam<const char*>
{
protected:
    void SetUp() override
    {
        try {
            built_ = build_row(tarn(GetParam()));
        } catch (const Error& error) {
            FAIL() << error.what();
        }
        rays_ = law_rays(surface(), 31, count(600, 6000));
    }
    const Surface& surface() const { return built_.surface(); }

    BuiltRow built_;
    std::vector<Ray> rays_;
};

TEST_P(WaterLaws, hold_for_a_surface_with_water)
{
    ASSERT_TRUE(std::ranges::count(surface().materials(), "water"));
    EXPECT_LAW(bounds_contain_hits(surface(), rays_));
    EXPECT_LAW(occluded_agrees(surface(), rays_));
    EXPECT_LAW(spawned_rays_leave(surface(), rays_));
    EXPECT_LAW(same_bits(surface(), build_row(tarn(GetParam())).surface(), rays_));
    EXPECT_LAW(closed_leaks_none(surface(), 5, count(3000, 100000)));
    for (const Vec3d& shift : {Vec3d(64.0, -128.0, 16.0), Vec3d(4e6, 3e6, 1000.0)}) {
        const BuiltRow far = build_row(tarn(GetParam()), shift);
        EXPECT_LAW(translation_moves_hits(surface(), far.surface(), shift, rays_));
        const std::vector<Ray> rays = law_rays(far.surface(), 32, count(200, 2000));
        EXPECT_LAW(bounds_contain_hits(far.surface(), rays));
        EXPECT_LAW(spawned_rays_leave(far.surface(), rays));
        EXPECT_LAW(closed_leaks_none(far.surface(), 6, count(500, 20000)));
    }
}

/// Rays from the air over the grid onto the lake and its shores: each meets water exactly at its level, or ground that is not under it. Nothing else.
Verdict shores_are_closed(const Surface& surface, int n)
{
    int wet = 0, dry = 0;
    for (int k = 0; k < n; ++k) {
        Numbers random(77, static_cast<std::uint64_t>(k));
        Ray ray;
        ray.crossing = Crossing::entering;
        // Aimed at a point at the level, steep and flat alike; the dry pit in the corner is left out.
        const Vec3d target(1.0 + 12.5 * random(), 4.0 + 11.0 * random(), kLevel);
        const double angle = 6.283185307179586 * random(), height = std::pow(random(), 3.0) * 1.5 + 0.002;
        const Vec3d from(std::cos(angle) * std::cos(height), std::sin(angle) * std::cos(height), std::sin(height));
        ray.origin = target + from * (0.2 + 12.0 * random());
        ray.direction = -from;
        const bool over = std::min(ray.origin.x, ray.origin.y) > 0.0 && std::max(ray.origin.x, ray.origin.y) < 20.0;
        if (!over || surface.contains(ray.origin)) continue;  // the ground goes on beyond the grid, but its surface does not
        const Hit hit = nearest_hit(surface, ray);
        if (!std::isfinite(hit.t)) return {fmt::format("ray {} fell through", k)};
        const Interaction at = surface.interact(ray, hit);
        const bool water = surface.materials()[at.materials.index[0]] == "water";
        if (water && at.geometric_normal.z == 1.0) {
            ++wet;
            if (!(std::abs(at.position.z - kLevel) < 1e-9)) return {fmt::format("water at {} m", at.position.z)};
        } else {
            ++dry;
            if (at.position.z < kLevel - 1e-6 && at.position.x > 0.5 && at.position.x < 14.0 && at.position.y > 3.0 && at.position.y < 15.5)
                return {fmt::format("dry at ({}, {}, {})", at.position.x, at.position.y, at.position.z)};
        }
    }
    if (wet < n / 10 || dry < n / 10) return {fmt::format("{} wet and {} dry rays prove nothing", wet, dry)};
    return {};
}

TEST_P(WaterLaws, shores_are_closed)
{
    EXPECT_LAW(shores_are_closed(surface(), count(6000, 300000)));
}

TEST_P(WaterLaws, the_same_ground_without_water_breaks_the_law_of_shores)
{
    EXPECT_FALSE(shores_are_closed(build_row(tarn(std::string("water = \"hidden\"\n") + GetParam())).surface(), 6000).holds());
}

TEST_P(WaterLaws, water_lies_below_its_level_and_nowhere_else)
{
    const Box3d box = surface_bounds(surface());
    int wet = 0;
    const BuiltRow dry = build_row(tarn(std::string("water = \"hidden\"\n") + GetParam()));
    for (int k = 0; k < 20000; ++k) {
        Numbers random(3, static_cast<std::uint64_t>(k));
        const Vec3d p = random.in(box);
        if (surface().contains(p) == dry.surface().contains(p)) continue;
        ++wet;
        EXPECT_LE(p.z, kLevel + 1e-12);
        EXPECT_TRUE(surface().contains(p));
    }
    EXPECT_GT(wet, 100);
}

INSTANTIATE_TEST_SUITE_P(Kernels, WaterLaws,
                         ::testing::Values("sigma_cells = 1.0", "sigma_cells = 1.5", "sigma_cells = 0.8\nintersector = \"sphere\"",
                                           "border = \"cut\"\nsigma_cells = 1.5"));

TEST(Water, is_a_wall_at_the_edge_of_a_cut_block_and_none_where_the_ground_goes_on)
{
    for (const bool cut : {true, false}) {
        const RowInstance instance{"convolution", "sea", [cut](const Vec3d&) {
                                       return fmt::format(
                                           "columns = [8, 8]\ncell = 1\nunit = 0.01\nborder = \"{}\"\n[[layer]]\nshape = \"flat\"\ntop = 2.0\n"
                                           "[[layer]]\nshape = \"flat\"\nmaterial = \"water\"\ntop = 6.0\n",
                                           cut ? "cut" : "extend");
                                   }};
        const BuiltRow sea = build_row(instance);
        Ray ray;
        ray.crossing = Crossing::entering;
        ray.origin = Vec3d(-5.0, 4.2, 4.5);
        ray.direction = Vec3d(1.0, 0.0, 0.0);
        const Hit hit = nearest_hit(sea.surface(), ray);
        EXPECT_EQ(std::isfinite(hit.t), cut);
        if (cut) {
            EXPECT_NEAR(hit.t, 5.0, 1e-9);
            EXPECT_EQ(sea.surface().interact(ray, hit).geometric_normal, Vec3d(-1, 0, 0));
        }
        ray.origin = Vec3d(4.0, 4.2, 4.5);  // from inside, looking up
        ray.crossing = Crossing::any;
        ray.direction = Vec3d(0.0, 0.0, 1.0);
        EXPECT_NEAR(nearest_hit(sea.surface(), ray).t, 1.5, 1e-9);
    }
}

}  // namespace
}  // namespace hoodoo
