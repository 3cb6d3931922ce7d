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
#include "tests/bench/polygonise.h"
#include "tests/bench/report.h"
#include "tests/support/terrains.h"

#include <embree3/rtcore.h>

#include <chrono>
#include <cstdio>

namespace hoodoo::bench
{
namespace
{

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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

/// Embree alone, counting the memory it takes.
class Device
{
public:
    Device() : device_(rtcNewDevice(nullptr)) { rtcSetDeviceMemoryMonitorFunction(device_, count, &bytes_); }
    ~Device() { rtcReleaseDevice(device_); }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    RTCDevice get() const { return device_; }
    double megabytes() const { return static_cast<double>(bytes_.load()) / 1e6; }

private:
    static bool count(void* bytes, ssize_t change, bool)
    {
        static_cast<std::atomic<std::int64_t>*>(bytes)->fetch_add(change);
        return true;
    }
    std::atomic<std::int64_t> bytes_{0};
    RTCDevice device_;
};

/// The baseline: a mesh in Embree, nothing around it.
class BareMesh
{
public:
    explicit BareMesh(const TriangleMesh& mesh)
    {
        const auto start = std::chrono::steady_clock::now();
        scene_ = rtcNewScene(device_.get());
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* v =
            static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.vertices.size()));
        std::copy(mesh.vertices.begin(), mesh.vertices.end(), v);
        auto* t = static_cast<std::array<std::uint32_t, 3>*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), t);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        build_seconds = seconds_since(start);
        // Vertices and triangles are Embree's own buffers here, so its monitor counts them.
        megabytes = device_.megabytes();
    }
    ~BareMesh() { rtcReleaseScene(scene_); }
    BareMesh(const BareMesh&) = delete;
    BareMesh& operator=(const BareMesh&) = delete;

    double intersect(const Ray& ray, Vec3d* normal = nullptr) const
    {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query;
        fill(ray, query.ray);
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kInfinity;
        if (normal) *normal = Vec3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
        return query.ray.tfar;
    }
    bool occluded(const Ray& ray) const
    {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay query;
        fill(ray, query);
        rtcOccluded1(scene_, &context, &query);
        return query.tfar < 0.0f;
    }

    double build_seconds = 0.0, megabytes = 0.0;

private:
    static void fill(const Ray& ray, RTCRay& out)
    {
        out.org_x = static_cast<float>(ray.origin.x), out.org_y = static_cast<float>(ray.origin.y), out.org_z = static_cast<float>(ray.origin.z);
        out.dir_x = static_cast<float>(ray.direction.x), out.dir_y = static_cast<float>(ray.direction.y),
        out.dir_z = static_cast<float>(ray.direction.z);
        out.tnear = 0.0f, out.tfar = std::numeric_limits<float>::infinity(), out.time = 0.0f;
        out.mask = 0xffffffffu, out.id = 0, out.flags = 0;
    }
    Device device_;
    RTCScene scene_ = nullptr;
};

/// The rays of one method from one view.
struct RaySets {
    std::vector<Ray> primary, diffuse, shadow;
};

std::vector<Ray> camera_rays(const testing::View& view, int size)
{
    const Vec3d forward = (view.target - view.eye).normalized(), right = forward.cross(Vec3d(0, 0, 1)).normalized(), up = right.cross(forward);
    std::vector<Ray> rays;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            Ray ray;
            ray.origin = view.eye;
            ray.direction =
                (forward + right * ((x + 0.5) * 2.0 / size - 1.0) * view.half_width + up * (1.0 - (y + 0.5) * 2.0 / size) * view.half_width)
                    .normalized();
            ray.crossing = Crossing::entering;
            rays.push_back(ray);
        }
    }
    return rays;
}

/// `hit(ray, position, normal)` answers for one method; secondary rays start a hundredth of a cell above what it found.
template <class Hit>
RaySets ray_sets(const testing::View& view, int size, const Hit& hit)
{
    RaySets sets;
    sets.primary = camera_rays(view, size);
    const Vec3d sun = Vec3d(0.5, 0.3, 0.6).normalized();
    for (std::size_t i = 0; i < sets.primary.size(); ++i) {
        Vec3d p, n;
        if (!hit(sets.primary[i], p, n)) continue;
        if (n.dot(sets.primary[i].direction) > 0.0) n = -n;
        Ray ray;
        ray.crossing = Crossing::entering;
        ray.origin = p + n * 0.01;
        Vec3d a, b;
        orthonormal_frame(n, a, b);
        const double phi = 2.0 * M_PI * unit_real(hash_cell(1, static_cast<std::int64_t>(i), 0)),
                     r = unit_real(hash_cell(1, static_cast<std::int64_t>(i), 1));
        ray.direction = (a * std::cos(phi) * std::sqrt(r) + b * std::sin(phi) * std::sqrt(r) + n * std::sqrt(1.0 - r)).normalized();
        sets.diffuse.push_back(ray);
        if (n.dot(sun) <= 0.0) continue;
        ray.direction = sun;
        sets.shadow.push_back(ray);
    }
    return sets;
}

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

/// Embree's memory for a set of boxes, measured on a device of its own.
double bvh_megabytes(const Surface& surface)
{
    Device device;
    const RTCScene scene = rtcNewScene(device.get());
    struct Part {
        const Surface* surface;
        std::uint32_t tile;
    };
    std::vector<Part> parts;
    parts.reserve(surface.tile_count());
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile) {
        if (!surface.patch_count(tile)) continue;
        parts.push_back({&surface, tile});
        const RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, surface.patch_count(tile));
        rtcSetGeometryUserData(geometry, &parts.back());
        rtcSetGeometryBoundsFunction(
            geometry,
            [](const RTCBoundsFunctionArguments* a) {
                const Part& part = *static_cast<const Part*>(a->geometryUserPtr);
                const Box3d b = part.surface->patch_bounds({part.tile, a->primID});
                *a->bounds_o = {static_cast<float>(b.min.x), static_cast<float>(b.min.y), static_cast<float>(b.min.z), 0.0f,
                                static_cast<float>(b.max.x), static_cast<float>(b.max.y), static_cast<float>(b.max.z), 0.0f};
            },
            nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    const double megabytes = device.megabytes();
    rtcReleaseScene(scene);
    return megabytes;
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
