// The canyon from outside and from inside (Gamito2001, Figures 7 and 8): rays a second, evaluations a ray, and how often the paper's search is wrong.
// Everything through Embree, one thread, one ray at a time, camera rays. A ray of the paper's mode is wrong if it hits where certified marching
// misses, or the other way round, or lies more than 0.02 cells off. Missing: a mesh of equal error.

#include "tests/bench/warp.h"

#include "renderer/geometry/tracer.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "tests/bench/report.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace hoodoo::bench
{
namespace
{

constexpr double kCell = 10.0;

std::vector<Shape> canyon(const std::string& more)
{
    const CatalogueEntry* row = find_in_catalogue("canyon");
    SceneBudget budget;
    std::vector<Problem> problems;
    const std::string text =
        fmt::format("cell = {}\nheight = 10.0\noctaves = 4\nextent = 60.0\ncentre = [0, 0, 5]\ngrowth = 0.0\nlod = false\n{}", kCell, more);
    const Values values = check(row->schema, parse_toml(text, "<bench>", budget, problems), problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.name = "canyon";
    context.seed = 7;
    std::vector<Shape> shapes;
    shapes.push_back(row->make(values, context));
    return shapes;
}

std::vector<Ray> camera_rays(const Camera& camera, int side)
{
    std::vector<Ray> rays;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) rays.push_back(camera.ray(Vec2d(x + 0.5, y + 0.5), Vec2i(side, side), 0.0));
    return rays;
}

/// The longest free way at a fifth of the height: where a camera stands inside.
Camera inside_camera(const Surface& surface)
{
    Vec3d best(0.0), towards(1, 0, 0);
    double longest = 0.0;
    for (int i = 0; i < 400; ++i) {
        const Vec3d eye((i % 20 - 10) * 2.3, (i / 20 - 10) * 2.3, 3.5);
        if (surface.contains(eye)) continue;
        for (int k = 0; k < 8; ++k) {
            const Vec3d d(std::cos(k * 0.785398), std::sin(k * 0.785398), 0.0);
            double t = 0.0;
            while (t < 40.0 && !surface.contains(eye + d * t)) t += 0.25;
            if (t > longest) longest = t, best = eye, towards = d;
        }
    }
    return Camera(best, best + towards, Vec3d(0, 0, 1), 1.2, true);
}

}  // namespace

nlohmann::json warp_benchmark(bool full)
{
    const int side = full ? 64 : 24;
    const std::vector<Shape> certified = canyon("");
    const Surface& surface = *std::get<std::unique_ptr<Surface>>(certified.front());
    const auto tracer = make_embree_tracer(certified);
    nlohmann::json report;
    report["patches"] = surface.info().patches;
    report["bytes"] = surface.info().trace_bytes;
    report["build_seconds"] = surface.info().build_seconds;

    const std::vector<std::pair<std::string, Camera>> views{{"outside", Camera(Vec3d(-45, -45, 40), Vec3d(0, 0, 2), Vec3d(0, 0, 1), 0.9, true)},
                                                            {"inside", inside_camera(surface)}};
    const std::vector<double> epsilons = full ? std::vector<double>{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6} : std::vector<double>{1e-1, 1e-3};
    for (const auto& [name, camera] : views) {
        const std::vector<Ray> rays = camera_rays(camera, side);
        std::vector<TraceHit> truth;
        double evaluations = 0.0;
        for (const Ray& ray : rays) {
            truth.push_back(tracer->intersect(ray));
            evaluations += truth.back().evaluations;
        }
        const auto trace = [&](const Tracer& t) {
            return [&] {
                for (const Ray& ray : rays) benchmark_keep(t.intersect(ray).t);
            };
        };
        std::vector<std::vector<Shape>> shapes;
        std::vector<std::unique_ptr<Tracer>> tracers;
        std::vector<Task> tasks{{name, "certified", rays.size(), trace(*tracer)}};
        for (const double epsilon : epsilons) {
            // Areas in squared cells, as in the paper's units.
            shapes.push_back(canyon(fmt::format("mode = \"paper\"\nepsilon = {}\n", epsilon * kCell * kCell)));
            tracers.push_back(make_embree_tracer(shapes.back()));
            tasks.push_back({name, fmt::format("paper {:g}", epsilon), rays.size(), trace(*tracers.back())});
        }
        const std::map<std::string, double> rates = measure(tasks, 1, 0.05);
        report[name]["certified"] = {{"rays_per_second", rates.at(name + "/certified")},
                                     {"evaluations_per_ray", evaluations / static_cast<double>(rays.size())}};
        for (std::size_t e = 0; e < epsilons.size(); ++e) {
            double wrong = 0.0, spent = 0.0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const TraceHit hit = tracers[e]->intersect(rays[i]);
                spent += hit.evaluations;
                wrong += hit.valid != truth[i].valid || (hit.valid && std::abs(hit.t - truth[i].t) > 0.02 * kCell);
            }
            const double n = static_cast<double>(rays.size());
            report[name]["paper"].push_back({{"epsilon", epsilons[e]},
                                             {"rays_per_second", rates.at(fmt::format("{}/paper {:g}", name, epsilons[e]))},
                                             {"evaluations_per_ray", spent / n},
                                             {"wrong", wrong / n}});
        }
    }
    return report;
}

}  // namespace hoodoo::bench
