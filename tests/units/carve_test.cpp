// The carving tool against geometry, and the settling that ends every edit.
#include "terrain/edit/carve.h"

#include "terrain/error.h"
#include "tests/stacks.h"
#include "terrain/stack/merge_and_sort.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using Column = std::vector<Layer>;

MaterialStack block(int n, double cell, double unit, std::int32_t top, Vec3d origin = Vec3d(0.0))
{
    MaterialStack stack({n, n}, cell, unit, origin);
    stack.set_columns({0, 0}, {n, n}, std::vector<Column>(static_cast<std::size_t>(n * n), {{Material::bedrock, top}}));
    return stack;
}

TEST(MergeAndSort, lays_loose_material_down_in_its_pocket)
{
    using enum Material;
    // Floor of bedrock to 4, roof from 20 to 25. Rock, air, sand, water, soil between; sand above the roof.
    const Column loose = {{bedrock, 4}, {rock, 6}, {air, 9}, {sand, 10}, {water, 13}, {soil, 15}, {air, 20}, {bedrock, 25}, {air, 27}, {sand, 30}};
    const Column settled = {{bedrock, 4}, {sand, 5}, {soil, 7}, {rock, 9}, {water, 12}, {air, 20}, {bedrock, 25}, {sand, 28}};
    EXPECT_EQ(merge_and_sort(loose), settled);
    EXPECT_EQ(merge_and_sort(settled), settled);
    EXPECT_TRUE(merge_and_sort(Column{{air, 9}}).empty());
    EXPECT_EQ(merge_and_sort(Column{{air, 9}, {sand, 11}}), (Column{{sand, 2}}));
}

TEST(MergeAndSort, keeps_the_thickness_of_every_material)
{
    const auto stack = testing::random_stack(12, {20, 20}, 1.0, 1.0, 200);
    for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 20; ++i) {
            std::array<std::int32_t, kMaterialCount> before{}, after{};
            const auto measure = [](const Column& column, auto& sums) {
                std::int32_t below = 0;
                for (const Layer& layer : column) {
                    sums[static_cast<std::size_t>(layer.material)] += layer.top - below;
                    below = layer.top;
                }
            };
            measure(stack->column(i, j), before);
            measure(merge_and_sort(stack->column(i, j)), after);
            for (const Material m : {Material::water, Material::sand, Material::bedrock, Material::rock, Material::soil}) {
                EXPECT_EQ(before[static_cast<std::size_t>(m)], after[static_cast<std::size_t>(m)]);
            }
        }
    }
}

double air_below_top(const MaterialStack& stack, double top_units)
{
    double volume = 0.0;
    for (int j = 0; j < stack.size().y; ++j) {
        for (int i = 0; i < stack.size().x; ++i) {
            double matter = 0.0;
            std::int32_t below = 0;
            for (const Layer& layer : stack.column(i, j)) {
                if (layer.material != Material::air) matter += layer.top - below;
                below = layer.top;
            }
            volume += (top_units - matter) * stack.unit() * stack.cell() * stack.cell();
        }
    }
    return volume;
}

TEST(Carve, a_ball_leaves_its_volume)
{
    // 4/3 pi 5^3 = 523.6 m3; cells of 0.25 m: the midpoint rule errs by far less than 1 %.
    MaterialStack stack = block(64, 0.25, 0.01, 2000, Vec3d(1000, -500, 50));
    const std::size_t changed = carve(stack, {.points = {Vec3d(1008, -492, 60)}, .radii = {5.0}}).count();
    EXPECT_NEAR(air_below_top(stack, 2000), 4.0 / 3.0 * M_PI * 125, 2.0);
    EXPECT_NEAR(static_cast<double>(changed), M_PI * 25 / 0.0625, 12);
    EXPECT_EQ(stack.column(32, 32)[0].top, 500);  // 60 - 5 - 50 = 5 m; the middle of the column is 0.18 m off the axis, which is 3 mm of height
    EXPECT_EQ(stack.column(32, 32)[1].material, Material::air);
    EXPECT_EQ(stack.column(0, 0), (Column{{Material::bedrock, 2000}}));
}

