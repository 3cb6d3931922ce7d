// Regions against geometry, and depositing: how much, where, and what it says when it cannot.
#include "tests/edits.h"
#include "terrain/edit/region.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using enum Material;
using testing::edit;
using testing::error_of;
using testing::even_stack;
using testing::list;
using testing::masses;
using testing::table;
using testing::top_of;
using Column = std::vector<Layer>;

double volume(const MaterialStack& stack, const Region& region)
{
    double sum = 0.0;
    for (const ColumnSpan& span : column_spans(stack, region)) sum += (span.high - span.low) * stack.cell() * stack.cell();
    return sum;
}

TEST(Region, has_the_volume_of_its_shape)
{
    const MaterialStack stack({120, 120}, 0.25, 0.01, Vec3d(100, 200, 0));
    const Vec3d middle(115, 215, 5);
    const auto near = [](double x) { return 0.012 * x; };  // columns belong by their middles
    const double ball = 4.0 / 3.0 * M_PI * 27;
    EXPECT_NEAR(volume(stack, {.points = {middle}, .radii = {3}}), ball, near(ball));
    // A ball on its way, 8 m, sloping: a capsule. And the capsule that says so itself.
    const Vec3d way(4.8, 0, 6.4);
    const double capsule = ball + M_PI * 9 * 8;
    EXPECT_NEAR(volume(stack, {.points = {middle - way / 2.0, middle + way / 2.0}, .radii = {3}}), capsule, near(capsule));
    EXPECT_NEAR(volume(stack, {.shape = Region::Shape::capsule, .points = {middle}, .radii = {3}, .axis = way}), capsule, near(capsule));
    EXPECT_NEAR(volume(stack, {.shape = Region::Shape::capsule, .points = {middle}, .radii = {3}, .axis = Vec3d(0, 0, 8)}), capsule, near(capsule));
    // A box, turned; and moved along its own x axis by 5 m.
    const Vec3d along(5.0 * std::cos(0.5), 5.0 * std::sin(0.5), 0);
    EXPECT_NEAR(volume(stack, {.shape = Region::Shape::box, .points = {middle}, .half_size = Vec3d(4, 2, 1), .heading = 0.5}), 64, near(64));
    EXPECT_NEAR(
        volume(stack, {.shape = Region::Shape::box, .points = {middle, middle + along}, .radii = {1}, .half_size = Vec3d(4, 2, 1), .heading = 0.5}),
        (13 * 4 * 2), near(104));
    // A cone of balls: frustum between 1 and 3 m over 8 m and its caps, within the tube between the smallest and the largest.
    const double cone = volume(stack, {.points = {middle - Vec3d(4, 0, 0), middle + Vec3d(4, 0, 0)}, .radii = {1, 3}});
    EXPECT_GT(cone, M_PI * 8 * (1 + 3 + 9) / 3.0);
    EXPECT_LT(cone, M_PI * 8 * (1 + 3 + 9) / 3.0 + ball);
}

TEST(Region, crosses_a_column_twice_where_its_line_turns_back)
{
    const MaterialStack stack({40, 40}, 0.5, 0.01);
    const Region hook{.points = {Vec3d(5, 10, 2), Vec3d(15, 10, 2), Vec3d(15, 10, 12), Vec3d(5, 10, 12)}, .radii = {1.5}};
    const std::vector<ColumnSpan> spans = column_spans(stack, hook);
    for (std::size_t k = 1; k < spans.size(); ++k) {
        if (spans[k].column == spans[k - 1].column) {
            EXPECT_GT(spans[k].low, spans[k - 1].high);
        }
    }
    const auto count = std::count_if(spans.begin(), spans.end(), [](const ColumnSpan& s) { return s.column == Vec2i(16, 20); });
    EXPECT_EQ(count, 2);
}

