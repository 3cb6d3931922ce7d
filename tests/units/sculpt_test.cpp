// The point primitive against independent values, and what a stroke may change.
#include "terrain/edit/sculpt.h"

#include "terrain/edit/brush.h"
#include "terrain/edit/tools.h"
#include "terrain/error.h"
#include "terrain/stack/convolution.h"
#include "tests/counts.h"
#include "tests/edits.h"
#include "tests/stacks.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using Column = std::vector<Layer>;
using testing::edit;
using testing::error_of;
using testing::table;

std::shared_ptr<MaterialStack> flat(int n, double cell, double unit, std::int32_t top, Vec3d origin = Vec3d(0.0))
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(n, n), cell, unit, origin);
    stack->set_columns({0, 0}, {n, n}, std::vector<Column>(static_cast<std::size_t>(n * n), {{Material::bedrock, top}}));
    return stack;
}

Ground bedrock(std::shared_ptr<const MaterialStack> stack)
{
    return Ground(std::move(stack), material_set({Material::bedrock}), Border::extend);
}

TEST(AxisProfile, has_the_golden_column_roots)
{
    // In the golden file's sign solid is positive; a root is a root. Heights there are multiples of 0.01, our unit: exact.
    const auto stack = testing::golden_stack();
    const nlohmann::json golden = testing::golden_arches();
    for (const auto& entry : golden["column_roots"]) {
        const AxisProfile f(bedrock(stack), entry["sigma"], entry["column"][0].get<int>() + 0.5, entry["column"][1].get<int>() + 0.5);
        const std::vector<double> roots = f.roots();
        ASSERT_EQ(roots.size(), entry["roots"].size());
        for (std::size_t k = 0; k < roots.size(); ++k) {
            EXPECT_NEAR(roots[k] * 0.01, entry["roots"][k][0].get<double>(), 1e-12);
            EXPECT_EQ(f.at(roots[k] - 1e-4) < 0.0, entry["roots"][k][1] == "solid->air");
        }
    }
}

TEST(AxisProfile, equals_the_field_everywhere)
{
    const auto stack = testing::random_stack(7, {9, 8}, 0.5, 0.02, 120, Vec3d(10, -20, 5));
    for (const double sigma : {0.3, 0.5, 0.8}) {
        const ConvolutionField field(bedrock(stack), sigma);
        for (std::uint64_t k = 0; k < 400; ++k) {
            const double x = 9 * unit_real(mix64(3 * k)), y = 8 * unit_real(mix64(3 * k + 1)), z = 500 * unit_real(mix64(3 * k + 2)) - 60;
            const AxisProfile f(bedrock(stack), sigma, x, y);
            EXPECT_NEAR(f.at(z), field.value(stack->origin() + Vec3d(0.5 * x, 0.5 * y, 0.02 * z)), 1e-11);
        }
    }
}

TEST(Brush, has_the_golden_roots_on_flat_ground)
{
    // Ground at z = 0 of the golden file is height 50 here; the point lies delta below to add and above to carve.
    const nlohmann::json golden = testing::golden_arches();
    ASSERT_EQ(golden["sculpt_flat_axis"].size(), 4u);
    for (const auto& entry : golden["sculpt_flat_axis"]) {
        const double sigma = entry["sigma"], radius = entry["R"], delta = entry["delta"];
        const AxisProfile f(bedrock(flat(3, 4.0, 0.01, 5000)), sigma, 1.5, 1.5);
        for (const bool adds : {true, false}) {
            const Brush brush{5000 + (adds ? -delta : delta) * 100, radius * 100, 0.0, adds};
            const std::vector<double> roots = brushed_roots(f, brush);
            ASSERT_EQ(roots.size(), 1u);
            EXPECT_NEAR(roots[0] * 0.01 - 50.0, entry[adds ? "add" : "carve"][0][0].get<double>(), 1e-12);
        }
    }
}

/// Changes of side of f~, by dense sampling and halving: slow, and blind to pairs closer than a step.
std::vector<double> scanned(const AxisProfile& f, const Brush& brush, double from, double to, int steps)
{
    std::vector<double> roots;
    const auto g = [&](double z) { return f.at(z) + (brush.adds ? -1.0 : 1.0) * brush.potential(z); };
    for (int k = 0; k < steps; ++k) {
        double a = from + (to - from) * k / steps, b = from + (to - from) * (k + 1) / steps;
        if ((g(a) < 0.0) == (g(b) < 0.0)) continue;
        for (int n = 0; n < 60; ++n) ((g(0.5 * (a + b)) < 0.0) == (g(a) < 0.0) ? a : b) = 0.5 * (a + b);
        roots.push_back(a);
    }
    return roots;
}

