// Embree behind the Tracer interface: bounds, intersect and occluded, written once for every Surface; triangles are Embree's own.
//
// Embree works in single precision. Three measures make it lose no hit (tests/laws prove it at 4000 km from the origin):
//   the world is moved so that the centre of the scene is Embree's origin;
//   a ray that starts outside the scene is advanced to the scene's box in double precision before it is rounded;
//   every box is padded by 4 units in the last place of the largest number that enters its slab test.
// The callbacks then work on the caller's ray in double precision, not on Embree's copy.
// One instance level and no motion are needed so far, so none is used.
// For edits each tile has a tree of its own under one over all (Embree's scenes of low build quality): what an edit does not touch is not built
// again.

#include "renderer/geometry/tracer.h"
#include "terrain/error.h"
#include "terrain/isa.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hoodoo
{
namespace
{

/// What the callbacks of one Embree geometry need: one tile of one surface.
struct Part {
    const Surface* surface = nullptr;  ///< nullptr: a triangle mesh
    std::uint32_t object = 0;
    std::uint32_t tile = 0;
    Vec3d world_origin{0.0};
    double padding = 0.0;
};

/// Travels with one query through Embree to the callbacks.
struct Query {
    RTCIntersectContext embree;  // must come first: Embree hands back a pointer to it
    const Ray* ray = nullptr;
    double shift = 0.0;  ///< Embree's ray starts this far along the caller's ray
    Hit hit;
    std::uint32_t object = 0;
};

// Outwards by one unit in the last place at least, without a call; the smallest normal number stands in for zero's neighbours.
float round_up(double x)
{
    const auto f = static_cast<float>(x);
    return f + std::abs(f) * 0x1p-23f + std::numeric_limits<float>::min();
}
float round_down(double x)
{
    const auto f = static_cast<float>(x);
    return f - std::abs(f) * 0x1p-23f - std::numeric_limits<float>::min();
}

void part_bounds(const RTCBoundsFunctionArguments* args)
{
    const Part& part = *static_cast<const Part*>(args->geometryUserPtr);
    const Box3d box = part.surface->patch_bounds({part.tile, args->primID});
    const Vec3d lo = box.min - part.world_origin - Vec3d(part.padding);
    const Vec3d hi = box.max - part.world_origin + Vec3d(part.padding);
    RTCBounds& out = *args->bounds_o;
    out.lower_x = round_down(lo.x), out.lower_y = round_down(lo.y), out.lower_z = round_down(lo.z);
    out.upper_x = round_up(hi.x), out.upper_y = round_up(hi.y), out.upper_z = round_up(hi.z);
}

void part_intersect(const RTCIntersectFunctionNArguments* args)
{
    const Part& part = *static_cast<const Part*>(args->geometryUserPtr);
    Query& query = *reinterpret_cast<Query*>(args->context);
    RTCRayHit& rayhit = *reinterpret_cast<RTCRayHit*>(args->rayhit);

    // A triangle may have been found meanwhile, of which only Embree knows.
    Hit hit = query.hit;
    hit.t = std::min(hit.t, query.shift + static_cast<double>(rayhit.ray.tfar));
    const bool found = part.surface->intersect({part.tile, args->primID}, *query.ray, hit);
    query.hit.evaluations = hit.evaluations;
    if (!found) return;
    query.hit = hit;
    query.object = part.object;
    rayhit.ray.tfar = std::min(rayhit.ray.tfar, round_up(hit.t - query.shift));
    rayhit.hit.geomID = args->geomID;
    rayhit.hit.primID = args->primID;
}

void part_occluded(const RTCOccludedFunctionNArguments* args)
{
    const Part& part = *static_cast<const Part*>(args->geometryUserPtr);
    const Query& query = *reinterpret_cast<const Query*>(args->context);
    if (part.surface->occluded({part.tile, args->primID}, *query.ray)) {
        reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
    }
}

void check(RTCDevice device)
{
    const RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return;
    if (code == RTC_ERROR_OUT_OF_MEMORY) throw Error(ErrorKind::memory, "out of memory while building the acceleration structure");
    throw Error(ErrorKind::internal, "Embree reports error " + std::to_string(static_cast<int>(code)));
}

Box3d mesh_bounds(const TriangleMesh& mesh)
{
    Box3d box;
    for (const Vec3f& v : mesh.vertices) box.extendBy(mesh.origin + Vec3d(v));
    return box;
}

class EmbreeTracer final : public Tracer
{
public:
    EmbreeTracer(std::span<const Shape> shapes, const TracerOptions& options) : Tracer(shapes), options_(options)
    {
        device_ = rtcNewDevice(embree_isa_option(selected_isa()));
        if (!device_) throw Error(ErrorKind::internal, "Embree gives no device");
        build();
    }
    ~EmbreeTracer() override { release(); }
    EmbreeTracer(const EmbreeTracer&) = delete;
    EmbreeTracer& operator=(const EmbreeTracer&) = delete;

    void update(std::uint32_t object, std::span<const std::uint32_t> tiles) override
    {
        if (!options_.editable) throw Error(ErrorKind::internal, "this tracer was not made for edits");
        const Surface& surface = *std::get<std::unique_ptr<Surface>>(shapes_[object]);
        bool fits = true;
        // The slack that find_bounds added stays free, but for rounding.
        const Vec3d inside = half_extent_ - Vec3d(3.5 * padding_);
        const Box3d inner(world_origin_ - inside, world_origin_ + inside);
        for (const std::uint32_t tile : tiles) {
            for (std::uint32_t i = 0; fits && i < surface.patch_count(tile); ++i) {
                const Box3d box = surface.patch_bounds({tile, i});
                fits = inner.intersects(box.min) && inner.intersects(box.max);
            }
        }
        if (!fits) {
            // Another origin or padding moves every box.
            rtcReleaseScene(scene_);
            scene_ = nullptr;
            return build();
        }
        for (const std::uint32_t tile : tiles) {
            const RTCGeometry geometry = rtcGetGeometry(scene_, first_part_[object] + tile);
            rtcSetGeometryUserPrimitiveCount(geometry, surface.patch_count(tile));
            rtcCommitGeometry(geometry);
        }
        check(device_);
        rtcJoinCommitScene(scene_);
        check(device_);
    }

protected:
    TraceHit find_nearest(const Ray& ray) const override
    {
        TraceHit result;
        Query query;
        RTCRayHit rayhit;
        if (!prepare(ray, query, rayhit.ray)) return result;
        rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &query.embree, &rayhit);
        result.evaluations = query.hit.evaluations;
        if (rayhit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
        result.valid = true;
        const Part& part = parts_[rayhit.hit.geomID];
        if (part.surface) {
            result.t = query.hit.t;
            result.object = query.object;
            result.patch = query.hit.patch;
        } else {
            result.t = query.shift + static_cast<double>(rayhit.ray.tfar);
            result.object = part.object;
            result.patch = {0, rayhit.hit.primID};
            result.barycentric = Vec2d(rayhit.hit.u, rayhit.hit.v);
        }
        return result;
    }

    bool find_any(const Ray& ray) const override
    {
        Query query;
        RTCRay embree_ray;
        if (!prepare(ray, query, embree_ray)) return false;
        rtcOccluded1(scene_, &query.embree, &embree_ray);
        return embree_ray.tfar < 0.0f;
    }

    double triangle_error() const override { return padding_; }

private:
    void build()
    {
        find_bounds();
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);  // for triangles; it changes nothing for user geometry
        if (options_.editable) {
            // Embree's name for a tree over trees: each geometry keeps its own, of the quality that it has anyway.
            rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
            rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
        }
        try {
            count_parts();
            for (std::size_t i = 0; i < shapes_.size(); ++i) {
                first_part_.push_back(static_cast<std::uint32_t>(parts_.size()));
                if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[i])) {
                    add_surface(**surface, static_cast<std::uint32_t>(i));
                } else {
                    add_mesh(std::get<TriangleMesh>(shapes_[i]), static_cast<std::uint32_t>(i));
                }
            }
            check(device_);
            rtcJoinCommitScene(scene_);
            check(device_);
        } catch (...) {
            release();
            throw;
        }
    }

    bool is_inside(const Vec3d& p) const
    {
        return std::abs(p.x) <= half_extent_.x && std::abs(p.y) <= half_extent_.y && std::abs(p.z) <= half_extent_.z;
    }

    /// Moves `enter` to where the ray comes into the scene's box. False if it never does before it ends.
    bool advance_to_box(const Ray& ray, const Vec3d& origin, double& enter) const
    {
        double leave = ray.t_max;
        for (int k = 0; k < 3; ++k) {
            if (ray.direction[k] == 0.0) {
                if (std::abs(origin[k]) > half_extent_[k]) return false;
                continue;
            }
            const double inverse = 1.0 / ray.direction[k];
            const double a = (-half_extent_[k] - origin[k]) * inverse, b = (half_extent_[k] - origin[k]) * inverse;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter < leave;
    }

    /// Embree's copy of the ray. False if the ray misses the scene's box altogether.
    bool prepare(const Ray& ray, Query& query, RTCRay& out) const
    {
        const Vec3d origin = ray.origin - world_origin_;
        double enter = ray.t_min;
        // A ray that starts inside, as most do, needs no clipping.
        if (!is_inside(origin) && !advance_to_box(ray, origin, enter)) return false;

        rtcInitIntersectContext(&query.embree);
        query.ray = &ray;
        query.hit.t = ray.t_max;
        query.shift = enter > ray.t_min ? enter : 0.0;
        const Vec3d start = origin + ray.direction * query.shift;
        out.org_x = static_cast<float>(start.x), out.org_y = static_cast<float>(start.y), out.org_z = static_cast<float>(start.z);
        out.dir_x = static_cast<float>(ray.direction.x), out.dir_y = static_cast<float>(ray.direction.y),
        out.dir_z = static_cast<float>(ray.direction.z);
        out.tnear = std::max(0.0f, round_down(ray.t_min - query.shift));
        out.tfar = std::isinf(ray.t_max) ? std::numeric_limits<float>::infinity() : round_up(ray.t_max - query.shift);
        out.time = static_cast<float>(ray.time);
        out.mask = 0xffffffffu;
        out.id = 0;
        out.flags = 0;
        return true;
    }

    void find_bounds()
    {
        Box3d box = options_.room;
        for (const Shape& shape : shapes_) {
            if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape)) {
                for (std::uint32_t tile = 0; tile < (*surface)->tile_count(); ++tile)
                    for (std::uint32_t i = 0; i < (*surface)->patch_count(tile); ++i) box.extendBy((*surface)->patch_bounds({tile, i}));
            } else {
                box.extendBy(mesh_bounds(std::get<TriangleMesh>(shape)));
            }
        }
        if (box.isEmpty()) return;
        world_origin_ = box.center();
        const Vec3d half = box.size() * 0.5;
        // Numbers in a slab test are at most the scene's diagonal long; four units in the last place of that cover box, origin and direction.
        padding_ = 4.0 * 0x1p-23 * half.length();
        half_extent_ = half + Vec3d(4.0 * padding_);
    }

    void count_parts()
    {
        std::size_t count = 0;
        for (const Shape& shape : shapes_) {
            const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape);
            count += surface ? (*surface)->tile_count() : 1;
        }
        parts_.clear();
        first_part_.clear();
        parts_.reserve(count);  // Embree keeps pointers into it
    }

    void attach(RTCGeometry geometry)
    {
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(parts_.size()) - 1);
        rtcReleaseGeometry(geometry);
    }

    void add_surface(const Surface& surface, std::uint32_t object)
    {
        for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile) {
            if (surface.patch_count(tile) == 0 && !options_.editable) continue;
            parts_.push_back({&surface, object, tile, world_origin_, padding_});
            const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryUserPrimitiveCount(geometry, surface.patch_count(tile));
            rtcSetGeometryUserData(geometry, &parts_.back());
            rtcSetGeometryBoundsFunction(
                geometry, [](const RTCBoundsFunctionArguments* args) { part_bounds(args); }, nullptr);
            rtcSetGeometryIntersectFunction(geometry, part_intersect);
            rtcSetGeometryOccludedFunction(geometry, part_occluded);
            attach(geometry);
        }
    }

    void add_mesh(const TriangleMesh& mesh, std::uint32_t object)
    {
        parts_.push_back({nullptr, object, 0, world_origin_, padding_});
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                                                     std::max<std::size_t>(1, mesh.vertices.size())));
        auto* indices = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), std::max<std::size_t>(1, mesh.triangles.size())));
        check(device_);
        const Vec3d offset = mesh.origin - world_origin_;
        std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices, [&](const Vec3f& v) { return Vec3f(Vec3d(v) + offset); });
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
        attach(geometry);
    }

    void release()
    {
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
        scene_ = nullptr;
        device_ = nullptr;
    }

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    TracerOptions options_;
    std::vector<Part> parts_;                ///< by Embree's geometry number
    std::vector<std::uint32_t> first_part_;  ///< of each object
    Vec3d world_origin_{0.0};
    Vec3d half_extent_{-1.0};  ///< of the scene around world_origin_; negative: an empty scene, which every ray misses
    double padding_ = 0.0;
};

}  // namespace

std::unique_ptr<Tracer> make_embree_tracer(std::span<const Shape> shapes, const TracerOptions& options)
{
    return std::make_unique<EmbreeTracer>(shapes, options);
}

}  // namespace hoodoo
