// Embree alone, without a wrapper: the baseline of what rays cost; its memory; and the rays that benchmarks send.
#pragma once

#include "terrain/isa.h"
#include "terrain/math/hash.h"
#include "terrain/shape.h"
#include "tests/support/terrains.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <vector>

namespace hoodoo::bench
{

inline double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Embree alone, counting the memory it takes.
class Device
{
public:
    Device() : device_(rtcNewDevice(embree_isa_option(selected_isa()))) { rtcSetDeviceMemoryMonitorFunction(device_, count, &bytes_); }
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
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* v =
            static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.vertices.size()));
        std::copy(mesh.vertices.begin(), mesh.vertices.end(), v);
        auto* t = static_cast<std::array<std::uint32_t, 3>*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), t);
        attach(geometry);
        build_seconds = seconds_since(start);
    }
    /// Embree's geometry for nodes in rows: width x height of them, two triangles a cell.
    BareMesh(const std::vector<Vec3f>& nodes, int width, int height)
    {
        const auto start = std::chrono::steady_clock::now();
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_GRID);
        auto* v = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), nodes.size()));
        std::copy(nodes.begin(), nodes.end(), v);
        auto* grid = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
        *grid = {0, static_cast<unsigned>(width), static_cast<unsigned short>(width), static_cast<unsigned short>(height)};
        attach(geometry);
        build_seconds = seconds_since(start);
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
    void attach(RTCGeometry geometry)
    {
        scene_ = rtcNewScene(device_.get());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        // The nodes are Embree's own buffers here, so its monitor counts them.
        megabytes = device_.megabytes();
    }
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

inline std::vector<Ray> camera_rays(const testing::View& view, int size)
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

/// Embree's memory for a set of boxes, measured on a device of its own.
inline double bvh_megabytes(const Surface& surface)
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

}  // namespace hoodoo::bench
