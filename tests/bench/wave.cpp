// The hero still, scenes/breaking_wave.toml, at the paper's 300 x 200 (Gamito2001 took 40 minutes a frame on an SGI O2, 40% of it for intersections),
// 64 samples a pixel: seconds a frame by the clock on all cores and by processor time, the shares of the time by where the program counter is, and
// evaluations of the sea a camera ray. Then camera rays, diffuse rays from where they end and rays to the sun, one thread, one at a time, through
// Embree: the wave itself beside triangles of the same water (made within 70 m of the eye; meshing and Embree's building are timed apart, and only
// rays that end there are asked, so that both see the same water). A ray of the mesh is wrong if it hits where the wave is missed or the other way
// round, or more than 2 cm away. Leaf functions that intersection and shading share (sine, arc tangent, square root) count as intersection, noise as
// shading, of a medium too: the shares are of functions, not of callers.

#include "tests/bench/wave.h"

#include "renderer/geometry/tracer.h"
#include "renderer/render.h"
#include "terrain/io/polygonise.h"
#include "tests/bench/profile.h"
#include "tests/bench/report.h"
#include "tests/support/numbers.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace hoodoo::bench
{
namespace
{

using hoodoo::testing::Numbers;

std::string part_of(const std::string& function)
{
    const auto has = [&](const char* word) { return function.find(word) != std::string::npos; };
    if (has("SeaFoam") || has("media") || has("Medium") || has("Density") || has("Majorant") || has("majorant") || has("fbm")) return "media";
    if (has("libembree") || has("Tracer") || has("FieldPatches") || has("BreakingSea::value") || has("BreakingSea::deviation_value") ||
        has("BreakingSea::local") || has("bound") || has("circular_place") || has("parabolic_place") || has("Swells::height") || has("keeps_sign") ||
        has("is_monotone") || has("hoodoo::life") || has("part_") || has("libm"))
        return "intersection";
    if (has("Sampler") || has("owen") || has("sobol") || has("Filter::")) return "sampling";
    return "shading";
}

nlohmann::json frame_facts(const LoadedScene& loaded, bool full)
{
    RenderOptions options;
    options.width = full ? 300 : 60;
    options.height = full ? 200 : 40;
    options.spp = full ? 64 : 8;
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    const Image image = render(loaded, options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double processor = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
    double evaluations = 0.0;
    for (const float cost : image.find("cost.Y")->pixels) evaluations += cost;
    options.spp = full ? 16 : 4;
    options.threads = 1;
    return {{"seconds_a_frame", seconds},
            {"processor_seconds_a_frame", processor},
            {"build_seconds", loaded.build_seconds},
            {"samples_a_processor_second", static_cast<double>(*options.width) * *options.height * (full ? 64 : 8) / processor},
            {"evaluations_a_path", evaluations / static_cast<double>(image.find("cost.Y")->pixels.size())},
            {"shares", profile([&] { render(loaded, options); }, part_of)}};
}

struct Rays {
    std::vector<Ray> primary, diffuse, shadow;
};

/// Camera rays that end near the eye, and from there one into the air about the normal and one to the sun.
Rays rays_of(const Scene& scene, const Tracer& tracer, double within, const Vec3d& sun, int side)
{
    Rays rays;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const Ray ray = scene.camera().ray(Vec2d(x + 0.5, y + 0.5), Vec2i(side, side), 0.0);
            const TraceHit hit = tracer.intersect(ray);
            if (!hit.valid || hit.t > within) continue;
            rays.primary.push_back(ray);
            const Interaction at = tracer.interact(ray, hit);
            if (at.geometric_normal.dot(ray.direction) > 0.0) continue;
            Numbers random(5, static_cast<std::uint64_t>(y * side + x));
            Ray next;
            next.origin = at.position + at.geometric_normal * std::max(at.spawn_offset, 1e-3);
            next.direction = (at.geometric_normal + random.direction() * 0.999).normalized();
            next.crossing = Crossing::entering;
            next.t_max = 60.0;
            rays.diffuse.push_back(next);
            next.direction = sun;
            rays.shadow.push_back(next);
        }
    }
    return rays;
}

nlohmann::json rates(const Rays& rays, const Tracer& wave, const Tracer& mesh)
{
    std::vector<Task> tasks;
    const auto add = [&](const std::string& group, const std::vector<Ray>& of, bool shadow) {
        for (const auto& [name, tracer] : {std::pair<std::string, const Tracer*>{"wave", &wave}, {"mesh", &mesh}}) {
            tasks.push_back({group, name, of.size(), [&of, tracer = tracer, shadow] {
                                 for (const Ray& ray : of) {
                                     if (shadow)
                                         benchmark_keep(tracer->occluded(ray));
                                     else
                                         benchmark_keep(tracer->intersect(ray).t);
                                 }
                             }});
        }
    };
    add("primary", rays.primary, false);
    add("diffuse", rays.diffuse, false);
    add("shadow", rays.shadow, true);
    const std::map<std::string, double> measured = measure(tasks, 3, 0.1);
    nlohmann::json report;
    for (const auto& [group, of] : {std::pair<std::string, const std::vector<Ray>*>{"primary", &rays.primary}, {"diffuse", &rays.diffuse}}) {
        double evaluations = 0.0, wrong = 0.0;
        for (const Ray& ray : *of) {
            const TraceHit a = wave.intersect(ray), b = mesh.intersect(ray);
            evaluations += a.evaluations;
            wrong += a.valid != b.valid || (a.valid && std::abs(a.t - b.t) > 0.02);
        }
        report[group]["evaluations_a_ray"] = evaluations / static_cast<double>(of->size());
        report[group]["mesh_differs"] = wrong / static_cast<double>(of->size());
        report[group]["rays"] = of->size();
    }
    for (const std::string group : {"primary", "diffuse", "shadow"}) {
        const double w = measured.at(group + "/wave"), m = measured.at(group + "/mesh");
        report[group]["wave_mrays"] = w / 1e6;
        report[group]["mesh_mrays"] = m / 1e6;
        report[group]["wave_over_mesh"] = w / m;
    }
    return report;
}

}  // namespace

