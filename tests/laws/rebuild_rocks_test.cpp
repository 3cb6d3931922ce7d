// Rocks that followed edits are, bit for bit, the rocks that one would place anew; and far ones are as good as fine ones.
#include "terrain/math/hash.h"
#include "terrain/rocks/rock_mesh.h"
#include "terrain/rocks/stack_rocks.h"
#include "tests/counts.h"
#include "tests/edits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

namespace hoodoo
{
namespace
{

/// What differs between two lists of rocks; empty: nothing.
std::string difference(const Instances& a, const Instances& b)
{
    if (a.instances.size() != b.instances.size()) return fmt::format("{} rocks against {}", a.instances.size(), b.instances.size());
    if (a.meshes.size() != b.meshes.size()) return "number of meshes";
    for (std::size_t k = 0; k < a.instances.size(); ++k) {
        const Instance &x = a.instances[k], &y = b.instances[k];
        if (std::memcmp(&x.position, &y.position, sizeof x.position) != 0) return fmt::format("place of rock {}", k);
        if (x.mesh != y.mesh || x.id != y.id || x.seed != y.seed || x.scale != y.scale) return fmt::format("mesh or number of rock {}", k);
    }
    for (std::size_t m = 0; m < a.meshes.size(); ++m)
        if (a.meshes[m].vertices != b.meshes[m].vertices || a.meshes[m].triangles != b.meshes[m].triangles) return fmt::format("mesh {}", m);
    return a.rocks.instances == a.instances.size() && b.rocks.instances == b.instances.size() ? "" : "the number that info tells";
}

/// A slope with a step of 4 m, rubble about its foot and in a cave under it.
std::shared_ptr<MaterialStack> cliff_with_rubble(std::int32_t rubble = 70)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(80, 72), 0.5, 1.0 / 64, Vec3d(-7, 20, 2));
    std::vector<std::vector<Layer>> columns;
    for (int j = 0; j < 72; ++j) {
        for (int i = 0; i < 80; ++i) {
            const auto ground = 300 + 2 * j + (i > 50 ? 260 : 0);
            std::vector<Layer> column = {{Material::bedrock, ground}};
            if (i > 20 && i <= 60) column.push_back({Material::rock, ground + rubble});
            if (i > 50) column.insert(column.end(), {{Material::air, ground + 200}, {Material::bedrock, ground + 280}});
            columns.push_back(std::move(column));
        }
    }
    stack->set_columns({0, 0}, stack->size(), columns);
    return stack;
}

/// The k-th of a row of unlike edits: rock is added, taken away, buried, uncovered and knocked loose.
ColumnSet edit_somewhere(MaterialStack& stack, std::uint64_t k)
{
    using testing::table;
    const auto random = [&](std::uint64_t n) { return unit_real(mix64(23 * k + n)); };
    const double x = -6 + 38 * random(1), y = 21 + 34 * random(2), z = 6 + 8 * random(3), r = 0.7 + 2.5 * random(4);
    switch (k % 4) {
        case 0:
            return testing::edit(stack, "sculpt", table({{"target", {x, y, z}}, {"radius", r}, {"strokes", 2.0}, {"mode", "carve"}}), k);
        case 1:
            return testing::edit(stack, "sweep",
                                 table({{"points", testing::list({{x, y, z}})}, {"radius", {r}}, {"mode", "add"}, {"material", "rock"}}), k);
        case 2:
            return testing::edit(stack, "sweep",
                                 table({{"points", testing::list({{x, y, z}})}, {"radius", {r}}, {"mode", "add"}, {"material", "bedrock"}}), k);
        default:
            return testing::edit(stack, "sculpt", table({{"target", {x, y, z}}, {"radius", r}, {"mode", "add"}}), k);
    }
}

RockOptions rubble(bool cubes)
{
    RockOptions options;
    options.size = 0.9;
    options.level = 2;
    options.seed = 11;
    options.corner_cubes = cubes;
    options.view = RockView{Vec3d(-12, 22, 9), 1e-2};  // part of the terrain needs level 2, part 3
    return options;
}

