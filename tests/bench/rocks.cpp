// Beds of 10^3 to 10^6 rocks that fill the same picture, traced three ways: by the product (one user geometry, a primitive an instance, transforms in
// double precision), by Embree's own instances (one geometry object each), and, as the unit of time, the product with a thousand rocks.
//
// Detail goes by distance, as in scenes, or is full.
// Memory is the growth of the process while the structure is built, meshes included. Shape: axes a >= b >= c are caliper extents; the sphericity is
// Wadell's, surface of the ball of equal volume over surface. Beside them stand those of broken rock: fragments of basalt and boulders of 0.1 to 150
// m scatter around b/a = 0.7 and c/a = 0.5, a : b : c = 2 : sqrt 2 : 1 (Michikami2016, 12,700 fragments; Michikami2010, boulders). Sphericities of
// bodies with these axes lie between the box's and the ellipsoid's. Of frost-shattered debris a large share of clasts has c/a <= 0.4 (the index C40,
// Benn1994; no figure for it was at hand). Rocks of a tile are more equant: cells of an even Poisson distribution; rock_shape flattens them, and the
// row "flat" has a shape that comes near.

#include "tests/bench/rocks.h"

#include "renderer/geometry/instance.h"
#include "renderer/geometry/tracer.h"
#include "renderer/scene/read.h"
#include "renderer/scene/terrain.h"
#include "terrain/math/hash.h"
#include "terrain/rocks/rock_mesh.h"
#include "terrain/rocks/stack_rocks.h"
#include "terrain/surfaces/rock_source.h"
#include "tests/bench/report.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>
#include <unistd.h>

namespace hoodoo::bench
{
namespace
{

constexpr int kWidth = 512;  // of the pictures, pixels

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double resident_megabytes()
{
    std::size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

/// A bed of rocks: its top is seen, the rest culled.
class Bed final : public RockVolume
{
public:
    explicit Bed(const Vec3d& size) : size_(size) {}
    Box3d bounds() const override { return {Vec3d(0.0), size_}; }
    Interval heights(const Vec2d&, const Vec2d&) const override { return {0.0, size_.z}; }
    bool holds(const Vec3d& p) const override { return bounds().intersects(p); }
    bool air_within(const Vec3d& p, double distance) const override { return size_.z - p.z < distance; }
    bool ground(const Vec3d& p) const override { return p.z < 0.0; }

private:
    Vec3d size_;
};

/// The pixels of a square picture that the bed fills, row by row, all in one direction: the same coverage whatever its size. Or the same rays in
/// random order, as after many scatterings. Origins lie 3 m before the bed's top.
std::vector<Ray> rays_onto(const Vec3d& size, int width, double down, bool shuffled)
{
    std::vector<Ray> rays(static_cast<std::size_t>(width * width));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::size_t pixel = shuffled ? hash_cell(7, static_cast<std::int64_t>(i), 0) % rays.size() : i;
        const double u = (static_cast<double>(pixel % static_cast<std::size_t>(width)) + 0.5) / width;
        const double v = (static_cast<double>(pixel / static_cast<std::size_t>(width)) + 0.5) / width;
        const Vec3d target(size.x * (0.1 + 0.8 * u), size.y * (0.1 + 0.8 * v), size.z);
        rays[i].direction = Vec3d(0.6 * std::sqrt(1.0 - down * down), 0.8 * std::sqrt(1.0 - down * down), -down);
        rays[i].origin = target - rays[i].direction * 3.0;
    }
    return rays;
}

/// Embree's instances of the same meshes, one geometry object each.
class EmbreeOwn
{
public:
    explicit EmbreeOwn(const Instances& rocks)
    {
        device_ = rtcNewDevice("threads=2");
        for (const TriangleMesh& mesh : rocks.meshes) {
            const RTCScene scene = rtcNewScene(device_);
            rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
            const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
            auto* v = static_cast<Vec3f*>(
                rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.vertices.size()));
            std::copy(mesh.vertices.begin(), mesh.vertices.end(), v);
            auto* t = static_cast<std::array<std::uint32_t, 3>*>(
                rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
            std::copy(mesh.triangles.begin(), mesh.triangles.end(), t);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            meshes_.push_back(scene);
        }
        scene_ = rtcNewScene(device_);
        for (const Instance& rock : rocks.instances) {
            const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(geometry, meshes_[rock.mesh]);
            const float transform[12] = {1,
                                         0,
                                         0,
                                         0,
                                         1,
                                         0,
                                         0,
                                         0,
                                         1,
                                         static_cast<float>(rock.position.x),
                                         static_cast<float>(rock.position.y),
                                         static_cast<float>(rock.position.z)};
            rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene_, geometry);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(scene_);
    }
    ~EmbreeOwn()
    {
        rtcReleaseScene(scene_);
        for (const RTCScene scene : meshes_) rtcReleaseScene(scene);
        rtcReleaseDevice(device_);
    }
    EmbreeOwn(const EmbreeOwn&) = delete;
    EmbreeOwn& operator=(const EmbreeOwn&) = delete;

