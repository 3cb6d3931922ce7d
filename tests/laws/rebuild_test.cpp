// A surface that followed edits is, bit for bit, the surface that one would build anew.
#include "renderer/geometry/tracer.h"
#include "terrain/surfaces/convolution.h"
#include "tests/counts.h"
#include "tests/edits.h"
#include "tests/stacks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

namespace hoodoo
{
namespace
{

bool same_bits(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_bits(const Vec3d& a, const Vec3d& b)
{
    return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// What differs between two surfaces of one stack; empty: nothing. Every patch is asked for its box and met by rays through that box.
std::string difference(const Surface& a, const Surface& b, std::uint64_t seed, int rays)
{
    if (a.tile_count() != b.tile_count()) return "number of tiles";
    for (std::uint32_t tile = 0; tile < a.tile_count(); ++tile) {
        if (a.patch_count(tile) != b.patch_count(tile)) return fmt::format("patches of tile {}", tile);
        for (std::uint32_t i = 0; i < a.patch_count(tile); ++i) {
            const PatchId patch{tile, i};
            const Box3d box = a.patch_bounds(patch), other = b.patch_bounds(patch);
            if (!same_bits(box.min, other.min) || !same_bits(box.max, other.max)) return fmt::format("box of patch {} of tile {}", i, tile);
            for (int k = 0; k < rays; ++k) {
                seed = mix64(seed);
                const auto random = [&](std::uint64_t n) { return unit_real(mix64(seed + n)) - 0.5; };
                Ray ray;
                ray.direction = Vec3d(random(1), random(2), random(3)).normalized();
                ray.origin = box.center() + Vec3d(random(4), random(5), random(6)) * box.size() - ray.direction * 20.0;
                Hit one, two;
                const bool met = a.intersect(patch, ray, one);
                if (met != b.intersect(patch, ray, two) || one.evaluations != two.evaluations)
                    return fmt::format("a ray at patch {} of tile {}", i, tile);
                if (!met) continue;
                if (!same_bits(one.t, two.t)) return fmt::format("a hit of patch {} of tile {}", i, tile);
                const Interaction x = a.interact(ray, one), y = b.interact(ray, two);
                if (!same_bits(x.position, y.position) || !same_bits(x.shading_normal, y.shading_normal))
                    return fmt::format("the story of a hit of tile {}", tile);
            }
        }
    }
    return {};
}

/// What two tracers answer differently, distances by more than `tolerance`; rays all over the terrain.
std::string difference(const Tracer& a, const Tracer& b, const Box3d& room, double tolerance, std::uint64_t seed, int rays, int& hits)
{
    for (int k = 0; k < rays; ++k) {
        seed = mix64(seed);
        const auto random = [&](std::uint64_t n) { return unit_real(mix64(seed + n)); };
        Ray ray;
        ray.origin = room.min + room.size() * Vec3d(random(1), random(2), 0.3 * random(3));
        ray.direction = Vec3d(random(4) - 0.5, random(5) - 0.5, random(6) - 0.5).normalized();
        const TraceHit one = a.intersect(ray), two = b.intersect(ray);
        if (one.valid != two.valid || a.occluded(ray) != b.occluded(ray)) return "whether a ray meets anything";
        if (!one.valid) continue;
        ++hits;
        if (tolerance == 0.0 ? !same_bits(one.t, two.t) : std::abs(one.t - two.t) > tolerance)
            return fmt::format("a distance, {} against {}", one.t, two.t);
    }
    return {};
}

struct Case {
    const char* name;
    ConvolutionOptions options;
};

std::vector<Case> cases()
{
    ConvolutionOptions exact, sphere, cut, wide;
    sphere.sigma = 0.4, sphere.exact = false;
    cut.border = Border::cut, cut.base = 1.0, cut.sigma = 0.75;
    wide.sigma = 1.0;
    return {{"exact", exact}, {"sphere", sphere}, {"cut", cut}, {"wide", wide}};
}

std::shared_ptr<MaterialStack> country(std::uint64_t seed)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(90, 70), 0.5, 1.0 / 64, Vec3d(100, -40, 3));
    std::vector<std::vector<Layer>> columns;
    for (int j = 0; j < 70; ++j) {
        for (int i = 0; i < 90; ++i) {
            const auto top = static_cast<std::int32_t>(500 + 200 * std::sin(0.1 * i + 0.01 * static_cast<double>(seed)) * std::cos(0.13 * j));
            columns.push_back({{Material::bedrock, top}, {Material::sand, top + static_cast<std::int32_t>(hash_cell(seed, i, j) % 20)}});
        }
    }
    stack->set_columns({0, 0}, {90, 70}, columns);
    return stack;
}

/// The k-th of a row of unlike edits, some over the edge of the grid.
ColumnSet edit_somewhere(MaterialStack& stack, std::uint64_t k)
{
    using testing::list;
    using testing::table;
    const auto random = [&](std::uint64_t n) { return unit_real(mix64(17 * k + n)); };
    const double x = 100 + 45 * random(1), y = -40 + 35 * random(2), z = 3 + 12 * random(3);
    switch (k % 3) {
        case 0:
            return testing::edit(
                stack, "sculpt",
                table({{"target", {x, y, z}}, {"radius", 1.0 + 4.0 * random(4)}, {"strokes", 3.0}, {"mode", k % 2 ? "add" : "carve"}}), k);
        case 1:
            return testing::edit(stack, "sweep",
                                 table({{"points", list({{x, y, z}, {x + 9 * random(5), y - 9 * random(6), z}})}, {"radius", {0.5 + 2 * random(4)}}}),
                                 k);
        default:
            return testing::edit(stack, "sweep",
                                 table({{"points", list({{x, y, z}})}, {"radius", {0.5 + random(4)}}, {"mode", "add"}, {"material", "rock"}}), k);
    }
}

TEST(Rebuild, of_what_an_edit_touched_is_the_full_rebuild_bit_for_bit)
{
    const int edits = testing::count(6, 60);
    for (const Case& c : cases()) {
        const auto stack = country(7);
        std::vector<Shape> shapes;
        auto made = make_convolution_surface(stack, c.options);
        EditableSurface& surface = *made;
        const Box3d room = surface.room();
        shapes.emplace_back(std::move(made));
        const auto tracer = make_embree_tracer(shapes, {.editable = true, .room = room});
        int hits = 0;
        for (int k = 0; k < edits; ++k) {
            const ColumnSet changed = edit_somewhere(*stack, static_cast<std::uint64_t>(k));
            tracer->update(0, surface.rebuild(changed).tiles);
            std::vector<Shape> fresh;
            fresh.emplace_back(make_convolution_surface(stack, c.options));
            EXPECT_EQ(difference(surface, *std::get<std::unique_ptr<Surface>>(fresh[0]), static_cast<std::uint64_t>(k), 2), "")
                << c.name << " edit " << k;
            const auto oracle = make_embree_tracer(fresh);
            // Closed forms do not depend on the order in which patches are met; sphere tracing does, in its last bits.
            const double tolerance = c.options.exact ? 0.0 : 1e-9;
            EXPECT_EQ(difference(*tracer, *oracle, room, tolerance, static_cast<std::uint64_t>(k), testing::count(2000, 20000), hits), "")
                << c.name << " edit " << k;
        }
        EXPECT_GT(hits, 400 * edits) << c.name;
    }
}

TEST(Rebuild, that_forgets_a_tile_or_the_kernels_reach_is_found_out)
{
    int found = 0, tried = 0;
    for (const Case& c : cases()) {
        const auto stack = country(8);
        // Columns about the side of a tile: the neighbour tile reads some of them through the kernel alone.
        std::size_t most = 0;
        for (const int column : {29, 30, 31, 32, 33}) {
            const auto surface = make_convolution_surface(stack, c.options);
            const std::vector<Layer> lower = {{Material::bedrock, 200 + column}};
            const std::vector<Layer> before = stack->column(column, 20);
            stack->set_column(column, 20, lower);
            // The mutant is told of a column far away instead, which leaves the touched tiles old.
            surface->rebuild(ColumnSet(stack->size(), {ColumnSet(stack->size()).index(80, 60)}));
            ++tried;
            found += !difference(*surface, *make_convolution_surface(stack, c.options), 1, 2).empty();
            const std::vector<std::uint32_t> tiles = surface->rebuild(ColumnSet(stack->size(), {ColumnSet(stack->size()).index(column, 20)})).tiles;
            most = std::max(most, tiles.size());
            EXPECT_EQ(difference(*surface, *make_convolution_surface(stack, c.options), 1, 2), "") << c.name;
            stack->set_column(column, 20, before);
        }
        EXPECT_EQ(most, 4u) << c.name;  // two tiles of ground and the two of rock
    }
    EXPECT_EQ(found, tried);
}

TEST(Rebuild, of_water_that_comes_and_goes_is_the_full_rebuild_too)
{
    const auto stack = country(12);
    ConvolutionOptions options;
    options.water = true;
    std::vector<Shape> shapes;
    auto made = make_convolution_surface(stack, options);
    EditableSurface& surface = *made;
    shapes.emplace_back(std::move(made));
    const auto tracer = make_embree_tracer(shapes, {.editable = true, .room = surface.room()});
    int hits = 0;
    for (const Material material : {Material::water, Material::air}) {
        std::vector<std::uint32_t> changed;
        for (int j = 20; j < 50; ++j) {
            for (int i = 30; i < 60; ++i) {
                std::vector<Layer> column = stack->column(i, j);
                if (column.back().material == Material::water) column.pop_back();
                if (column.back().top < 640 && material == Material::water) column.push_back({Material::water, 640});
                stack->set_column(i, j, column);
                changed.push_back(ColumnSet(stack->size()).index(i, j));
            }
        }
        tracer->update(0, surface.rebuild(ColumnSet(stack->size(), changed)).tiles);
        std::vector<Shape> fresh;
        fresh.emplace_back(make_convolution_surface(stack, options));
        EXPECT_EQ(difference(surface, *std::get<std::unique_ptr<Surface>>(fresh[0]), 5, 2), "");
        EXPECT_EQ(difference(*tracer, *make_embree_tracer(fresh), surface.room(), 0.0, 5, 2000, hits), "");
    }
    EXPECT_GT(hits, 500);
}

TEST(Rebuild, costs_what_it_touches)
{
    const auto stack = country(9);
    const auto surface = make_convolution_surface(stack);
    const std::vector<std::uint32_t> inside = surface->rebuild(ColumnSet(stack->size(), {ColumnSet(stack->size()).index(48, 40)})).tiles;
    EXPECT_EQ(inside.size(), 2u);  // one tile of ground, one of rock
    EXPECT_TRUE(surface->rebuild(ColumnSet(stack->size())).tiles.empty());
}

TEST(Rebuild, beyond_the_room_it_was_given_moves_the_tracers_boxes)
{
    // No room given: matter put far above what was there lies outside the tracer's box, and must be met all the same.
    const auto stack = country(10);
    std::vector<Shape> shapes;
    auto made = make_convolution_surface(stack);
    EditableSurface& surface = *made;
    shapes.emplace_back(std::move(made));
    const auto tracer = make_embree_tracer(shapes, {.editable = true, .room = {}});
    const Ray down{.origin = Vec3d(120, -20, 300), .direction = Vec3d(0, 0, -1)};
    EXPECT_LT(tracer->intersect(down).t, 300.0);
    tracer->update(
        0, surface
               .rebuild(testing::edit(
                   *stack, "sweep",
                   testing::table(
                       {{"points", testing::list({{120.0, -20.0, 90.0}})}, {"radius", {4.0}}, {"mode", "add"}, {"stabilise", testing::flag(false)}})))
               .tiles);
    EXPECT_NEAR(tracer->intersect(down).t, 300 - 94, 0.3);
}

TEST(Rebuild, is_refused_by_a_tracer_that_was_not_made_for_it)
{
    const auto stack = country(11);
    std::vector<Shape> shapes;
    shapes.emplace_back(make_convolution_surface(stack));
    const auto tracer = make_embree_tracer(shapes);
    EXPECT_EQ(testing::error_of([&] { tracer->update(0, {}); }), "this tracer was not made for edits");
}

}  // namespace
}  // namespace hoodoo