/// The rectangles of columns, each grown by `margin` on all sides.
std::vector<Rectangle> rectangles(const MaterialStack& stack, const ColumnSet& changed, double margin)
{
    std::vector<Rectangle> all;
    const Vec2d origin(stack.origin().x, stack.origin().y);
    for (const std::uint32_t index : changed.indices()) {
        const Vec2d at = origin + Vec2d(changed.column(index).x, changed.column(index).y) * stack.cell();
        all.push_back({at - Vec2d(margin), at + Vec2d(stack.cell() + margin)});
    }
    return all;
}

TEST(RebuildRocks, where_an_edit_touched_is_the_full_placement_bit_for_bit)
{
    for (const bool cubes : {false, true}) {
        const auto stack = cliff_with_rubble();
        const auto volume = std::make_shared<StackRocks>(stack, Border::extend);
        RockPlacement placement(rubble(cubes), volume, stack->origin());
        Instances rocks = placement.place();
        int moved = 0;
        for (int k = 0, edits = cubes ? testing::count(1, 12) : testing::count(12, 200); k < edits; ++k) {
            const ColumnSet changed = edit_somewhere(*stack, static_cast<std::uint64_t>(k));
            volume->follow(changed);
            const InstanceChange change = placement.follow(rectangles(*stack, changed, 0.0), rocks);
            moved += change != InstanceChange::none;
            const Instances fresh = place_rocks(rubble(cubes), StackRocks(stack, Border::extend), stack->origin());
            ASSERT_EQ(difference(rocks, fresh), "") << "edit " << k << (cubes ? ", corner cubes" : "");
        }
        EXPECT_GE(moved, cubes ? 1 : 6);
        EXPECT_GT(rocks.instances.size(), 200u);
        if (!cubes) {
            EXPECT_EQ(rocks.meshes.size(), 100u);  // 50 at each of two levels
        }
    }
}

TEST(RebuildRocks, that_forgets_how_far_rocks_look_is_found_out)
{
    const auto stack = cliff_with_rubble(190);  // 3 m: rocks at the bottom are out of sight
    const auto volume = std::make_shared<StackRocks>(stack, Border::extend);
    RockPlacement placement(rubble(false), volume, stack->origin());
    Instances rocks = placement.place();
    const Instances whole = rocks;
    int found = 0;
    for (int i = 24; i < 44; ++i) {
        // A pit of three columns, right through the rubble: rocks beside it come to light, some of them in the next tile.
        const std::vector<std::vector<Layer>> before = {stack->column(i, 30), stack->column(i + 1, 30), stack->column(i + 2, 30)};
        std::vector<std::vector<Layer>> pit = before;
        for (std::vector<Layer>& column : pit) column.resize(1);
        ColumnSet changed(stack->size());
        for (int k = 0; k < 3; ++k) changed.add(ColumnSet(stack->size(), {changed.index(i + k, 30)}));
        stack->set_columns({i, 30}, {i + 3, 31}, pit);
        volume->follow(changed);
        // The mutant asks only tiles that hold a changed column: the reach is taken off again.
        placement.follow(rectangles(*stack, changed, -placement.reach()), rocks);
        const Instances mutant = rocks;
        placement.follow(rectangles(*stack, changed, 0.0), rocks);
        found += !difference(mutant, rocks).empty();
        stack->set_columns({i, 30}, {i + 3, 31}, before);
        volume->follow(changed);
        placement.follow(rectangles(*stack, changed, 0.0), rocks);
        ASSERT_EQ(difference(rocks, whole), "");
    }
    EXPECT_GE(found, 4);
}