TEST(Region, has_rough_walls_that_stay_within_their_share)
{
    const MaterialStack stack({80, 80}, 0.25, 0.01);
    const Region smooth{.points = {Vec3d(10, 10, 10)}, .radii = {4}};
    Region rough = smooth, most = smooth, least = smooth;
    rough.roughness = 0.2;
    rough.wavelength = 2.0;
    most.radii = {4.8};
    least.radii = {3.2};
    EXPECT_LT(volume(stack, rough), volume(stack, most));
    EXPECT_GT(volume(stack, rough), volume(stack, least));
    EXPECT_NE(volume(stack, rough), volume(stack, smooth));
    const auto inside = [](const std::vector<ColumnSpan>& spans, const Vec2i& c) {
        const auto found = std::find_if(spans.begin(), spans.end(), [&](const ColumnSpan& s) { return s.column == c; });
        return found == spans.end() ? std::pair(0.0, 0.0) : std::pair(found->low, found->high);
    };
    const auto a = column_spans(stack, rough), b = column_spans(stack, most);
    for (const ColumnSpan& span : a) {
        EXPECT_GE(span.low, inside(b, span.column).first - 1e-9);
        EXPECT_LE(span.high, inside(b, span.column).second + 1e-9);
    }
}

TEST(Deposit, strews_its_distribution_over_the_ground)
{
    // Ground at 10 m, a ball of 8 m above it, 2 m in the middle; w = (1 - d^2)^2, d the distance from the middle over 8 m. Volume: A pi R^2 / 3.
    MaterialStack stack = even_stack({64, 64}, 0.5, 0.001, {{bedrock, 1000}});
    const ColumnSet changed = edit(stack, "deposit",
                                   table({{"points", list({{16.0, 16.0, 6.0}})},
                                          {"radius", list({8.0})},
                                          {"amount", 2.0},
                                          {"material", "soil"},
                                          {"stabilise", testing::flag(false)}}));
    const double d2 = (0.25 * 0.25 * 2) / 64;
    EXPECT_EQ(stack.column(32, 32), (Column{{bedrock, 1000}, {soil, 1000 + static_cast<std::int32_t>(std::lround(2000 * (1 - d2) * (1 - d2)))}}));
    EXPECT_EQ(stack.column(2, 2), (Column{{bedrock, 1000}}));
    EXPECT_NEAR(masses(stack)[static_cast<std::size_t>(soil)] * 0.001 * 0.25, 2 * M_PI * 64 / 3, 0.5);
    // Under half a unit nothing is left: 2000 w < 1/2 where d^2 > 0.984.
    EXPECT_NEAR(static_cast<double>(changed.count()), 0.984 * M_PI * 64 / 0.25, 8);
}

TEST(Deposit, lays_sand_on_the_floor_of_a_cave_and_not_on_the_hill_above)
{
    MaterialStack stack = even_stack({20, 20}, 1.0, 0.01, {{bedrock, 500}, {air, 1000}, {bedrock, 1500}});
    edit(stack, "deposit", table({{"points", list({{10.0, 10.0, 8.0}})}, {"radius", list({2.5})}, {"amount", 0.5}, {"distribution", "even"}}));
    EXPECT_EQ(stack.column(10, 10), (Column{{bedrock, 500}, {sand, 550}, {air, 1000}, {bedrock, 1500}}));
    // A box that reaches from 8 m to 18 m: 2 m of air below the roof and 3 m above it share the amount.
    edit(stack, "deposit",
         table({{"points", list({{3.5, 3.5, 13.0}})},
                {"region", "box"},
                {"half_size", {0.6, 0.6, 5.0}},
                {"amount", 1.0},
                {"distribution", "even"},
                {"stabilise", testing::flag(false)}}));
    EXPECT_EQ(stack.column(3, 3), (Column{{bedrock, 500}, {sand, 540}, {air, 1000}, {bedrock, 1500}, {sand, 1560}}));
    // Too much for the room: the cave fills up and no more.
    edit(stack, "deposit",
         table({{"points", list({{15.5, 15.5, 8.0}})},
                {"radius", list({0.6})},
                {"amount", 50.0},
                {"distribution", "even"},
                {"stabilise", testing::flag(false)}}));
    EXPECT_EQ(stack.column(15, 15), (Column{{bedrock, 500}, {sand, 1000}, {bedrock, 1500}}));
}