TEST(Brush, finds_every_root_that_a_dense_scan_finds)
{
    const auto stack = testing::random_stack(3, {8, 8}, 1.0, 0.05, 60);
    std::size_t found = 0;
    for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(testing::count(300, 5000)); ++k) {
        const auto random = [&](int n) { return unit_real(mix64(8 * k + static_cast<std::uint64_t>(n))); };
        const AxisProfile f(bedrock(stack), 0.5 + random(0), 2 + 4 * random(1), 2 + 4 * random(2));
        const Brush brush{120 * random(3), 5 + 50 * random(4), 30 * random(5), random(6) < 0.5};
        const double h = brush.radius * brush.radius - brush.distance * brush.distance;
        if (!(h > 0.0)) {
            EXPECT_TRUE(brushed_roots(f, brush).empty());
            continue;
        }
        const std::vector<double> all = brushed_roots(f, brush),
                                  some = scanned(f, brush, brush.centre - std::sqrt(h), brush.centre + std::sqrt(h), 4000);
        EXPECT_GE(all.size(), some.size());
        EXPECT_EQ((all.size() - some.size()) % 2, 0u);
        for (const double root : some) {
            double nearest = kInfinity;
            for (const double r : all) nearest = std::min(nearest, std::abs(r - root));
            EXPECT_LT(nearest, 1e-8);
            ++found;
        }
    }
    EXPECT_GT(found, 90u);
}

TEST(Sculpt, raises_flat_ground_by_the_golden_height)
{
    // sigma 1, R 2, delta 1: the axis of the ball rises by 0.319168 m. Cells of 0.25 m so that the ground looks flat to the kernel and one column's
    // axis lies at the ball's own: 0.319 m in units of a millimetre.
    for (const bool adds : {true, false}) {
        const auto stack = flat(41, 0.25, 0.001, 4000);
        const Vec3d vertex(20.5 * 0.25, 20.5 * 0.25, 4.0);
        const ColumnSet changed = sculpt(*stack, 1.0, {vertex, Vec3d(0, 0, 1), 2.0, 1.0, adds});
        EXPECT_EQ(stack->column(20, 20), (Column{{Material::bedrock, adds ? 4319 : 3681}}));
        EXPECT_FALSE(changed.empty());
        for (int j = 0; j < 41; ++j) {
            for (int i = 0; i < 41; ++i) {
                const bool touched = stack->column(i, j) != Column{{Material::bedrock, 4000}};
                EXPECT_EQ(touched, changed.contains(i, j));
                // The surface at height 4 lies under the ball where rho^2 < R^2 - delta^2 = 3.
                const double rho2 = ((i - 20) * (i - 20) + (j - 20) * (j - 20)) * 0.0625;
                if (rho2 > 3.0) {
                    EXPECT_FALSE(touched);
                }
                if (rho2 < 2.4) {
                    EXPECT_TRUE(touched);
                }
            }
        }
    }
}

/// A step two cells high: bedrock to 3 m for x < 10, to 1 m beyond. On the axis of its rim the field's surface lies at 8/3 m, on that of its foot at
/// 4/3.
MaterialStack step()
{
    MaterialStack stack({20, 20}, 1.0, 0.001);
    for (int j = 0; j < 20; ++j)
        for (int i = 0; i < 20; ++i) stack.set_column(i, j, Column{{Material::bedrock, i < 10 ? 3000 : 1000}});
    return stack;
}

