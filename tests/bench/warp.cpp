// The canyon from outside and from inside (Gamito2001, Figures 7 and 8): rays a second, evaluations a ray, and how often the paper's search is wrong.
// Everything through Embree, one thread, one ray at a time. A ray of the paper's mode is wrong if it hits where certified marching misses, or the
// other way round, or lies more than 0.02 cells off. Beside them the same surface as triangles, through the same tracer; no mesh that fits here has
// the certified search's error (1e-7 m), so each says its own.

#include "tests/bench/warp.h"

#include "renderer/geometry/tracer.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/io/polygonise.h"
#include "terrain/math/hash.h"
#include "tests/bench/report.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <unistd.h>
#include <vector>

namespace hoodoo::bench
{
namespace
{

constexpr double kCell = 10.0, kHalf = 60.0;  // metres: of the noise's cells, and half the side of what is traced

std::vector<Shape> canyon(const std::string& more)
{
    const CatalogueEntry* row = find_in_catalogue("canyon");
    SceneBudget budget;
    std::vector<Problem> problems;
    const std::string text = fmt::format(
        "cell = {}\nheight = 10.0\noctaves = 4\nextent = 60.0\ncentre = [0, 0, 5]\ngrowth = 0.0\npatch = 1.0\nlod = false\n{}", kCell, more);
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

/// What rays do after the first hit: one in a random direction by the cosine, one towards the sun. All start a hundredth of a metre above the
/// surface.
struct RaySets {
    std::vector<Ray> primary, diffuse, shadow;
};

RaySets ray_sets(const Tracer& tracer, std::vector<Ray> camera)
{
    RaySets sets;
    sets.primary = std::move(camera);
    const Vec3d sun = Vec3d(0.5, 0.3, 0.6).normalized();
    for (std::size_t i = 0; i < sets.primary.size(); ++i) {
        const TraceHit hit = tracer.intersect(sets.primary[i]);
        if (!hit.valid) continue;
        const Interaction at = tracer.interact(sets.primary[i], hit);
        Ray ray;
        ray.crossing = Crossing::entering;
        ray.origin = at.position + at.geometric_normal * 0.01;
        Vec3d u, v;
        orthonormal_frame(at.geometric_normal, u, v);
        const double phi = 6.283185307 * unit_real(hash_cell(1, static_cast<std::int64_t>(i), 0)),
                     r = unit_real(hash_cell(1, static_cast<std::int64_t>(i), 1));
        ray.direction =
            (u * (std::cos(phi) * std::sqrt(r)) + v * (std::sin(phi) * std::sqrt(r)) + at.geometric_normal * std::sqrt(1.0 - r)).normalized();
        sets.diffuse.push_back(ray);
        if (at.geometric_normal.dot(sun) <= 0.0) continue;
        ray.direction = sun;
        sets.shadow.push_back(ray);
    }
    return sets;
}

std::function<void()> all_of(const Tracer& tracer, const std::vector<Ray>& rays, bool occluded = false)
{
    return [&tracer, &rays, occluded] {
        for (const Ray& ray : rays) {
            if (occluded)
                benchmark_keep(tracer.occluded(ray));
            else
                benchmark_keep(tracer.intersect(ray).t);
        }
    };
}

double evaluations_per_ray(const Tracer& tracer, const std::vector<Ray>& rays)
{
    double sum = 0.0;
    for (const Ray& ray : rays) sum += tracer.intersect(ray).evaluations;
    return sum / static_cast<double>(rays.size());
}

double resident_megabytes()
{
    std::size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

/// The same surface as triangles, `spacing` metres apart.
struct Meshed {
    std::vector<Shape> shapes;
    std::unique_ptr<Tracer> tracer;
    nlohmann::json facts;
};

Meshed meshed(const Surface& surface, double spacing)
{
    Meshed m;
    const double before = resident_megabytes();
    auto start = std::chrono::steady_clock::now();
    TriangleMesh mesh;
    mesh.material = "bedrock";
    PolygoniseOptions options;
    options.spacing = spacing;
    options.region = Box3d(Vec3d(-kHalf, -kHalf, 0.0), Vec3d(kHalf, kHalf, 10.5));
    const PolygoniseReport report = polygonise(*surface.field(), options, [&](const MeshPart& part) {
        for (const Vec3d& v : part.vertices) mesh.vertices.emplace_back(v);
        mesh.triangles.insert(mesh.triangles.end(), part.triangles.begin(), part.triangles.end());
    });
    m.facts["meshing_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    m.facts["triangles"] = report.triangles;
    m.facts["mean_error_metres"] = report.mean_error;
    m.facts["maximum_error_metres"] = report.maximum_error;
    m.shapes.emplace_back(std::move(mesh));
    start = std::chrono::steady_clock::now();
    m.tracer = make_embree_tracer(m.shapes);
    m.facts["build_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    m.facts["megabytes"] = resident_megabytes() - before;
    return m;
}

/// The paper's search at one epsilon (in squared cells, as in the paper's units) against what certified marching found.
nlohmann::json paper_search(const std::string& view, const std::vector<Ray>& rays, const std::vector<TraceHit>& truth, double epsilon)
{
    const std::vector<Shape> shapes = canyon(fmt::format("mode = \"paper\"\nepsilon = {}\n", epsilon * kCell * kCell));
    const auto tracer = make_embree_tracer(shapes);
    const double rate = measure({{view, "paper", rays.size(), all_of(*tracer, rays)}}, 1, 0.05).at(view + "/paper");
    double wrong = 0.0, spent = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const TraceHit hit = tracer->intersect(rays[i]);
        spent += hit.evaluations;
        wrong += hit.valid != truth[i].valid || (hit.valid && std::abs(hit.t - truth[i].t) > 0.02 * kCell);
    }
    const double n = static_cast<double>(rays.size());
    std::printf("%-8s paper, epsilon %-8g %10.0f rays/s %8.1f evaluations/ray  wrong %.4f\n", view.c_str(), epsilon, rate, spent / n, wrong / n);
    return {{"epsilon", epsilon}, {"rays_per_second", rate}, {"evaluations_per_ray", spent / n}, {"wrong", wrong / n}};
}

}  // namespace

nlohmann::json warp_benchmark(bool full)
{
    const int side = full ? 256 : 64;
    const std::vector<Shape> certified = canyon("");
    const Surface& surface = *std::get<std::unique_ptr<Surface>>(certified.front());
    const auto tracer = make_embree_tracer(certified);
    nlohmann::json report;
    report["patches"] = surface.info().patches;
    report["bytes"] = surface.info().trace_bytes;
    report["build_seconds"] = surface.info().build_seconds;
    std::printf("certified: %llu patches, %.1f MB, %.2f s\n", static_cast<unsigned long long>(surface.info().patches),
                static_cast<double>(surface.info().trace_bytes) / 1e6, surface.info().build_seconds);
    std::vector<Meshed> meshes;
    for (const double spacing : full ? std::vector<double>{kCell / 8, kCell / 16} : std::vector<double>{kCell / 5}) {
        meshes.push_back(meshed(surface, spacing));
        std::printf("mesh: %s\n", meshes.back().facts.dump().c_str());
        report["meshes"].push_back(meshes.back().facts);
    }

    const std::vector<std::pair<std::string, Camera>> views{{"outside", Camera(Vec3d(-45, -45, 40), Vec3d(0, 0, 2), Vec3d(0, 0, 1), 0.9, true)},
                                                            {"inside", inside_camera(surface)}};
    const std::vector<double> epsilons = full ? std::vector<double>{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6} : std::vector<double>{1e-1, 1e-3};
    for (const auto& [view, camera] : views) {
        const RaySets sets = ray_sets(*tracer, camera_rays(camera, side));
        std::vector<Task> tasks;
        const std::vector<std::pair<std::string, const std::vector<Ray>*>> kinds{
            {"primary", &sets.primary}, {"diffuse", &sets.diffuse}, {"shadow", &sets.shadow}};
        for (const auto& [kind, rays] : kinds) {
            const std::string group = fmt::format("{}/{}", view, kind);
            tasks.push_back({group, "certified", rays->size(), all_of(*tracer, *rays, rays == &sets.shadow)});
            for (std::size_t m = 0; m < meshes.size(); ++m)
                tasks.push_back({group, fmt::format("mesh {}", m), rays->size(), all_of(*meshes[m].tracer, *rays, rays == &sets.shadow)});
        }
        const std::map<std::string, double> rates = measure(tasks, 3, 0.1);
        for (const auto& [kind, rays] : kinds) {
            const std::string group = fmt::format("{}/{}", view, kind);
            nlohmann::json& out = report[view][kind];
            out["rays_per_second"] = rates.at(group + "/certified");
            out["evaluations_per_ray"] = evaluations_per_ray(*tracer, *rays);
            std::printf("%-8s %-8s %10.0f rays/s %8.1f evaluations/ray", view.c_str(), kind.c_str(), rates.at(group + "/certified"),
                        out["evaluations_per_ray"].get<double>());
            for (std::size_t m = 0; m < meshes.size(); ++m) {
                const double ratio = rates.at(group + "/certified") / rates.at(fmt::format("{}/mesh {}", group, m));
                out["over_mesh"].push_back(ratio);
                std::printf("  %.3f of mesh %zu", ratio, m);
            }
            std::printf("\n");
        }
        const std::vector<Ray> few = camera_rays(camera, full ? 64 : 24);
        std::vector<TraceHit> truth;
        for (const Ray& ray : few) truth.push_back(tracer->intersect(ray));
        for (const double epsilon : epsilons) report[view]["paper"].push_back(paper_search(view, few, truth, epsilon));
    }
    return report;
}

}  // namespace hoodoo::bench