TEST(Carve, a_tunnel_has_the_volume_of_a_capsule_and_a_smooth_wall)
{
    MaterialStack stack = block(80, 0.25, 0.01, 2000);
    carve(stack, {.points = {Vec3d(6, 10, 10), Vec3d(14, 10, 10)}, .radii = {3.0}});
    EXPECT_NEAR(air_below_top(stack, 2000), M_PI * 9 * 8 + 4.0 / 3.0 * M_PI * 27, 2.0);
    // Along the axis the floor is even: between balls it rises by at most half a unit, which rounding may turn into one.
    for (int i = 24; i < 56; ++i) EXPECT_NEAR(stack.column(i, 40)[0].top, 700, 1);
}

TEST(Carve, sand_over_the_hole_falls_to_its_floor_where_no_roof_is_left)
{
    MaterialStack stack({9, 9}, 1.0, 0.1);
    stack.set_columns({0, 0}, {9, 9}, std::vector<Column>(81, {{Material::bedrock, 100}, {Material::sand, 120}}));
    carve(stack, {.points = {Vec3d(4.5, 4.5, 9.0)}, .radii = {2.0}});
    // Removed: 7 to 11 m. What is left of the sand, 11 to 12 m, lies on the floor at 7 m.
    EXPECT_EQ(stack.column(4, 4), (Column{{Material::bedrock, 70}, {Material::sand, 80}}));
    EXPECT_EQ(stack.column(0, 0), (Column{{Material::bedrock, 100}, {Material::sand, 120}}));
}

TEST(Carve, leaves_columns_alone_that_it_only_meets_in_air)
{
    MaterialStack stack({5, 5}, 1.0, 0.1);
    const Column floating = {{Material::bedrock, 10}, {Material::air, 90}, {Material::rock, 100}};
    stack.set_columns({0, 0}, {5, 5}, std::vector<Column>(25, floating));
    EXPECT_TRUE(carve(stack, {.points = {Vec3d(2.5, 2.5, 5.0)}, .radii = {2.0}}).empty());
    EXPECT_EQ(stack.column(2, 2), floating);
    EXPECT_TRUE(carve(stack, {.points = {Vec3d(2000, 2.5, 5.0)}, .radii = {2.0}}).empty());
}

TEST(Carve, rough_walls_move_by_no_more_than_their_share_and_by_more_than_nothing)
{
    MaterialStack smooth = block(64, 0.25, 0.01, 2000), least = smooth, most = smooth, rough = smooth;
    const Vec3d centre(8, 8, 10);
    carve(smooth, {.points = {centre}, .radii = {4.0}});
    carve(least, {.points = {centre}, .radii = {3.0}});
    carve(most, {.points = {centre}, .radii = {5.0}});
    carve(rough, {.points = {centre}, .radii = {4.0}, .roughness = 0.25, .wavelength = 2.0, .seed = 3});
    EXPECT_GT(air_below_top(rough, 2000), air_below_top(least, 2000));
    EXPECT_LT(air_below_top(rough, 2000), air_below_top(most, 2000));
    int different = 0;
    for (int k = 20; k < 44; ++k) different += rough.column(k, 32) != smooth.column(k, 32);
    EXPECT_GT(different, 18);
}

TEST(Carve, refuses_sweeps_without_sense)
{
    MaterialStack stack = block(4, 1.0, 0.1, 10);
    EXPECT_THROW(carve(stack, {.points = {}, .radii = {1.0}}), Error);
    EXPECT_THROW(carve(stack, {.points = {Vec3d(0.0)}, .radii = {}}), Error);
    EXPECT_THROW(carve(stack, {.points = {Vec3d(0.0)}, .radii = {-1.0}}), Error);
    EXPECT_THROW(carve(stack, {.points = {Vec3d(std::nan(""))}, .radii = {1.0}}), Error);
    EXPECT_THROW(carve(stack, {.points = {Vec3d(0.0), Vec3d(1e12, 0, 0)}, .radii = {0.01}}), Error);
}

}  // namespace
}  // namespace hoodoo