TEST(Sculpt, leaves_the_rim_of_a_step_alone_that_it_does_not_move)
{
    // Thresholding the whole field again would lower the rim from 3.000 to 2.667 m. The ball reaches 6 m from (15.6, 10.5): beside the rim at 9.5.
    const MaterialStack before = step();
    MaterialStack stack = before;
    const ColumnSet changed = sculpt(stack, 1.0, {Vec3d(15.6, 10.5, 1.0), Vec3d(0, 0, 1), 6.0, 3.0, false});
    EXPECT_TRUE(changed.contains(14, 10));
    for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 20; ++i) {
            if (i < 10) {
                EXPECT_EQ(stack.column(i, j), (Column{{Material::bedrock, 3000}}));
            }
            if (!changed.contains(i, j)) {
                EXPECT_EQ(stack.column(i, j), before.column(i, j));
            }
        }
    }
    // A ball that hardly touches the rim moves it hardly: at (9.5, 10.5, 2.667) its potential is below (1 - 5.8^2/6^2)^2 = 0.0043, which moves a
    // surface of slope 3/4 per metre by less than 6 mm. Not by the 333 mm between the field's surface and the layer's bound.
    stack = step();
    sculpt(stack, 1.0, {Vec3d(15.3, 10.5, 2.667), Vec3d(0, 0, 1), 6.0, 0.0, false});
    EXPECT_EQ(stack.column(9, 10).size(), 1u);
    EXPECT_LE(stack.column(9, 10)[0].top, 3000);
    EXPECT_GE(stack.column(9, 10)[0].top, 2994);
}

TEST(Sculpt, leaves_no_sliver_between_the_fields_surface_and_the_layers_bound)
{
    // Carving the rim itself: its bound moves by as much as the field's surface on its axis.
    MaterialStack stack = step();
    const auto shared = std::make_shared<MaterialStack>(stack);
    const Stroke stroke{Vec3d(9.5, 10.5, 2.667), Vec3d(0.5, 0, 0.75).normalized(), 3.0, 1.5, false};
    const Vec3d c = (stroke.vertex + stroke.normal * 1.5) * 1000.0;
    const AxisProfile f(bedrock(shared), 1.0, 9.5, 10.5);
    const std::vector<double> moved = brushed_roots(f, {c.z, 3000, Vec2d(c.x - 9500, c.y - 10500).length(), false});
    ASSERT_EQ(moved.size(), 1u);
    sculpt(stack, 1.0, stroke);
    const Column rim = stack.column(9, 10);
    ASSERT_EQ(rim.size(), 1u);
    EXPECT_NEAR(rim[0].top, 3000 - (8000.0 / 3.0 - moved[0]), 0.6);
    EXPECT_LT(rim[0].top, 2900);
    // Adding in the corner below: nothing is left open under what is added.
    sculpt(stack, 1.0, {Vec3d(10.5, 3.5, 1.333), Vec3d(1, 0, 1).normalized(), 3.0, 1.5, true});
    const Column foot = stack.column(10, 3);
    ASSERT_EQ(foot.size(), 1u);
    EXPECT_GT(foot[0].top, 1100);
}

TEST(Sculpt, turns_air_and_sand_to_bedrock_and_only_bedrock_to_air)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(30, 30), 1.0, 0.01);
    stack->set_columns({0, 0}, {30, 30}, std::vector<Column>(900, {{Material::bedrock, 1000}, {Material::sand, 1010}}));
    MaterialStack carved = *stack;
    sculpt(*stack, 1.0, {Vec3d(15.5, 15.5, 10), Vec3d(0, 0, 1), 4.0, 2.0, true});
    EXPECT_EQ(stack->column(15, 15).size(), 1u);  // 0.32 m of rock where 0.1 m of sand was
    sculpt(carved, 1.0, {Vec3d(15.5, 15.5, 10), Vec3d(0, 0, 1), 4.0, 2.0, false});
    const Column column = carved.column(15, 15);
    ASSERT_EQ(column.size(), 3u);
    EXPECT_EQ(column[0].material, Material::bedrock);
    EXPECT_EQ(column[1], (Layer{Material::air, 1000}));
    EXPECT_EQ(column[2], (Layer{Material::sand, 1010}));
}

TEST(Sculpt, repeated_strokes_on_a_wall_build_an_overhang)
{
    // A cliff 30 m high. Strokes at 18 m pull a nose out of the wall: air below it, rock above, where there was only air.
    auto stack = std::make_shared<MaterialStack>(Vec2i(40, 40), 1.0, 0.01);
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i) stack->set_column(i, j, Column{{Material::bedrock, i < 20 ? 3000 : 400}});
    const ColumnSet changed = edit(*stack, "sculpt", table({{"target", {26.0, 20.0, 18.0}}, {"radius", 5.0}, {"depth", 1.0}, {"strokes", 12.0}}));
    EXPECT_GT(changed.count(), 20u);
    const Column nose = stack->column(21, 20);
    ASSERT_EQ(nose.size(), 3u);
    EXPECT_EQ(nose[0], (Layer{Material::bedrock, 400}));
    EXPECT_EQ(nose[1].material, Material::air);
    EXPECT_NEAR(0.005 * (nose[1].top + nose[2].top), 18.0, 0.6);  // the nose lies around the target's height
}