    float intersect(const Ray& ray) const
    {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit hit{};
        hit.ray.org_x = static_cast<float>(ray.origin.x), hit.ray.org_y = static_cast<float>(ray.origin.y),
        hit.ray.org_z = static_cast<float>(ray.origin.z);
        hit.ray.dir_x = static_cast<float>(ray.direction.x), hit.ray.dir_y = static_cast<float>(ray.direction.y),
        hit.ray.dir_z = static_cast<float>(ray.direction.z);
        hit.ray.tfar = std::numeric_limits<float>::infinity();
        hit.ray.mask = 0xffffffffu;
        hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &hit);
        return hit.ray.tfar;
    }

private:
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::vector<RTCScene> meshes_;
};

struct Measured {
    std::size_t rocks = 0;
    std::unique_ptr<std::vector<Shape>> shapes;
    std::unique_ptr<Tracer> tracer;
    std::unique_ptr<EmbreeOwn> own;
    std::map<std::string, std::vector<Ray>> rays;
    nlohmann::json facts;
};

Measured build(std::size_t wanted, bool by_distance)
{
    // 0.905 m3 a rock and about 1.9 m of depth that is seen.
    const double side = std::sqrt(static_cast<double>(wanted) * 0.905 / 1.86);
    RockOptions options;
    options.size = 1.2;
    options.level = 1;
    // Far away and up: the pictures' pixels are as wide everywhere.
    if (by_distance) options.view = RockView{Vec3d(0.0, 0.0, 1e6), 0.8 * side / kWidth / 1e6};
    const Bed bed({side, side, 4.0});
    Measured m;
    m.facts["detail"] = by_distance ? "by_distance" : "full";
    auto start = std::chrono::steady_clock::now();
    Instances rocks = place_rocks(options, bed, Vec3d(0.0));
    m.facts["placement_seconds"] = seconds_since(start);
    m.facts["tile_seconds"] = rocks.rocks.tile_seconds;
    m.rocks = rocks.instances.size();
    m.facts["rocks"] = m.rocks;
    m.facts["list_megabytes"] = static_cast<double>(m.rocks * sizeof(Instance)) / 1e6;
    m.shapes = std::make_unique<std::vector<Shape>>();
    m.shapes->emplace_back(std::move(rocks));
    double before = resident_megabytes();
    start = std::chrono::steady_clock::now();
    m.tracer = make_embree_tracer(*m.shapes);
    m.facts["user_geometry_seconds"] = seconds_since(start);
    m.facts["user_geometry_megabytes"] = resident_megabytes() - before;
    if (!by_distance) {
        before = resident_megabytes();
        start = std::chrono::steady_clock::now();
        m.own = std::make_unique<EmbreeOwn>(std::get<Instances>((*m.shapes)[0]));
        m.facts["embree_instances_seconds"] = seconds_since(start);
        m.facts["embree_instances_megabytes"] = resident_megabytes() - before;
    }
    m.rays["steep"] = rays_onto(bed.bounds().max, kWidth, 0.8, false);
    m.rays["grazing"] = rays_onto(bed.bounds().max, kWidth, 0.2, false);
    m.rays["random_order"] = rays_onto(bed.bounds().max, kWidth, 0.8, true);
    return m;
}

/// Three extents across each other, as a caliper finds them: the longest of all, the longest across it, the third.
Vec3d axes_of(const TriangleMesh& mesh)
{
    // The longest extent over many directions, then the longest across it: how a caliper is used.
    const auto extent = [&](const Vec3d& d) {
        double lo = kInfinity, hi = -kInfinity;
        for (const Vec3f& v : mesh.vertices) {
            const double x = Vec3d(v).dot(d);
            lo = std::min(lo, x), hi = std::max(hi, x);
        }
        return hi - lo;
    };
    Vec3d longest(0.0, 0.0, 1.0);
    double a = 0.0;
    for (int k = 0; k < 2000; ++k) {
        const double z = 1.0 - (k + 0.5) / 1000.0, angle = 2.399963 * k, r = std::sqrt(std::max(0.0, 1.0 - z * z));
        const Vec3d d(r * std::cos(angle), r * std::sin(angle), z);
        if (extent(d) > a) a = extent(d), longest = d;
    }
    Vec3d u, v;
    orthonormal_frame(longest, u, v);
    double b = 0.0, c = 0.0;
    for (int k = 0; k < 180; ++k) {
        const double angle = M_PI * k / 180.0;
        const double e = extent(u * std::cos(angle) + v * std::sin(angle));
        if (e > b) b = e, c = extent(v * std::cos(angle) - u * std::sin(angle));
    }
    return {a, b, c};
}

/// Wadell's sphericity of an ellipsoid (Thomsen's formula for its surface, within 1.1%) and of a box with these axes.
std::array<double, 2> sphericity_bounds(double b, double c)
{
    constexpr double p = 1.6075;
    const double surface = 4.0 * M_PI * std::pow((std::pow(b, p) + std::pow(c, p) + std::pow(b * c, p)) / 3.0, 1.0 / p);
    const double ellipsoid = 4.0 * M_PI * std::pow(b * c, 2.0 / 3.0) / surface;
    const double box = std::cbrt(36.0 * M_PI * b * b * c * c) / (2.0 * (b + c + b * c));
    return {box, ellipsoid};
}

nlohmann::json shape_of(const std::string& name, const RockOptions& options)
{
    std::vector<double> sphericity, middle, flat;
    for (const Rock& rock : make_tile(options)) {
        double volume = 0.0, area = 0.0;
        for (const auto& t : rock.mesh.triangles) {
            const Vec3d a(rock.mesh.vertices[t[0]]), b(rock.mesh.vertices[t[1]]), c(rock.mesh.vertices[t[2]]);
            volume += a.dot(b.cross(c)) / 6.0;
            area += 0.5 * (b - a).cross(c - a).length();
        }
        sphericity.push_back(std::cbrt(M_PI) * std::pow(6.0 * volume, 2.0 / 3.0) / area);
        const Vec3d axes = axes_of(rock.mesh);
        middle.push_back(axes.y / axes.x), flat.push_back(axes.z / axes.x);
    }
    const auto mean = [](const std::vector<double>& x) { return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size()); };
    const double c40 =
        static_cast<double>(std::count_if(flat.begin(), flat.end(), [](double x) { return x <= 0.4; })) / static_cast<double>(flat.size());
    std::printf("%-38s %10.2f %5.2f %5.2f %6.0f%%\n", name.c_str(), mean(sphericity), mean(middle), mean(flat), 100.0 * c40);
    return {{"sphericity", mean(sphericity)}, {"b_over_a", mean(middle)}, {"c_over_a", mean(flat)}, {"share_c_over_a_under_0.4", c40}};
}

