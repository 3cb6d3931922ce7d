// One walk over the columns against the plain functions, which are tested against golden values.

#include "terrain/math/hash.h"
#include "terrain/stack/columns_around.h"
#include "terrain/stack/visible.h"
#include "tests/stacks.h"
#include "tests/support/terrains.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

TEST(ConvolutionNeighbourhood, equals_value_gradient_and_smoothed_gradient)
{
    testing::TerrainRecipe recipe;
    recipe.size = Vec2i(48, 40);
    recipe.relief = 40.0;
    const auto stack = testing::make_terrain(recipe);
    for (const Border border : {Border::extend, Border::cut}) {
        for (const double sigma : {0.5, 0.8, 1.0, 1.5, 2.3}) {
            const ConvolutionField field(Ground(stack, kGround, border, 32), sigma);
            for (int k = 0; k < 400; ++k) {
                const auto u = [&](int axis) { return unit_real(hash_cell(7, k, axis)); };
                const Vec3d p(u(0) * 52.0 - 2.0, u(1) * 44.0 - 2.0, u(2) * 44.0 - 2.0);
                const double width = 0.1 + u(3);
                const auto n = field.neighbourhood(p, width);
                EXPECT_NEAR(n.value, field.value(p), 1e-12);
                EXPECT_LT((n.gradient - field.gradient(p)).length(), 1e-11 / sigma);
                EXPECT_LT((n.smoothed - field.smoothed_gradient(p, width)).length(), 1e-11 / sigma / width);
            }
        }
    }
}

/// Points within reach of a hundred centres, in and beyond a stack of `tops` units.
void expect_value_of_field(const ConvolutionField& field, double tops, int count)
{
    const Vec3d size(field.ground().stack().size().x, field.ground().stack().size().y, tops * field.ground().stack().unit());
    for (int k = 0; k < count; ++k) {
        const auto u = [&](int axis) { return unit_real(hash_cell(9, k, axis)); };
        const Vec3d centre = Vec3d(u(0), u(1), u(2)) * (size + Vec3d(6.0)) - Vec3d(3.0);
        const double reach = u(3);
        const ColumnsAround near(field, centre, reach);
        for (int i = 0; i < 20; ++i) {
            const auto v = [&](int axis) { return 2.0 * unit_real(hash_cell(10, k, axis, i)) - 1.0; };
            // Corners of the reach too, where the columns that were read end.
            const Vec3d offset = i < 4 ? Vec3d(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 1 ? -1.0 : 1.0) : Vec3d(v(0), v(1), v(2));
            EXPECT_NEAR(near.value(centre + offset * reach), field.value(centre + offset * reach), 1e-12);
        }
    }
}

TEST(ColumnsAround, answer_as_the_field_within_their_reach)
{
    const auto stack = testing::random_stack(3, {20, 16}, 1.0, 0.05, 200);
    for (const Border border : {Border::extend, Border::cut})
        for (const double sigma : {0.5, 0.8, 1.5, 3.0}) expect_value_of_field(ConvolutionField(Ground(stack, kGround, border, 16), sigma), 200, 100);
}

TEST(ColumnsAround, pass_on_what_they_do_not_hold)
{
    // A kernel of 48 columns, more than are kept; and columns of 40 runs each, far more than the list holds.
    const auto wide = testing::random_stack(4, {60, 50}, 1.0, 0.05, 200);
    expect_value_of_field(ConvolutionField(Ground(wide, kGround, Border::extend), 24.0), 200, 4);
    auto fine = std::make_shared<MaterialStack>(Vec2i(8, 8), 1.0, 0.02);
    std::vector<Layer> layers;
    for (int k = 0; k < 40; ++k) layers.push_back({Material::air, 4 * k + 2}), layers.push_back({Material::sand, 4 * k + 4});
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) fine->set_column(i, j, layers);
    expect_value_of_field(ConvolutionField(Ground(fine, kGround, Border::extend), 2.0), 160, 50);
}

TEST(ColumnsAround, name_every_material_that_a_point_can_see)
{
    const auto stack = testing::random_stack(5, {20, 16}, 1.0, 0.05, 200);
    const Ground ground(stack, kGround, Border::extend);
    const ConvolutionField field(ground, 1.0);
    int seen = 0;
    for (int k = 0; k < 500; ++k) {
        const auto u = [&](int axis) { return unit_real(hash_cell(11, k, axis)); };
        const Vec3d p(u(0) * 20.0, u(1) * 16.0, u(2) * 10.0);
        const MaterialSet named = ColumnsAround(field, p, 0.2).materials();
        const auto areas = visible_areas(ground, kGround, 1.0, p);
        for (std::size_t m = 0; m < kMaterialCount; ++m) {
            if (!(areas[m] > 0.0)) continue;
            EXPECT_TRUE((named >> m) & 1u);
            ++seen;
        }
    }
    EXPECT_GT(seen, 500);
}

TEST(OnlyVisible, names_the_material_whose_area_is_all_of_it)
{
    testing::TerrainRecipe recipe;
    recipe.size = Vec2i(48, 40);
    recipe.relief = 40.0;
    const Ground ground(testing::make_terrain(recipe), kGround, Border::extend);
    int alone = 0, mixed = 0;
    for (int k = 0; k < 4000; ++k) {
        const auto u = [&](int axis) { return unit_real(hash_cell(8, k, axis)); };
        const Vec3d p(u(0) * 48.0, u(1) * 40.0, u(2) * 40.0);
        const auto areas = visible_areas(ground, kGround, 1.0, p);
        const auto only = only_visible(ground, kGround, 1.0, p);
        const int kinds = static_cast<int>(std::count_if(areas.begin(), areas.end(), [](double a) { return a > 0.0; }));
        if (only) {
            EXPECT_LE(kinds, 1);
            EXPECT_TRUE(kinds == 0 || areas[static_cast<std::size_t>(*only)] > 0.0);
            alone += kinds == 1;
        }
        mixed += kinds == 2;
        EXPECT_FALSE(kinds == 2 && only);
    }
    EXPECT_GT(alone, 100);  // both cases occur, so the test can fail
    EXPECT_GT(mixed, 20);
}

}  // namespace
}  // namespace hoodoo
