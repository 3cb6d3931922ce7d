// Embree behind the Tracer interface: bounds, intersect and occluded, written once for every Surface; triangles are Embree's own; copies of meshes
// are in embree_instances.cpp. No file but embree*.cpp includes Embree.
//
// Embree works in single precision. Three measures make it lose no hit (tests/laws prove it at 4000 km from the origin):
//   the world is moved so that the centre of the scene is Embree's origin;
//   a ray that starts outside the scene is advanced to the scene's box in double precision before it is rounded;
//   every box is padded by 4 units in the last place of the largest number that enters its slab test.
// The callbacks then work on the caller's ray in double precision, not on Embree's copy.
// No motion is needed so far, so none is used.
// For edits each tile has a tree of its own under one over all (Embree's scenes of low build quality): what an edit does not touch is not built
// again.

#include "renderer/geometry/embree_instances.h"
#include "renderer/geometry/instance.h"
#include "terrain/error.h"
#include "terrain/isa.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hoodoo
{
namespace
{

/// What the callbacks of one Embree geometry need: one tile of one surface.
struct Part {
    const Surface* surface = nullptr;            ///< or
    const EmbreeInstances* instances = nullptr;  ///< or neither: a triangle mesh
    std::uint32_t object = 0;
    std::uint32_t tile = 0;
    Vec3d world_origin{0.0};
    double padding = 0.0;
};

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
    query.instance = kNoInstance;
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

    void update(std::uint32_t object, std::span<const std::uint32_t> tiles, InstanceChange change) override
    {
        if (!options_.editable) throw Error(ErrorKind::internal, "this tracer was not made for edits");
        const Surface& surface = *std::get<std::unique_ptr<Surface>>(shapes_[object]);
        const Instances* instances = change == InstanceChange::none ? nullptr : surface.instances();
        if (!fits(surface, tiles) || (instances && !fits(*instances))) {
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
        if (instances) {
            const std::uint32_t part = first_part_[object] + surface.tile_count();
            const auto own = std::find_if(instances_.begin(), instances_.end(), [&](const auto& i) { return i.get() == parts_[part].instances; });
            const RTCGeometry geometry = rtcGetGeometry(scene_, part);
            if (change == InstanceChange::meshes) {
                *own = std::make_unique<EmbreeInstances>(device_, *instances, object);
                parts_[part].instances = own->get();
            }
            (*own)->update(geometry, world_origin_, padding_);
            rtcCommitGeometry(geometry);
        }
        check_embree(device_);
        rtcJoinCommitScene(scene_);
        check_embree(device_);
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
        if (part.surface || part.instances) {
            result.t = query.hit.t;
            result.object = query.object;
            result.patch = query.hit.patch;
            result.instance = query.instance;
            result.barycentric = query.barycentric;
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
    double instance_error(std::uint32_t mesh, std::uint32_t object) const override
    {
        for (const auto& instances : instances_)
            if (instances->object() == object) return instances->error(mesh);
        return 0.0;
    }

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
                } else if (const auto* mesh = std::get_if<TriangleMesh>(&shapes_[i])) {
                    add_mesh(*mesh, static_cast<std::uint32_t>(i));
                }
                if (const Instances* instances = instances_of(shapes_[i])) add_instances(*instances, static_cast<std::uint32_t>(i));
            }
            check_embree(device_);
            rtcJoinCommitScene(scene_);
            check_embree(device_);
        } catch (...) {
            release();
            throw;
        }
    }

    /// Where boxes may come to lie without moving all others: the slack that find_bounds added stays free, but for rounding.
    Box3d inner_box() const
    {
        const Vec3d inside = half_extent_ - Vec3d(3.5 * padding_);
        return {world_origin_ - inside, world_origin_ + inside};
    }

    bool fits(const Surface& surface, std::span<const std::uint32_t> tiles) const
    {
        const Box3d inner = inner_box();
        for (const std::uint32_t tile : tiles) {
            for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) {
                const Box3d box = surface.patch_bounds({tile, i});
                if (!inner.intersects(box.min) || !inner.intersects(box.max)) return false;
            }
        }
        return true;
    }

    bool fits(const Instances& instances) const
    {
        const Box3d inner = inner_box();
        std::vector<Box3d> boxes;
        for (const TriangleMesh& mesh : instances.meshes) boxes.push_back(mesh_bounds(mesh));
        return std::all_of(instances.instances.begin(), instances.instances.end(), [&](const Instance& instance) {
            const Box3d box = instance_bounds(instance, boxes[instance.mesh]);
            return inner.intersects(box.min) && inner.intersects(box.max);
        });
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
            } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
                box.extendBy(mesh_bounds(*mesh));
            }
            if (const Instances* instances = instances_of(shape)) {
                std::vector<Box3d> boxes;
                for (const TriangleMesh& mesh : instances->meshes) boxes.push_back(mesh_bounds(mesh));
                for (const Instance& instance : instances->instances) box.extendBy(instance_bounds(instance, boxes[instance.mesh]));
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
            count += (surface ? (*surface)->tile_count() : 1) + 1;
        }
        parts_.clear();
        instances_.clear();
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
            parts_.push_back({&surface, nullptr, object, tile, world_origin_, padding_});
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
        parts_.push_back({nullptr, nullptr, object, 0, world_origin_, padding_});
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                                                     std::max<std::size_t>(1, mesh.vertices.size())));
        auto* indices = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), std::max<std::size_t>(1, mesh.triangles.size())));
        check_embree(device_);
        const Vec3d offset = mesh.origin - world_origin_;
        std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices, [&](const Vec3f& v) { return Vec3f(Vec3d(v) + offset); });
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
        attach(geometry);
    }

    void add_instances(const Instances& instances, std::uint32_t object)
    {
        if (instances.instances.empty() && !options_.editable) return;
        instances_.push_back(std::make_unique<EmbreeInstances>(device_, instances, object));
        parts_.push_back({nullptr, instances_.back().get(), object, 0, world_origin_, padding_});
        attach(instances_.back()->geometry(device_, world_origin_, padding_));
    }

    void release()
    {
        instances_.clear();
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
    std::vector<std::unique_ptr<EmbreeInstances>> instances_;
    Vec3d world_origin_{0.0};
    Vec3d half_extent_{-1.0};  ///< of the scene around world_origin_; negative: an empty scene, which every ray misses
    double padding_ = 0.0;
};

}  // namespace

void check_embree(RTCDevice device)
{
    const RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return;
    if (code == RTC_ERROR_OUT_OF_MEMORY) throw Error(ErrorKind::memory, "out of memory while building the acceleration structure");
    throw Error(ErrorKind::internal, "Embree reports error " + std::to_string(static_cast<int>(code)));
}

std::unique_ptr<Tracer> make_embree_tracer(std::span<const Shape> shapes, const TracerOptions& options)
{
    return std::make_unique<EmbreeTracer>(shapes, options);
}

}  // namespace hoodoo