nlohmann::json shape_statistics(bool full)
{
    RockOptions options;
    options.per_tile = full ? 70 : 20;
    options.level = 1;
    options.roughness = 0.08;
    RockOptions flat = options;
    flat.shape = Vec3d(1.0, 0.75, 0.5);
    std::printf("%-38s %10s %5s %5s %7s\n", "shape", "sphericity", "b/a", "c/a", "C40");
    nlohmann::json out = {{"tile", shape_of("tile, rock_shape = [1, 1, 1]", options)}, {"flat", shape_of("tile, rock_shape = [1, 0.75, 0.5]", flat)}};
    const auto [box, ellipsoid] = sphericity_bounds(M_SQRT1_2, 0.5);
    std::printf("%-38s  %.2f-%.2f  0.7   0.5\n", "broken rock (Michikami 2010, 2016)", box, ellipsoid);
    out["broken_rock"] = {{"sphericity", {box, ellipsoid}}, {"b_over_a", 0.7}, {"c_over_a", 0.5}, {"source", "Michikami2010, Michikami2016"}};
    return out;
}

std::string group_of(const std::string& set, const Measured& m)
{
    return set + "/" + std::to_string(m.rocks) + "/" + m.facts["detail"].get<std::string>();
}

/// The rubble of scenes/canyon.toml, placed again and again: the quickest, and the processor time of all threads.
nlohmann::json instancing()
{
    const Description description = read_scene(HOODOO_SOURCE_DIR "/scenes/canyon.toml", false);
    const DescribedNode& node = choose_terrain(description, {});
    const BuildContext context = terrain_context(node, description, 0, {});
    const auto stack = terrain_row(node).stack(node.values, context);
    RockOptions options = rock_options(node.values, context, stack->cell());
    options.level = kRockLevels - 1;  // meshes do not count here
    double wall = 1e9, processor = 1e9;
    std::size_t rocks = 0;
    for (int k = 0; k < 40; ++k) {
        auto start = std::chrono::steady_clock::now();
        auto clock = std::clock();
        const auto volume = std::make_shared<StackRocks>(stack, Border::extend);
        double seconds = seconds_since(start), spent = static_cast<double>(std::clock() - clock);
        RockPlacement placement(options, volume, stack->origin());
        start = std::chrono::steady_clock::now();
        clock = std::clock();
        rocks = placement.place().instances.size();
        seconds += seconds_since(start), spent += static_cast<double>(std::clock() - clock);
        wall = std::min(wall, seconds), processor = std::min(processor, spent / CLOCKS_PER_SEC);
    }
    std::printf("%zu rocks of a canyon placed in %.1f ms (%.1f ms of the processor)\n", rocks, 1e3 * wall, 1e3 * processor);
    return {{"rocks", rocks}, {"milliseconds", 1e3 * wall}, {"processor_milliseconds", 1e3 * processor}};
}

}  // namespace

