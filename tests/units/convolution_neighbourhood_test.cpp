// One walk over the columns against the plain functions, which are tested against golden values.

#include "terrain/math/hash.h"
#include "terrain/stack/convolution.h"
#include "terrain/stack/visible.h"
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
