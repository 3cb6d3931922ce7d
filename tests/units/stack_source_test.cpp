// Stacks from tables: what each measure and shape does to the columns, where images lie on the map, and how sand settles.
#include "terrain/surfaces/stack_source.h"

#include "terrain/fields/height_shapes.h"
#include "terrain/fields/strata.h"
#include "terrain/io/height_image.h"
#include "terrain/surfaces/drift.h"
#include "tests/tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace hoodoo
{
namespace
{

using testing::table;
using testing::tables;
using Column = std::vector<Layer>;

std::shared_ptr<MaterialStack> make(const Node& parameters, std::uint64_t seed = 1)
{
    const Schema schema{"stack", "", stack_parameters()};
    std::vector<Problem> problems;
    const Values values = check(schema, parameters, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.seed = seed;
    return make_stack(values, context);
}

TEST(StackSource, tops_thicknesses_and_cuts_follow_one_another)
{
    using enum Material;
    const auto stack =
        make(table({{"columns", {3.0, 2.0}},
                    {"cell", 1.0},
                    {"unit", 0.1},
                    {"datum", -1.0},
                    {"origin", {10.0, 20.0, 5.0}},
                    {"layer", tables({table({{"shape", "flat"}, {"top", 4.0}}), table({{"shape", "flat"}, {"material", "soil"}, {"thickness", 2.0}}),
                                      table({{"shape", "flat"}, {"material", "rock"}, {"top", 5.0}}),
                                      table({{"shape", "flat"}, {"material", "sand"}, {"top", 6.5}})})}}));
    // Heights above the datum of -1 m in steps of 0.1 m: bedrock 4 m -> 50, soil to 6 m -> 70, rock to 5 m lies below that: none, sand to 6.5 m
    // -> 75.
    EXPECT_EQ(stack->column(2, 1), (Column{{bedrock, 50}, {soil, 70}, {sand, 75}}));
    EXPECT_EQ(stack->origin(), Vec3d(10, 20, 4));
    const Node canyon = table({{"shape", "canyon"},
                               {"measure", "cut"},
                               {"points", testing::list({{-5.0, 8.0, 2.0}, {40.0, 8.0, 2.0}})},
                               {"rim", 12.0},
                               {"floor_width", 4.0},
                               {"width", 10.0},
                               {"roughness", 0.0}});
    const auto cut = make(table({{"columns", {16.0, 16.0}},
                                 {"cell", 1.0},
                                 {"unit", 0.01},
                                 {"layer", tables({table({{"shape", "flat"}, {"top", 9.0}}),
                                                   table({{"shape", "flat"}, {"material", "soil"}, {"thickness", 1.0}}), canyon})}}));
    EXPECT_EQ(cut->column(8, 8), (Column{{bedrock, 200}}));                // the floor, 0.5 m off the line
    EXPECT_EQ(cut->column(8, 1), (Column{{bedrock, 900}, {soil, 1000}}));  // beyond the rim, 6.5 m off
    const Column flank = cut->column(8, 4);                                // 3.5 m off: halfway up
    EXPECT_GT(flank.back().top, 200);
    EXPECT_LT(flank.back().top, 1000);
}

TEST(StackSource, images_lie_with_their_first_row_in_the_north_and_say_their_cell)
{
    const std::string path = (std::filesystem::temp_directory_path() / "hoodoo_stack_source.exr").string();
    write_height_image(path, {3, 2, 30.0, {1, 2, 3, 4, 5, 6}});
    const auto stack =
        make(table({{"unit", 0.5}, {"layer", tables({table({{"shape", "image"}, {"file", path}, {"scale", 2.0}, {"offset", 1.0}})})}}));
    std::filesystem::remove(path);
    EXPECT_EQ(stack->size(), Vec2i(3, 2));
    EXPECT_EQ(stack->cell(), 30.0);
    EXPECT_EQ(stack->column(0, 1)[0].top, 6);   // north-west: 1 * 2 + 1 = 3 m
    EXPECT_EQ(stack->column(2, 0)[0].top, 26);  // south-east: 6 * 2 + 1 = 13 m
}

TEST(StackSource, noise_depends_on_seeds_and_names_and_on_nothing_else)
{
    const auto hills = [](const char* name, double extra) {
        return table(
            {{"columns", {20.0, 20.0}},
             {"cell", 1.0},
             {"unit", 0.01},
             {"layer",
              tables({table({{"shape", "flat"}, {"top", extra}}),
                      table({{"shape", "fractal"}, {"name", name}, {"height", 20.0}, {"relief", 8.0}, {"wavelength", 11.0}, {"kind", "ridged"}})})}});
    };
    const auto tops = [](const MaterialStack& stack) {
        std::vector<std::int32_t> all;
        for (int k = 0; k < 400; ++k) all.push_back(stack.column(k % 20, k / 20).back().top);
        return all;
    };
    const auto a = tops(*make(hills("a", 1.0)));
    EXPECT_EQ(a, tops(*make(hills("a", 2.0))));
    EXPECT_NE(a, tops(*make(hills("b", 1.0))));
    EXPECT_NE(a, tops(*make(hills("a", 1.0), 2)));
    for (const std::int32_t top : a) EXPECT_TRUE(top >= 1200 && top <= 2800) << top;  // height +- relief
}

TEST(Strata, keep_the_order_and_the_ends_and_change_the_slope)
{
    const Strata strata(10, 60, 5, 0.8, 3), none(10, 60, 5, 0.0, 3);
    EXPECT_EQ(strata(9.0), 9.0);
    EXPECT_EQ(strata(61.0), 61.0);
    EXPECT_NEAR(strata(10.0 + 1e-9), 10.0, 1e-6);
    EXPECT_NEAR(strata(60.0 - 1e-9), 60.0, 1e-6);
    double steepest = 0.0, flattest = kInfinity;
    for (double h = 10.0; h < 59.9; h += 0.05) {
        const double slope = (strata(h + 0.05) - strata(h)) / 0.05;
        steepest = std::max(steepest, slope);
        flattest = std::min(flattest, slope);
        EXPECT_GT(slope, 0.0);
        EXPECT_NEAR(none(h), h, 1e-9);
    }
    // Hard beds spend at most 1 - 0.8 * 0.6 of their thickness, soft ones at least 1 + 0.8 * 0.6, both scaled by the same factor.
    EXPECT_GT(steepest / flattest, 1.48 / 0.52);
}

TEST(Drift, lies_where_it_is_flat_and_fills_what_is_low)
{
    // A plain, a step of 45 degrees between i = 20 and 30, a plain; and one pit of 2 m in the lower one.
    const Vec2i size(50, 41);
    std::vector<double> ground;
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) ground.push_back(std::clamp(i - 20.0, 0.0, 10.0) - (i == 8 && j == 20 ? 2.0 : 0.0));
    }
    const auto at = [&](const std::vector<double>& t, int i, int j) { return t[static_cast<std::size_t>(j * size.x + i)]; };
    const std::vector<double> t = drift_thickness(ground, size, 1.0, {0.5, 0.2, 0.6, 0.5, 3.0});
    EXPECT_NEAR(at(t, 40, 10), 0.5, 1e-9);
    EXPECT_EQ(at(t, 25, 10), 0.0);
    // The pit lies 2 * (1 - 1/49) m below the mean of its 7 x 7 square; its own slope, by central differences, is nothing.
    EXPECT_NEAR(at(t, 8, 20), 0.5 + 0.5 * 2.0 * 48 / 49, 1e-9);
}

}  // namespace
}  // namespace hoodoo
