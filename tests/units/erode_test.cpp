// Erosion: what turns into what, where it goes, and that nothing is lost. Filling: what is connected fills, and nothing else.
#include "tests/edits.h"
#include "tests/stacks.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using enum Material;
using testing::edit;
using testing::error_of;
using testing::even_stack;
using testing::flag;
using testing::list;
using testing::masses;
using testing::table;
using Column = std::vector<Layer>;

std::int64_t solid(const MaterialStack& stack)
{
    const auto m = masses(stack);
    return m[static_cast<std::size_t>(sand)] + m[static_cast<std::size_t>(bedrock)] + m[static_cast<std::size_t>(rock)];
}

TEST(Erode, turns_the_surface_into_sand_at_tops_and_undersides)
{
    // A slab from 3 to 6 m over ground at 1 m. The region reaches from 0.5 to 9.5 m: all three faces lie in it.
    MaterialStack stack = even_stack({9, 9}, 1.0, 0.01, {{bedrock, 100}, {air, 300}, {bedrock, 600}});
    edit(stack, "erode",
         table({{"points", list({{4.5, 4.5, 5.0}})},
                {"region", "box"},
                {"half_size", {0.6, 0.6, 4.5}},
                {"strategy", "surface"},
                {"depth", 0.2},
                {"stabilise", flag(false)}}));
    EXPECT_EQ(stack.column(4, 4), (Column{{bedrock, 80}, {sand, 100}, {air, 300}, {sand, 320}, {bedrock, 580}, {sand, 600}}));
    EXPECT_EQ(stack.column(3, 4), (Column{{bedrock, 100}, {air, 300}, {bedrock, 600}}));
    // A region that ends inside the rock takes no more than it holds, and no surface that lies outside.
    MaterialStack deep = even_stack({9, 9}, 1.0, 0.01, {{bedrock, 100}, {air, 300}, {bedrock, 600}});
    edit(deep, "erode",
         table({{"points", list({{4.5, 4.5, 6.0}})},
                {"region", "box"},
                {"half_size", {0.6, 0.6, 0.1}},
                {"strategy", "surface"},
                {"depth", 0.5},
                {"stabilise", flag(false)}}));
    EXPECT_EQ(deep.column(4, 4), (Column{{bedrock, 100}, {air, 300}, {bedrock, 590}, {sand, 600}}));
}

TEST(Erode, turns_a_volume_into_rock_and_sand_from_its_exposed_end)
{
    const Column slab = {{bedrock, 100}, {air, 300}, {bedrock, 600}};
    const auto eroded = [&](double z, double half) {
        MaterialStack stack = even_stack({9, 9}, 1.0, 0.01, slab);
        edit(stack, "erode",
             table({{"points", list({{4.5, 4.5, z}})},
                    {"region", "box"},
                    {"half_size", {0.6, 0.6, half}},
                    {"eta", 0.5},
                    {"rho", 0.25},
                    {"stabilise", flag(false)}}));
        return stack.column(4, 4);
    };
    // 5 to 7 m: the top of the slab, 1 m of bedrock, half of it goes, from above; a quarter of that is rock.
    EXPECT_EQ(eroded(6, 1), (Column{{bedrock, 100}, {air, 300}, {bedrock, 550}, {sand, 587}, {rock, 600}}));
    // 2 to 4 m: its underside, from below.
    EXPECT_EQ(eroded(3, 1), (Column{{bedrock, 100}, {air, 300}, {sand, 337}, {rock, 350}, {bedrock, 600}}));
    // 4 to 5 m: inside; a niche at the bottom of the piece.
    EXPECT_EQ(eroded(4.5, 0.5), (Column{{bedrock, 100}, {air, 300}, {bedrock, 400}, {sand, 437}, {rock, 450}, {bedrock, 600}}));
    // Settled, what breaks from an underside lies on the floor below.
    MaterialStack stack = even_stack({9, 9}, 1.0, 0.01, slab);
    edit(stack, "erode",
         table({{"points", list({{4.5, 4.5, 3.0}})}, {"region", "box"}, {"half_size", {0.6, 0.6, 1.0}}, {"eta", 0.5}, {"rho", 0.25}}));
    EXPECT_EQ(stack.column(4, 4), (Column{{bedrock, 100}, {sand, 137}, {rock, 150}, {air, 350}, {bedrock, 600}}));
}