TEST(Sculpt, scattered_strokes_depend_on_the_edits_name_alone)
{
    const Node entries = table({{"target", {10.0, 10.0, 10.0}}, {"radius", 3.0}, {"strokes", 8.0}, {"scatter", 4.0}});
    const auto one = flat(20, 1.0, 0.01, 800), same = flat(20, 1.0, 0.01, 800), other = flat(20, 1.0, 0.01, 800);
    edit(*one, "sculpt", entries);
    edit(*same, "sculpt", entries);
    edit(*other, "sculpt", entries, 1);
    int different = 0;
    for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 20; ++i) {
            EXPECT_EQ(one->column(i, j), same->column(i, j));
            different += one->column(i, j) != other->column(i, j);
        }
    }
    EXPECT_GT(different, 10);
}

TEST(Sculpt, says_what_cannot_be_and_leaves_the_stack_as_it_was)
{
    const auto stack = flat(8, 1.0, 0.01, 8100);
    const auto message = [&](const Node& entries) { return error_of([&] { edit(*stack, "sculpt", entries); }); };
    EXPECT_EQ(message(table({{"target", {9.0, 4.0, 80.0}}, {"radius", 2.0}})),
              "the tool lies outside the terrain, expected x in [0, 8] m and y in [0, 8] m, got (9, 4) m");
    EXPECT_EQ(message(table({{"target", {4.0, 4.0, 81.0}}, {"radius", -2.0}})),
              "radius is out of range, expected a length such as 350 (metres) or \"350 m\" above 0, got -2");
    EXPECT_EQ(message(table({{"target", {4.0, 4.0, 81.0}}, {"radius", 2.0}, {"depth", 2.5}})),
              "depth of a sculpting tool, expected at most its radius, 2 m, got 2.5 m");
    EXPECT_EQ(message(table({{"radius", 2.0}})), "a sculpting tool, expected either target or targets, got neither");
    EXPECT_EQ(message(table({{"target", {4.0, 4.0, 85.0}}, {"along", {0.0, 0.0, 1.0}}, {"radius", 2.0}})),
              "the tool meets no bedrock, expected a point whose way along `along` meets the surface, got (4, 4, 85) m");
    // 0.319 m a stroke: the third rises over 81.91 m.
    EXPECT_EQ(message(table({{"target", {4.5, 4.5, 81.0}}, {"radius", 2.0}, {"strokes", 7.0}})).substr(0, 64),
              "column (4, 4) would rise over the stack's height range, expected");
    EXPECT_EQ(stack->column(4, 4), (Column{{Material::bedrock, 8100}}));
    EXPECT_EQ(stack->column(3, 4), (Column{{Material::bedrock, 8100}}));
}

TEST(Sculpt, reports_a_problem_at_the_value_that_makes_it)
{
    const auto stack = flat(8, 1.0, 0.01, 8100);
    const auto at = [](Node entries, int line, int column) {
        for (auto& [key, node] : std::get<Node::Table>(entries.value)) {
            if (key == "target" || key == "points") node.where = {"cave.toml", line, column, {}};
        }
        return entries;
    };
    EXPECT_EQ(error_of([&] {
                  edit(*stack, "sculpt", at(table({{"target", {9.0, 4.0, 80.0}}, {"radius", 2.0}}), 12, 10));
              }).substr(0, 50),
              "cave.toml:12:10: the tool lies outside the terrain");
    EXPECT_EQ(error_of([&] {
                  edit(*stack, "sculpt", at(table({{"target", {4.5, 4.5, 81.0}}, {"radius", 2.0}, {"strokes", 7.0}}), 3, 1));
              }).substr(0, 42),
              "cave.toml:3:1: column (4, 4) would rise ov");
    EXPECT_EQ(error_of([&] {
                  edit(*stack, "sweep",
                       at(table({{"points", testing::list({{1.0, 1.0, 5.0}, {7.0, 7.0, 5.0}, {7.0, 1.0, 5.0}, {1.0, 7.0, 5.0}})}, {"radius", {0.5}}}),
                          4, 9));
              }).substr(0, 42),
              "cave.toml:4:9: the skeleton crosses itself");
}

}  // namespace
}  // namespace hoodoo