nlohmann::json rocks_benchmark(bool full)
{
    nlohmann::json report;
    report["shape"] = shape_statistics(full);
    report["instancing"] = instancing();
    {
        RockOptions options;
        options.per_tile = 70;
        options.roughness = 0.08;
        const auto start = std::chrono::steady_clock::now();
        benchmark_keep(make_tile(options).size());
        report["tile_of_70_seconds"] = seconds_since(start);
    }
    std::vector<Measured> sizes;
    for (const std::size_t wanted : full ? std::vector<std::size_t>{1000, 10000, 100000, 1000000} : std::vector<std::size_t>{1000, 10000})
        for (const bool by_distance : {true, false}) sizes.push_back(build(wanted, by_distance));
    std::vector<Task> tasks;
    for (const Measured& m : sizes) {
        for (const auto& [set, all] : m.rays) {
            const std::vector<Ray>& rays = all;
            const std::string group = group_of(set, m);
            tasks.push_back({group, "user_geometry", rays.size(), [&m, &rays] {
                                 for (const Ray& ray : rays) benchmark_keep(m.tracer->intersect(ray).t);
                             }});
            if (!m.own) continue;
            tasks.push_back({group, "embree_instances", rays.size(), [&m, &rays] {
                                 for (const Ray& ray : rays) benchmark_keep(m.own->intersect(ray));
                             }});
        }
    }
    const auto rates = measure(tasks);
    for (Measured& m : sizes) {
        const auto smallest = std::find_if(sizes.begin(), sizes.end(), [&](const Measured& s) { return s.facts["detail"] == m.facts["detail"]; });
        for (const auto& [set, rays] : m.rays) {
            for (const char* method : {"user_geometry", "embree_instances"}) {
                if (!m.own && method == std::string("embree_instances")) continue;
                const double rate = rates.at(group_of(set, m) + "/" + method), first = rates.at(group_of(set, *smallest) + "/" + method);
                m.facts[set][method] = {{"rays_per_second", rate}, {"time_over_smallest", first / rate}};
            }
        }
        std::printf("%8zu rocks %s\n", m.rocks, m.facts.dump().c_str());
        report["sizes"].push_back(m.facts);
    }
    return report;
}

}  // namespace hoodoo::bench