TEST(RebuildRocks, more_of_them_than_can_be_is_an_error_that_leaves_them_alone)
{
    // 40 x 36 x 0.156 m3 of rocks that have 9.2e-6 m3 each: 24 million, of which air sees over 5.
    auto stack = std::make_shared<MaterialStack>(Vec2i(80, 72), 0.5, 1.0 / 64);
    const auto volume = std::make_shared<StackRocks>(stack, Border::extend);
    RockOptions options;
    options.size = 0.026;
    options.level = 3;
    RockPlacement placement(options, volume, stack->origin());
    Instances rocks = placement.place();
    EXPECT_TRUE(rocks.instances.empty());
    stack->set_columns({0, 0}, {80, 72}, std::vector<std::vector<Layer>>(80 * 72, {{Material::rock, 10}}));
    const ColumnSet changed = testing::everywhere(*stack);
    volume->follow(changed);
    const std::string error = testing::error_of([&] { placement.follow(rectangles(*stack, changed, 0.0), rocks); });
    EXPECT_EQ(error, "too many rocks, expected a rock_size so large that there are at most 5000000, got more");
    EXPECT_TRUE(rocks.instances.empty());
}

// -- Detail by distance --------------------------------------------------------------------------------------------------

TEST(RockDetail, changes_where_triangles_become_pixels)
{
    RockOptions options;
    options.size = 2.0;
    EXPECT_EQ(rock_level(options, 1e6), 0);  // nobody looks
    options.view = RockView{Vec3d(0.0), 1e-3};
    // Level 1 has 20 * 12^2 triangles, half of them on n^2 pi / 4 pixels, 18 on each: n = sqrt(2 * 2880 / (18 pi)) = 10.093 pixels, each 1e-3 of the
    // distance of the rock's near side: 2 / 0.010093 + 2 = 200.17 m. Levels 2 and 3 have 720 and 180: half of that width, and half again.
    for (const auto& [level, distance] : {std::pair(1, 200.17), std::pair(2, 398.33), std::pair(3, 794.67)}) {
        EXPECT_EQ(rock_level(options, distance - 0.05), level - 1);
        EXPECT_EQ(rock_level(options, distance + 0.05), level);
    }
    EXPECT_EQ(rock_level(options, 0.0), 0);
    options.level = 2;
    EXPECT_EQ(rock_level(options, 1.0), 2);
    EXPECT_EQ(rock_level(options, 1e9), 3);
}

/// Greatest distance, in pixels, of places on the mesh to the rock's surface where this level comes into use: along the gradient, to first order.
double widest_error(const RockOptions& options, int used_at)
{
    double worst = 0.0;
    RockOptions view = options;
    view.level = 0;
    view.view = RockView{Vec3d(0.0), 1e-3};
    double lo = 0.0, hi = 1e6;
    while (hi - lo > 1e-6) (rock_level(view, 0.5 * (lo + hi)) >= used_at ? hi : lo) = 0.5 * (lo + hi);
    const double pixel = 1e-3 * (hi - options.size);
    for (const Rock& rock : make_tile(options)) {
        for (const auto& t : rock.mesh.triangles) {
            const Vec3d a(rock.mesh.vertices[t[0]]), b(rock.mesh.vertices[t[1]]), c(rock.mesh.vertices[t[2]]);
            for (const Vec3d& p : {(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
                const RockField::Sample s = rock.field->sample(p);
                worst = std::max(worst, std::abs(s.value) / s.gradient.length() / pixel);
            }
        }
    }
    return worst;
}

TEST(RockDetail, differs_by_less_than_half_a_pixel_where_it_changes)
{
    for (int seed = 1; seed <= testing::count(2, 20); ++seed) {
        RockOptions options;
        options.per_tile = 20;
        options.roughness = 0.08;
        options.seed = static_cast<std::uint64_t>(seed);
        for (int level = 1; level < kRockLevels; ++level) {
            options.level = level;
            EXPECT_LT(widest_error(options, level), 0.5) << "level " << level;
        }
        // The mutant: two levels too coarse.
        options.level = 3;
        EXPECT_GT(widest_error(options, 1), 0.5);
    }
}

}  // namespace
}  // namespace hoodoo
