// Primary, diffuse and shadow rays from three views of a rugged and a gentle terrain: exact cells and sphere tracing as Embree user geometry,
// beside Embree's own triangles of the same surface in three sizes. One thread, one ray at a time.
//
// Rays of the baseline go to rtcIntersect1 and rtcOccluded1 without any wrapper; rays of ours pass the whole Tracer, gate included.
// Secondary rays of a mesh start on that mesh, those of the direct methods on the surface itself.

#include "tests/bench/trace.h"

#include "renderer/geometry/tracer.h"
#include "terrain/march/exact_cells.h"
#include "terrain/march/sphere_bricks.h"
#include "terrain/math/hash.h"
#include "tests/bench/bare_embree.h"
#include "tests/bench/polygonise.h"
#include "tests/bench/report.h"
#include "tests/support/terrains.h"

#include <cstdio>

namespace hoodoo::bench
{
namespace
{

/// A patch intersector as a Surface, with the shading of none.
class BareSurface final : public Surface
{
public:
    BareSurface(const ConvolutionField& field, std::unique_ptr<PatchIntersector> patches) : field_(field), patches_(std::move(patches)) {}
    std::uint32_t tile_count() const override { return patches_->tile_count(); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return patches_->patch_count(tile); }
    Box3d patch_bounds(PatchId patch) const override { return patches_->patch_bounds(patch); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return patches_->intersect(patch, ray, hit); }
    bool occluded(PatchId patch, const Ray& ray) const override { return patches_->occluded(patch, ray); }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at;
        at.t = hit.t;
        at.position = ray.at(hit.t);
        at.geometric_normal = field_.gradient(at.position).normalized();
        return at;
    }
    bool contains(const Vec3d& p) const override { return field_.value(p) < 0.0; }
    std::vector<std::string> materials() const override { return {"bedrock"}; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.trace_bytes = patches_->memory_bytes();
        for (std::uint32_t tile = 0; tile < tile_count(); ++tile) info.patches += patch_count(tile);
        return info;
    }

private:
    const ConvolutionField& field_;
    std::unique_ptr<PatchIntersector> patches_;
};

struct Direct {
    std::vector<Shape> shapes;
    std::unique_ptr<Tracer> tracer;
    double data_seconds = 0.0, bvh_seconds = 0.0;
    SurfaceInfo info;
};

template <class Make>
Direct make_direct(const ConvolutionField& field, const Make& make)
{
    Direct d;
    auto start = std::chrono::steady_clock::now();
    auto patches = make(field);
    d.data_seconds = seconds_since(start);
    auto surface = std::make_unique<BareSurface>(field, std::move(patches));
    d.info = surface->info();
    d.shapes.emplace_back(std::move(surface));
    start = std::chrono::steady_clock::now();
    d.tracer = make_embree_tracer(d.shapes);
    d.bvh_seconds = seconds_since(start);
    return d;
}

/// Everything measured on one terrain.
nlohmann::json terrain_report(const testing::BenchTerrain& terrain, bool full)
{
    const ConvolutionField field(Ground(terrain.stack, kGround, Border::extend), 2.0 * terrain.stack->cell());
    nlohmann::json report;
    std::vector<std::pair<std::string, Direct>> directs;
    directs.emplace_back("exact", make_direct(field, make_exact_cells));
    directs.emplace_back("sphere", make_direct(field, make_sphere_bricks));
    std::vector<std::pair<std::string, std::unique_ptr<BareMesh>>> meshes;
    const auto exact = make_exact_cells(field);
    for (const double spacing : full ? std::vector<double>{2.6, 1.55, 1.0} : std::vector<double>{2.6}) {
        const auto start = std::chrono::steady_clock::now();
        const TriangleMesh mesh = polygonise(field, *exact, spacing * terrain.stack->cell());
        const double meshing = seconds_since(start);
        char name[32];
        std::snprintf(name, sizeof name, "mesh_%.2gM", static_cast<double>(mesh.triangles.size()) / 1e6);
        meshes.emplace_back(name, std::make_unique<BareMesh>(mesh));
        report["methods"][name] = {{"triangles", mesh.triangles.size()},
                                   {"meshing_seconds", meshing},
                                   {"bvh_seconds", meshes.back().second->build_seconds},
                                   {"megabytes", meshes.back().second->megabytes}};
    }
    for (const auto& [name, d] : directs) {
        const double bvh = bvh_megabytes(*std::get<std::unique_ptr<Surface>>(d.shapes[0]));
        report["methods"][name] = {{"patches", d.info.patches},    {"data_seconds", d.data_seconds},
                                   {"bvh_seconds", d.bvh_seconds}, {"data_megabytes", static_cast<double>(d.info.trace_bytes) / 1e6},
                                   {"bvh_megabytes", bvh},         {"megabytes", static_cast<double>(d.info.trace_bytes) / 1e6 + bvh}};
    }

    const int size = full ? 512 : 128;
    std::vector<Task> tasks;
    std::vector<std::unique_ptr<RaySets>> keep;
    for (const testing::View& view : terrain.views) {
        const auto add = [&](const std::string& set, const std::string& method, const std::vector<Ray>& rays, std::function<void()> work) {
            tasks.push_back({view.name + "/" + set, method, rays.size(), std::move(work)});
        };
        for (const auto& [name, d] : directs) {
            const Tracer& tracer = *d.tracer;
            keep.push_back(std::make_unique<RaySets>(ray_sets(view, size, [&](const Ray& ray, Vec3d& p, Vec3d& n) {
                const TraceHit hit = tracer.intersect(ray);
                if (!hit.valid) return false;
                p = ray.at(hit.t), n = field.gradient(p).normalized();
                return is_finite(n);
            })));
            const RaySets& s = *keep.back();
            const auto nearest = [&tracer](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) {
                    TraceHit hit = tracer.intersect(ray);
                    benchmark_keep(hit.t);
                }
            };
            add("primary", name, s.primary, [nearest, &s] { nearest(s.primary); });
            add("diffuse", name, s.diffuse, [nearest, &s] { nearest(s.diffuse); });
            add("shadow", name, s.shadow, [&tracer, &s] {
                for (const Ray& ray : s.shadow) benchmark_keep(tracer.occluded(ray));
            });
        }
        for (const auto& [name, m] : meshes) {
            const BareMesh& mesh = *m;
            keep.push_back(std::make_unique<RaySets>(ray_sets(view, size, [&](const Ray& ray, Vec3d& p, Vec3d& n) {
                const double t = mesh.intersect(ray, &n);
                p = ray.at(t);
                return t < kInfinity;
            })));
            const RaySets& s = *keep.back();
            const auto nearest = [&mesh](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) benchmark_keep(mesh.intersect(ray));
            };
            add("primary", name, s.primary, [nearest, &s] { nearest(s.primary); });
            add("diffuse", name, s.diffuse, [nearest, &s] { nearest(s.diffuse); });
            add("shadow", name, s.shadow, [&mesh, &s] {
                for (const Ray& ray : s.shadow) benchmark_keep(mesh.occluded(ray));
            });
        }
    }
    const auto rates = measure(tasks);
    for (const Task& task : tasks) report["rays_per_second"][task.group][task.method] = rates.at(task.group + "/" + task.method);
    for (auto& [group, methods] : report["rays_per_second"].items())
        for (const auto& [direct, d] : directs)
            for (const auto& [mesh, m] : meshes)
                report["ratio"][direct + " / " + mesh][group] = methods[direct].get<double>() / methods[mesh].get<double>();
    return report;
}

}  // namespace

nlohmann::json trace_benchmark(bool full)
{
    nlohmann::json report;
    for (const bool rugged : {true, false}) {
        const testing::BenchTerrain terrain = testing::bench_terrain(rugged, full ? Vec2i(1024, 768) : Vec2i(192, 160));
        nlohmann::json r = terrain_report(terrain, full);
        std::printf("%s terrain\n", rugged ? "rugged" : "gentle");
        for (const auto& [method, facts] : r["methods"].items()) std::printf("  %-12s %s\n", method.c_str(), facts.dump().c_str());
        for (const auto& [pair, groups] : r["ratio"].items()) {
            std::printf("  %-20s", pair.c_str());
            for (const auto& [group, ratio] : groups.items()) std::printf("  %s %.2f", group.c_str(), ratio.get<double>());
            std::printf("\n");
        }
        report[rugged ? "rugged" : "gentle"] = std::move(r);
    }
    return report;
}

}  // namespace hoodoo::bench