TEST(Erode, lets_a_cliff_crumble_into_scree_and_loses_nothing)
{
    MaterialStack stack({48, 32}, 1.0, 0.01);
    for (int j = 0; j < 32; ++j) {
        for (int i = 0; i < 48; ++i) stack.set_column(i, j, Column{{bedrock, i < 20 ? 2500 : 300}});
    }
    const std::int64_t before = solid(stack);
    for (int n = 0; n < 4; ++n) {
        edit(stack, "erode",
             table({{"points", list({{20.0, 6.0, 14.0 + n}, {20.0, 26.0, 16.0}})}, {"radius", list({4.0})}, {"eta", 0.6}, {"roughness", 0.3}}),
             static_cast<std::size_t>(n));
        EXPECT_EQ(solid(stack), before);
    }
    // Scree at the foot, highest at the wall; a hollow above it, and a roof over that.
    EXPECT_GT(testing::top_of(stack, 21, 16), 500);
    EXPECT_GT(testing::top_of(stack, 21, 16), testing::top_of(stack, 30, 16));
    bool roof = false;
    for (int i = 14; i < 20; ++i) roof = roof || (stack.column(i, 16).size() > 2 && stack.column(i, 16).back() == Layer{bedrock, 2500});
    EXPECT_TRUE(roof);
}

TEST(Erode, follows_the_ground_when_it_is_draped)
{
    MaterialStack stack({40, 8}, 1.0, 0.01);
    for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 40; ++i) stack.set_column(i, j, Column{{bedrock, 500 + 30 * i}});
    }
    edit(stack, "erode",
         table({{"points", list({{2.5, 4.5, 0.0}, {37.5, 4.5, 0.0}})},
                {"radius", list({1.2})},
                {"drape", flag(true)},
                {"strategy", "surface"},
                {"depth", 0.1},
                {"stabilise", flag(false)}}));
    for (int i = 3; i < 37; ++i) EXPECT_EQ(stack.column(i, 4), (Column{{bedrock, 490 + 30 * i}, {sand, 500 + 30 * i}}));
}

TEST(Erode, says_what_is_wrong)
{
    MaterialStack stack = even_stack({20, 20}, 1.0, 0.01, {{bedrock, 800}});
    const auto error = [&](const Node& entries) { return error_of([&] { edit(stack, "erode", entries); }); };
    EXPECT_EQ(error(table({{"points", list({{-5.0, 10.0, 8.0}})}, {"radius", list({2.0})}})),
              "the tool lies outside the terrain, expected x in [0, 20] m and y in [0, 20] m");
    EXPECT_EQ(error(table({{"points", list({{5.0, 10.0, 8.0}})}, {"radius", list({2.0})}, {"depth", 1.0}})),
              "erosion of a volume, expected no `depth`, but `eta`");
    EXPECT_EQ(error(table({{"points", list({{5.0, 10.0, 8.0}})}, {"radius", list({2.0})}, {"strategy", "surface"}})),
              "erosion of the surface, expected the `depth` of the layer");
    EXPECT_EQ(error(table({{"points", list({{5.0, 10.0, 8.0}})}, {"radius", list({2.0})}, {"strategy", "surface"}, {"depth", 1.0}, {"rho", 0.3}})),
              "erosion of the surface, expected no `rho`: all of it becomes sand");
    EXPECT_EQ(error(table({{"points", list({{5.0, 10.0, 8.0}})}, {"region", "capsule"}, {"radius", list({2.0})}})),
              "a region of shape \"capsule\", expected its `axis`");
}