nlohmann::json wave_benchmark(bool full)
{
    const LoadedScene loaded = load_scene("scenes/breaking_wave.toml", false);
    nlohmann::json report;
    report["frame"] = frame_facts(loaded, full);
    std::printf("frame    %s\n", report["frame"].dump().c_str());

    const std::vector<Shape>& shapes = loaded.scene->shapes();
    const Surface* sea = nullptr;
    for (const Shape& shape : shapes) {
        const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape);
        if (surface && (*surface)->density()) sea = surface->get();
    }
    const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const double within = 50.0, beyond = within + 20.0;
    PolygoniseOptions options;
    options.spacing = full ? 0.1 : 0.5;
    const Vec3d eye = loaded.scene->camera().eye();
    options.region = Box3d(eye - Vec3d(beyond, beyond, 20.0), eye + Vec3d(beyond, beyond, 20.0));
    std::vector<Shape> meshed;
    TriangleMesh mesh;
    mesh.material = "water";
    mesh.origin = eye;
    auto start = std::chrono::steady_clock::now();
    polygonise(*sea->field(), options, [&](const MeshPart& part) {
        for (const Vec3d& v : part.vertices) mesh.vertices.emplace_back(v - eye);
        mesh.triangles.insert(mesh.triangles.end(), part.triangles.begin(), part.triangles.end());
    });
    report["mesh"] = {{"triangles", mesh.triangles.size()}, {"spacing", options.spacing}, {"meshing_seconds", seconds_since(start)}};
    report["mesh"]["bytes"] = mesh_bytes(mesh);
    meshed.emplace_back(std::move(mesh));
    start = std::chrono::steady_clock::now();
    const auto triangles = make_embree_tracer(meshed);
    report["mesh"]["embree_build_seconds"] = seconds_since(start);
    start = std::chrono::steady_clock::now();
    const auto wave = make_embree_tracer(shapes);
    const SurfaceInfo info = sea->info();
    report["wave"] = {{"patches", info.patches},
                      {"bytes", info.trace_bytes},
                      {"patches_seconds", info.build_seconds},
                      {"embree_build_seconds", seconds_since(start)}};

    const Vec3d sun = Vec3d(0.74, 0.62, 0.25).normalized();
    report["rays"] = rates(rays_of(*loaded.scene, *wave, within, sun, full ? 256 : 48), *wave, *triangles);
    for (const char* part : {"mesh", "wave", "rays"}) std::printf("%-8s %s\n", part, report[part].dump().c_str());
    return report;
}

}  // namespace hoodoo::bench
