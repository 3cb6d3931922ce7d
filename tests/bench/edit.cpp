// One sculpting stroke of radius 8 cells somewhere on the ground, stabilised, rebuilt where it touched, until the first ray of the next frame has
// been traced; strokes follow one another on one terrain. Beside it what building surface and tracer anew takes. All threads of the machine.
//
// The terrain of "edit" is the cave of scenes/cave.toml, 1000 x 750 columns, with its rocks, which are placed anew about a stroke. "rugged" and
// "squares" are the terrain that intersectors are measured on, with its tunnels and overhangs, without rocks: 1000 x 750 columns, and 512^2, 1024^2,
// 2048^2 to see that the cost follows the stroke.

#include "tests/bench/edit.h"

#include "renderer/geometry/tracer.h"
#include "renderer/scene/read.h"
#include "renderer/scene/terrain.h"
#include "terrain/edit/stabilise.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/convolution.h"
#include "tests/edits.h"
#include "tests/support/terrains.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>

namespace hoodoo::bench
{
namespace
{

class Clock
{
public:
    /// Milliseconds since the last call.
    double lap()
    {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
        return ms;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

nlohmann::json percentiles(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
    };
    return {{"p50", at(0.50)}, {"p95", at(0.95)}, {"max", values.back()}};
}

/// Rays a second, one thread, all over the terrain from above.
double rays_a_second(const Tracer& tracer, const Box3d& room)
{
    constexpr int rays = 100000;
    const auto start = std::clock();
    int hits = 0;
    for (std::uint64_t k = 0; k < rays; ++k) {
        const auto random = [&](std::uint64_t n) { return unit_real(mix64(8 * k + n)); };
        Ray ray;
        ray.origin = Vec3d(room.min.x + room.size().x * random(1), room.min.y + room.size().y * random(2), room.max.z);
        ray.direction = Vec3d(random(3) - 0.5, random(4) - 0.5, -1.0).normalized();
        ray.crossing = Crossing::entering;
        hits += tracer.intersect(ray).valid;
    }
    if (hits == 0) std::printf("no ray hits anything\n");
    return rays / (static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
}

nlohmann::json measure(Vec2i size, int strokes)
{
    using testing::table;
    const std::shared_ptr<MaterialStack> stack = testing::bench_terrain(true, size).stack;
    Clock clock;
    std::vector<Shape> shapes;
    auto made = make_convolution_surface(stack);
    EditableSurface& surface = *made;
    const double build_surface = clock.lap();
    shapes.emplace_back(std::move(made));
    auto tracer = make_embree_tracer(shapes, {.editable = true, .room = surface.room()});
    const double build_tracer = clock.lap();
    {
        const auto fixed = make_embree_tracer(shapes);
    }
    const double build_fixed_tracer = clock.lap();

    std::map<std::string, std::vector<double>> parts;
    std::size_t columns = 0, tiles_built = 0;
    for (int k = 0; k < strokes; ++k) {
        const auto random = [&](std::uint64_t n) { return unit_real(mix64(64 * static_cast<std::uint64_t>(k) + n)); };
        const Vec3d target(size.x * (0.05 + 0.9 * random(1)), size.y * (0.05 + 0.9 * random(2)), stack->highest_top() * stack->unit() * random(3));
        const Node entries = table(
            {{"target", {target.x, target.y, target.z}}, {"radius", 8.0}, {"mode", k % 2 ? "add" : "carve"}, {"stabilise", testing::flag(false)}});

        const std::clock_t processor = std::clock();
        clock.lap();
        ColumnSet changed = testing::edit(*stack, "sculpt", entries);
        const double tool = clock.lap();
        changed.add(stabilise(*stack, changed, {}));
        const double settle = clock.lap();
        const std::vector<std::uint32_t> tiles = surface.rebuild(changed).tiles;
        const double cells = clock.lap();
        tracer->update(0, tiles);
        const double tree = clock.lap();
        const Ray ray{.origin = target + Vec3d(0, 0, 400), .direction = Vec3d(0, 0, -1)};
        const TraceHit hit = tracer->intersect(ray);
        if (hit.valid) tracer->interact(ray, hit);
        const double first = clock.lap();

        const double cpu = 1e3 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
        const std::map<std::string, double> stroke = {{"first_ray_cpu_ms", cpu}, {"first_ray_ms", tool + settle + cells + tree + first},
                                                      {"tool_ms", tool},         {"stabilise_ms", settle},
                                                      {"cells_ms", cells},       {"tree_ms", tree},
                                                      {"ray_ms", first}};
        for (const auto& [name, ms] : stroke) parts[name].push_back(ms);
        columns += changed.count(), tiles_built += tiles.size();
    }
    nlohmann::json report = {{"columns", {size.x, size.y}},
                             {"strokes", strokes},
                             {"changed_columns_mean", static_cast<double>(columns) / strokes},
                             {"rebuilt_tiles_mean", static_cast<double>(tiles_built) / strokes},
                             {"full_surface_ms", build_surface},
                             {"full_tracer_ms", build_tracer},
                             {"full_tracer_not_editable_ms", build_fixed_tracer}};
    for (const auto& [name, values] : parts) report[name] = percentiles(values);
    const auto fixed = make_embree_tracer(shapes);
    report["rays_of_editable_against_fixed_tracer"] = rays_a_second(*tracer, surface.room()) / rays_a_second(*fixed, surface.room());
    const auto half = [&](const char* name) { return report[name]["p50"].get<double>(); };
    std::printf("%5d x %-5d first ray after a stroke: %.1f ms (p95 %.1f; %.1f of the processor): tool %.1f, stabilise %.1f, cells %.1f, tree %.1f\n",
                size.x, size.y, half("first_ray_ms"), report["first_ray_ms"]["p95"].get<double>(), half("first_ray_cpu_ms"), half("tool_ms"),
                half("stabilise_ms"), half("cells_ms"), half("tree_ms"));
    std::printf("              built whole: %.0f ms; rays a second against a tracer that is not editable: %.2f\n", build_surface + build_tracer,
                report["rays_of_editable_against_fixed_tracer"].get<double>());
    std::fflush(stdout);
    return report;
}

/// The cave of scenes/cave.toml, with its rocks, as an editor holds it: strokes by the surface's own edit(), rocks placed anew.
nlohmann::json measure_cave(bool full, int strokes)
{
    SceneOverrides coarse;
    if (!full) coarse.params.emplace_back("cell", "0.5");
    const Description description = read_scene(HOODOO_SOURCE_DIR "/scenes/cave.toml", false, coarse);
    const DescribedNode& node = choose_terrain(description, {});
    BuildContext context = terrain_context(node, description, 0, {});
    context.editable = true;
    Clock clock;
    std::vector<Shape> shapes;
    shapes.push_back(terrain_row(node).make(node.values, context));
    auto& surface = dynamic_cast<EditableSurface&>(*std::get<std::unique_ptr<Surface>>(shapes[0]));
    const double build_terrain = clock.lap(), build_surface = 1e3 * surface.info().build_seconds;
    const auto tracer = make_embree_tracer(shapes, {.editable = true, .room = surface.room()});
    const double build_tracer = clock.lap();

    const Box3d room = surface.room();
    const double cell = room.size().x / 1000.0 * (full ? 1.0 : 2.0);
    std::map<std::string, std::vector<double>> parts;
    std::size_t columns = 0, tiles = 0, moved = 0;
    for (int k = 0; k < strokes; ++k) {
        const auto random = [&](std::uint64_t n) { return unit_real(mix64(64 * static_cast<std::uint64_t>(k) + n)); };
        // Where a ray from a place in the air of the chasm meets the ground: what a sculptor sees.
        Ray ray;
        ray.origin = Vec3d(112 + 10 * random(1), 70 + 40 * random(2), 48 + 8 * random(3));
        ray.direction = Vec3d(random(4) - 0.5, random(5) - 0.5, random(6) - 0.7).normalized();
        const TraceHit seen = tracer->intersect(ray);
        if (!seen.valid) continue;
        const Vec3d target = ray.at(seen.t);
        const Node stroke = testing::table({{"target", {target.x, target.y, target.z}}, {"radius", 8.0 * cell}, {"mode", k % 2 ? "add" : "carve"}});

        const std::clock_t processor = std::clock();
        clock.lap();
        const ColumnSet changed = surface.edit("sculpt", stroke);
        const double tool = clock.lap();
        const Rebuilt rebuilt = surface.rebuild(changed);
        const double cells = clock.lap();
        tracer->update(0, rebuilt.tiles, rebuilt.rocks);
        const double tree = clock.lap();
        const TraceHit hit = tracer->intersect(ray);
        if (hit.valid) tracer->interact(ray, hit);
        const double first = clock.lap();
        const double cpu = 1e3 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
        const std::map<std::string, double> spent = {{"first_ray_cpu_ms", cpu},
                                                     {"first_ray_ms", tool + cells + tree + first},
                                                     {"tool_and_stabilise_ms", tool},
                                                     {"cells_and_rocks_ms", cells},
                                                     {"tree_ms", tree},
                                                     {"ray_ms", first}};
        for (const auto& [name, ms] : spent) parts[name].push_back(ms);
        columns += changed.count(), tiles += rebuilt.tiles.size(), moved += rebuilt.rocks != InstanceChange::none;
    }
    const auto done = static_cast<double>(parts["first_ray_ms"].size());
    nlohmann::json report = {{"scene", "scenes/cave.toml"},
                             {"columns", surface.info().columns},
                             {"rocks", surface.instances()->instances.size()},
                             {"strokes", done},
                             {"changed_columns_mean", static_cast<double>(columns) / done},
                             {"rebuilt_tiles_mean", static_cast<double>(tiles) / done},
                             {"strokes_that_moved_rocks", moved},
                             {"full_terrain_with_its_edits_ms", build_terrain},
                             {"full_build_ms", build_surface},
                             {"full_tracer_ms", build_tracer}};
    for (const auto& [name, values] : parts) report[name] = percentiles(values);
    const auto at = [&](const char* name, const char* share) { return report[name][share].get<double>(); };
    std::printf(
        "cave, %.0f strokes: first ray %.1f ms (p95 %.1f; %.1f of the processor, p95 %.1f): tool and stabilise %.1f, cells and rocks %.1f, "
        "tree %.1f; made whole: %.0f ms\n",
        done, at("first_ray_ms", "p50"), at("first_ray_ms", "p95"), at("first_ray_cpu_ms", "p50"), at("first_ray_cpu_ms", "p95"),
        at("tool_and_stabilise_ms", "p50"), at("cells_and_rocks_ms", "p50"), at("tree_ms", "p50"), build_terrain + build_tracer);
    std::fflush(stdout);
    return report;
}

}  // namespace

nlohmann::json edit_benchmark(bool full)
{
    nlohmann::json report;
    report["edit"] = measure_cave(full, full ? 200 : 20);
    report["rugged"] = measure(full ? Vec2i(1000, 750) : Vec2i(256, 192), full ? 200 : 20);
    const std::vector<int> sizes = full ? std::vector<int>{512, 1024, 2048} : std::vector<int>{128};
    for (const int n : sizes) report["squares"].push_back(measure(Vec2i(n, n), full ? 100 : 20));
    return report;
}

}  // namespace hoodoo::bench