TEST(Fill, fills_what_is_connected_below_the_level_and_nothing_else)
{
    // A basin (columns 2..6) beside another (8..10) behind a wall at 7 that is pierced by a tunnel from 2 to 3 m; a third (12..14) behind a whole
    // wall.
    MaterialStack stack({16, 3}, 1.0, 0.01);
    const Column wall = {{bedrock, 1000}}, basin = {{bedrock, 200}}, tunnel = {{bedrock, 200}, {air, 300}, {bedrock, 1000}};
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 16; ++i) {
            const bool open = j == 1 && ((i >= 2 && i <= 6) || (i >= 8 && i <= 10) || (i >= 12 && i <= 14));
            stack.set_column(i, j, j == 1 && i == 7 ? tunnel : open ? basin : wall);
        }
    }
    stack.set_column(4, 1, Column{{bedrock, 200}, {sand, 260}, {water, 280}});
    stack.set_column(5, 1, Column{{bedrock, 600}});  // an island
    const ColumnSet changed = edit(stack, "fill", table({{"seed", {3.5, 1.5, 9.0}}, {"level", 5.0}}));
    EXPECT_EQ(stack.column(2, 1), (Column{{bedrock, 200}, {water, 500}}));
    EXPECT_EQ(stack.column(4, 1), (Column{{bedrock, 200}, {sand, 260}, {water, 500}}));
    EXPECT_EQ(stack.column(5, 1), (Column{{bedrock, 600}}));
    EXPECT_EQ(stack.column(6, 1), basin);  // behind the island
    EXPECT_EQ(stack.column(8, 1), basin);
    EXPECT_EQ(changed.count(), 3u);
    edit(stack, "fill", table({{"seed", {8.5, 1.5, 4.0}}}));
    EXPECT_EQ(stack.column(6, 1), (Column{{bedrock, 200}, {water, 400}}));  // through the tunnel
    EXPECT_EQ(stack.column(7, 1), (Column{{bedrock, 200}, {water, 300}, {bedrock, 1000}}));
    EXPECT_EQ(stack.column(12, 1), basin);
    const auto words = std::vector<std::uint16_t>(stack.words(2, 1).begin(), stack.words(2, 1).end());
    EXPECT_TRUE(edit(stack, "fill", table({{"seed", {2.5, 1.5, 6.0}}, {"level", 4.0}})).empty());  // less than there is: it stays
    EXPECT_TRUE(std::ranges::equal(stack.words(2, 1), words));
}

TEST(Fill, water_that_is_poured_comes_to_rest_level)
{
    // A bowl; water dropped at one side runs to the middle and stands level there to one unit between neighbours.
    MaterialStack stack({40, 40}, 1.0, 0.01);
    for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 40; ++i) {
            const double r = std::hypot(i - 19.5, j - 19.5);
            stack.set_column(i, j, Column{{bedrock, 100 + static_cast<std::int32_t>(std::min(1500.0, 3 * r * r))}});
        }
    }
    edit(stack, "deposit", table({{"points", list({{28.0, 20.0, 9.0}})}, {"radius", list({3.0})}, {"amount", 6.0}, {"material", "water"}}));
    std::int32_t low = 9000, high = 0;
    for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 40; ++i) {
            const Column column = stack.column(i, j);
            if (column.back().material != water || column.back().top - column[0].top < 3) continue;
            low = std::min(low, column.back().top);
            high = std::max(high, column.back().top);
        }
    }
    EXPECT_LT(high - low, 14);  // a slope of a unit a cell is all that can be left
    EXPECT_GT(low, 120);
}

TEST(Fill, says_what_is_wrong)
{
    MaterialStack stack = even_stack({20, 20}, 1.0, 0.01, {{bedrock, 800}});
    const auto error = [&](const Node& entries) { return error_of([&] { edit(stack, "fill", entries); }); };
    EXPECT_EQ(error(table({{"seed", {25.0, 3.0, 9.0}}})), "the tool lies outside the terrain, expected x in [0, 20] m and y in [0, 20] m");
    EXPECT_EQ(error(table({{"seed", {5.0, 3.0, 9.0}}, {"level", 7.0}})),
              "no water can stand here, expected a point in the air over ground that is lower than 7 m, got (5, 3, 9)");
    EXPECT_EQ(error(table({{"seed", {5.0, 3.0, 9.0}}, {"level", -7.0}})), "the level of the water, expected above 0 m, up to 81.91 m, got -7 m");
}

}  // namespace
}  // namespace hoodoo
