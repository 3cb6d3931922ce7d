// Cracks as an edit of layers: where, how deep, in what, and not elsewhere.
#include "terrain/fields/crack_network.h"
#include "terrain/math/hash.h"
#include "tests/edits.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// 2 m of bedrock and 1 m of soil, columns of a quarter metre.
MaterialStack mud()
{
    return even_stack({64, 48}, 0.25, 0.01, {{Material::bedrock, 200}, {Material::soil, 300}});
}

TEST(CrackTool, soil_loses_its_share_in_cracks_and_only_there)
{
    MaterialStack stack = mud();
    const ColumnSet changed = edit(stack, "crack", table({{"n", 24.0}, {"kappa", 0.4}, {"lambda", 0.3}}));
    // The network that the edit's name makes: 16 m x 12 m, 24 sites, even.
    const Box2d area(Vec2d(0.0), Vec2d(16.0, 12.0));
    const CrackNetwork network(VoronoiDiagram(crack_sites(hash_name(1, "edit 0"), 24, area, SiteKind::even), crack_box(24, area)),
                               0.3 * std::sqrt(8.0));
    std::size_t torn = 0;
    for (int j = 0; j < 48; ++j) {
        for (int i = 0; i < 64; ++i) {
            const bool in = network.cracked({(i + 0.5) * 0.25, (j + 0.5) * 0.25});
            // 0.4 of 100 units.
            EXPECT_EQ(top_of(stack, i, j), in ? 260 : 300) << i << ", " << j;
            torn += in;
        }
    }
    EXPECT_EQ(changed.count(), torn);
    EXPECT_GT(torn, 600u);
    EXPECT_LT(torn, 2200u);
}

TEST(CrackTool, mud_that_cracked_stands)
{
    MaterialStack stack = mud(), again = mud();
    edit(stack, "crack", table({{"kappa", 1.0}, {"n", 10.0}}));
    edit(again, "crack", table({{"kappa", 1.0}, {"n", 10.0}, {"stabilise", flag(false)}}));
    EXPECT_TRUE(same(stack, again)) << "walls of a metre would have slid";
    // All of the soil, none of the rock.
    EXPECT_EQ(masses(stack)[static_cast<std::size_t>(Material::bedrock)], 200 * 64 * 48);
}

TEST(CrackTool, only_what_is_named_and_lies_on_top_cracks)
{
    MaterialStack stack = mud();
    EXPECT_TRUE(edit(stack, "crack", table({{"materials", list({"sand"})}})).empty());
    MaterialStack wet = even_stack({64, 48}, 0.25, 0.01, {{Material::soil, 100}, {Material::water, 150}});
    EXPECT_TRUE(edit(wet, "crack", table({})).empty()) << "under water nothing dries";
    MaterialStack bare = even_stack({64, 48}, 0.25, 0.01, {{Material::bedrock, 200}});
    EXPECT_TRUE(edit(bare, "crack", table({})).empty()) << "where nothing lies nothing cracks";
}

TEST(CrackTool, cracks_end_at_the_border_and_at_the_region)
{
    MaterialStack stack = mud();
    // The top is at 3 m: half of the border error above the border.
    edit(stack, "crack", table({{"kappa", 0.4}, {"border", 2.5}, {"border_error", 1.0}, {"region_max", {8.0, 12.0}}}));
    std::int32_t lowest = 1000;
    for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 64; ++i) {
            lowest = std::min(lowest, top_of(stack, i, j));
            if (i >= 32) {
                EXPECT_EQ(top_of(stack, i, j), 300);
            }
        }
    EXPECT_EQ(lowest, 280);
    MaterialStack high = mud();
    EXPECT_TRUE(edit(high, "crack", table({{"border", 2.0}, {"border_error", 1.0}})).empty());
}

TEST(CrackTool, errors_name_what_cannot_be)
{
    MaterialStack stack = mud();
    EXPECT_EQ(error_of([&] {
                  edit(stack, "crack", table({{"region_min", {9.0, 1.0}}, {"region_max", {8.0, 2.0}}}));
              }),
              "the region that is cracked is empty, expected region_min below region_max, got [9, 1] to [8, 2]");
    EXPECT_EQ(error_of([&] {
                  edit(stack, "crack", table({{"region_min", {90.0, 1.0}}, {"region_max", {99.0, 2.0}}}));
              }),
              "the region lies outside of the terrain, expected [0, 0] to [16, 12]");
    EXPECT_EQ(error_of([&] { edit(stack, "crack", table({{"materials", list({"lava"})}})); }).substr(0, 9), "materials");
    EXPECT_TRUE(same(stack, mud()));
}

}  // namespace
}  // namespace hoodoo
