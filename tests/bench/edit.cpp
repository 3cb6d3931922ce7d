// One sculpting stroke of radius 8 cells somewhere on the ground, stabilised, rebuilt where it touched, until the first ray of the next frame has
// been traced; strokes follow one another on one terrain. Beside it what building surface and tracer anew takes. All threads of the machine.
//
// The terrain is the rugged one that intersectors are measured on, with its tunnels and overhangs: 1000 x 750 columns, and 512^2, 1024^2, 2048^2 to
// see that the cost follows the stroke.

#include "tests/bench/edit.h"

#include "renderer/geometry/tracer.h"
#include "terrain/edit/stabilise.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/convolution.h"
#include "tests/edits.h"
#include "tests/support/terrains.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
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

        clock.lap();
        ColumnSet changed = testing::edit(*stack, "sculpt", entries);
        const double tool = clock.lap();
        changed.add(stabilise(*stack, changed, {}));
        const double settle = clock.lap();
        const std::vector<std::uint32_t> tiles = surface.rebuild(changed);
        const double cells = clock.lap();
        tracer->update(0, tiles);
        const double tree = clock.lap();
        const Ray ray{.origin = target + Vec3d(0, 0, 400), .direction = Vec3d(0, 0, -1)};
        const TraceHit hit = tracer->intersect(ray);
        if (hit.valid) tracer->interact(ray, hit);
        const double first = clock.lap();

        const std::map<std::string, double> stroke = {{"first_ray_ms", tool + settle + cells + tree + first},
                                                      {"tool_ms", tool},
                                                      {"stabilise_ms", settle},
                                                      {"cells_ms", cells},
                                                      {"tree_ms", tree},
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
    std::printf(
        "%5d x %-5d first ray after a stroke: %.1f ms (p95 %.1f): tool %.1f, stabilise %.1f, cells %.1f, tree %.1f, ray %.2f; built whole: %.0f ms\n",
        size.x, size.y, report["first_ray_ms"]["p50"].get<double>(), report["first_ray_ms"]["p95"].get<double>(),
        report["tool_ms"]["p50"].get<double>(), report["stabilise_ms"]["p50"].get<double>(), report["cells_ms"]["p50"].get<double>(),
        report["tree_ms"]["p50"].get<double>(), report["ray_ms"]["p50"].get<double>(), build_surface + build_tracer);
    std::fflush(stdout);
    return report;
}

}  // namespace

nlohmann::json edit_benchmark(bool full)
{
    nlohmann::json report;
    report["edit"] = measure(full ? Vec2i(1000, 750) : Vec2i(256, 192), full ? 200 : 20);
    const std::vector<int> sizes = full ? std::vector<int>{512, 1024, 2048} : std::vector<int>{128};
    for (const int n : sizes) report["squares"].push_back(measure(Vec2i(n, n), full ? 100 : 20));
    return report;
}

}  // namespace hoodoo::bench