TEST(Deposit, comes_to_rest_by_itself)
{
    MaterialStack stack = even_stack({60, 60}, 1.0, 0.01, {{bedrock, 100}});
    const ColumnSet changed = edit(stack, "deposit", table({{"points", list({{30.0, 30.0, 4.0}})}, {"radius", list({6.0})}, {"amount", 20.0}}));
    const std::int64_t units = masses(stack)[static_cast<std::size_t>(sand)];
    EXPECT_NEAR(static_cast<double>(units) * 0.01, 20 * M_PI * 36 / 3, 10);
    for (int i = 0; i < 59; ++i) EXPECT_LE(std::abs(top_of(stack, i, 30) - top_of(stack, i + 1, 30)), 65);  // tan(33 deg) = 0.6494
    EXPECT_NEAR(static_cast<double>(changed.count()), 330, 30);  // a cone of 754 m3 at 33 degrees: radius 10.3 m; it was strewn over 113 columns
    for (int i = 0; i < 60; ++i) {
        for (int j = 0; j < 60; ++j) EXPECT_EQ(changed.contains(i, j), top_of(stack, i, j) != 100);
    }
}

TEST(Deposit, leaves_bare_places_where_it_is_patchy_and_does_so_by_its_name)
{
    const auto make = [](const char* name) {
        MaterialStack stack = even_stack({60, 60}, 1.0, 0.001, {{bedrock, 100}});
        edit(stack, "deposit",
             table({{"points", list({{30.0, 30.0, 4.0}})},
                    {"radius", list({25.0})},
                    {"amount", 1.0},
                    {"distribution", "even"},
                    {"patchiness", 1.0},
                    {"patch_size", 6.0},
                    {"name", name}}));
        return stack;
    };
    const MaterialStack a = make("a"), again = make("a"), b = make("b");
    EXPECT_TRUE(testing::same(a, again));
    EXPECT_FALSE(testing::same(a, b));
    const double mean = static_cast<double>(masses(a)[static_cast<std::size_t>(sand)]) * 0.001 / (M_PI * 625);
    EXPECT_NEAR(mean, 0.5, 0.1);
}

TEST(Deposit, says_what_is_wrong)
{
    MaterialStack stack = even_stack({20, 20}, 1.0, 0.01, {{bedrock, 8000}});
    const MaterialStack before = stack;
    EXPECT_EQ(error_of([&] {
                  edit(stack, "deposit", table({{"points", list({{90.0, 10.0, 8.0}})}, {"radius", list({2.0})}, {"amount", 0.5}}));
              }),
              "the tool lies outside the terrain, expected x in [0, 20] m and y in [0, 20] m");
    EXPECT_EQ(error_of([&] {
                  edit(stack, "deposit", table({{"points", list({{9.5, 10.5, 84.0}})}, {"radius", list({0.6})}, {"amount", 2.0}}));
              }),
              "the deposit rises over what the stack can hold, expected at most 1.91 m at column (9, 10), got 2 m");
    EXPECT_EQ(error_of([&] {
                  edit(stack, "deposit", table({{"points", list({{9.5, 10.5, 84.0}})}, {"radius", list({-1.0})}, {"amount", 2.0}}));
              }),
              "radius is out of range, expected a list of 1 to 100000 lengths above 0, got -1");
    EXPECT_EQ(error_of([&] {
                  edit(stack, "deposit", table({{"points", list({{9.5, 10.5, 84.0}})}, {"region", "box"}, {"radius", list({1.0})}, {"amount", 2.0}}));
              }),
              "a region of shape \"box\", expected no `radius`");
    EXPECT_EQ(error_of([&] {
                  edit(stack, "deposit", table({{"points", list({{9.5, 10.5, 84.0}})}, {"radius", {1.0, 2.0, 3.0}}, {"amount", 2.0}}));
              }),
              "radii of a region, expected one, or one for each of the 1 points, got 3");
    EXPECT_TRUE(testing::same(stack, before));
}

}  // namespace
}  // namespace hoodoo
