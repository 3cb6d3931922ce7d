// Description -> Scene: makes each terrain by its catalogue row, gives each material a look, each light its table, and everything to the tracer.
//
// Materials are named by the terrains; the scene numbers the names in the order in which they first appear. A material that no table describes looks
// as its name suggests. Where several are visible at a point their albedo, roughness and normals are averaged by their shares.

#include "renderer/scene/scene.h"

#include "renderer/geometry/instance.h"
#include "renderer/scene/media.h"
#include "renderer/scene/terrains.h"
#include "renderer/shading/mask.h"
#include "terrain/editable.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kProbes = 26;  ///< directions in which the eye looks for what it is in

std::vector<DensityCarrier> carriers(const SceneParts& parts)
{
    std::vector<DensityCarrier> all;
    for (std::size_t i = 0; i < parts.shapes.size(); ++i) {
        const auto* surface = std::get_if<std::unique_ptr<Surface>>(&parts.shapes[i]);
        all.push_back({parts.objects[i].name, surface ? surface->get() : nullptr});
    }
    return all;
}

SceneParts make_parts(const Description& description, const SceneOptions& options)
{
    SceneParts parts{Camera(description.camera, {description.time, description.film.number("fps")}), {}, {}, {}, {}, {}, {}};
    BuiltTerrains terrains = build_terrains(description, options, parts.camera);
    parts.objects = std::move(terrains.objects);
    parts.shapes = std::move(terrains.shapes);
    const auto plain = [&](const std::string& name) {
        const auto& all = description.materials;
        const auto node = std::find_if(all.begin(), all.end(), [&](const DescribedNode& n) { return n.name == name; });
        return node == all.end() ? default_look(name, options.to_rendering)
                                 : make_look(name, node->values, options.to_rendering, description.resolve);
    };
    for (const DescribedNode& node : description.materials)
        parts.looks[node.name] = with_masks(plain(node.name), node.values, description.resolve, plain);
    for (const DescribedNode& node : description.lights)
        for (Light& light : make_lights(node.type, node.values, options.to_rendering, haze_depth(description.haze)))
            parts.lights.push_back(std::move(light));
    parts.interiors = make_interiors(description, options.to_rendering);
    parts.media = make_media(description, carriers(parts), options.to_rendering);
    return parts;
}

std::vector<std::string> materials_of(const Shape& shape)
{
    if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape)) return (*surface)->materials();
    if (const auto* instances = std::get_if<Instances>(&shape)) return {instances->material};
    return {std::get<TriangleMesh>(shape).material};
}

/// An infinite or empty side does not count.
void extend(Box3d& box, const Box3d& by)
{
    for (int k = 0; k < 3; ++k) {
        if (!(by.min[k] <= by.max[k]) || !std::isfinite(by.min[k]) || !std::isfinite(by.max[k])) continue;
        box.min[k] = std::min(box.min[k], by.min[k]);
        box.max[k] = std::max(box.max[k], by.max[k]);
    }
}

}  // namespace

Scene::Scene(const Description& description, const SceneOptions& options) : Scene(make_parts(description, options), options) {}

Scene::Scene(SceneParts parts, const SceneOptions& options)
    : camera_(parts.camera),
      lights_(std::move(parts.lights)),
      shapes_(std::move(parts.shapes)),
      objects_(std::move(parts.objects)),
      media_(std::move(parts.media))
{
    name_materials(parts, options);
    describe_objects();
    if (options.progress) options.progress(0.0, "acceleration structure");
    editable_ = options.editable;
    Box3d room;
    for (std::uint32_t i = 0; i < shapes_.size(); ++i)
        if (const EditableSurface* surface = editable_surface(i)) room.extendBy(surface->room());
    tracer_ = options.brute_force ? make_brute_force_tracer(shapes_) : make_embree_tracer(shapes_, {.editable = editable_, .room = room});
    find_eye();
}

void Scene::name_materials(SceneParts& parts, const SceneOptions& options)
{
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        for (const std::string& name : materials_of(shapes_[i])) {
            const auto found = std::find(material_names_.begin(), material_names_.end(), name);
            objects_[i].materials.push_back(static_cast<std::uint32_t>(found - material_names_.begin()));
            if (found != material_names_.end()) continue;
            material_names_.push_back(name);
            const auto look = parts.looks.find(name);
            const bool described = look != parts.looks.end();
            looks_.push_back(described ? std::move(look->second) : default_look(name, options.to_rendering));
            const auto body = parts.interiors.find(name);
            if (body != parts.interiors.end())
                interiors_.emplace_back(body->second);
            else
                interiors_.push_back(described ? std::nullopt : default_interior(name, options.to_rendering));
        }
    }
    plain_ = media_.empty() && std::none_of(interiors_.begin(), interiors_.end(), [](const auto& body) { return body.has_value(); });
}

void Scene::describe_objects()
{
    for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
        describe(i);
        if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[i])) {
            for (std::uint32_t tile = 0; tile < (*surface)->tile_count(); ++tile) extend_bounds(**surface, tile);
        } else if (const auto* mesh = std::get_if<TriangleMesh>(&shapes_[i])) {
            extend(bounds_, mesh_bounds(*mesh));
        }
        if (const Instances* instances = instances_of(shapes_[i])) extend_bounds(*instances);
    }
}

void Scene::describe(std::uint32_t object)
{
    SurfaceInfo& info = objects_[object].info;
    info = {};
    if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[object])) {
        info = (*surface)->info();
    } else if (const auto* mesh = std::get_if<TriangleMesh>(&shapes_[object])) {
        info.patches = mesh->triangles.size();
        info.trace_bytes = mesh_bytes(*mesh);
    }
    if (const Instances* instances = instances_of(shapes_[object])) {
        info.rocks = instances->rocks;
        info.patches += instances->instances.size();
        info.trace_bytes += instances->instances.size() * sizeof(Instance);
        for (const TriangleMesh& mesh : instances->meshes) info.trace_bytes += mesh_bytes(mesh);
    }
}

void Scene::extend_bounds(const Surface& surface, std::uint32_t tile)
{
    for (std::uint32_t k = 0; k < surface.patch_count(tile); ++k) extend(bounds_, surface.patch_bounds({tile, k}));
}

void Scene::extend_bounds(const Instances& instances)
{
    std::vector<Box3d> boxes;
    for (const TriangleMesh& mesh : instances.meshes) boxes.push_back(mesh_bounds(mesh));
    for (const Instance& instance : instances.instances) extend(bounds_, instance_bounds(instance, boxes[instance.mesh]));
}

EditableSurface* Scene::editable_surface(std::uint32_t object)
{
    const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[object]);
    auto* edited = surface ? dynamic_cast<EditableSurface*>(surface->get()) : nullptr;
    return editable_ && edited && edited->takes_edits() ? edited : nullptr;
}

void Scene::follow_edit(std::uint32_t object, const ColumnSet& changed)
{
    EditableSurface* surface = editable_surface(object);
    if (!surface) throw Error(ErrorKind::internal, "an edit of a surface that cannot be edited");
    const Rebuilt rebuilt = surface->rebuild(changed);
    tracer_->update(object, rebuilt.tiles, rebuilt.rocks);
    describe(object);
    for (const std::uint32_t tile : rebuilt.tiles) extend_bounds(*surface, tile);
    if (rebuilt.rocks != InstanceChange::none) extend_bounds(*surface->instances());
    find_eye();
}

void Scene::find_eye()
{
    for (int end = 0; end < 2; ++end) around_eye_[static_cast<std::size_t>(end)] = around(camera_.eye(end), end);
}

/// What the first crossing in some direction says: the side from which the surface of a body is met tells what the eye is in. A ray that enters
/// opaque matter says nothing, one that leaves it says that the eye cannot be there: it would see through the surface.
const Interior* Scene::around(const Vec3d& eye, double time) const
{
    const SceneObject* holder = nullptr;
    for (std::size_t i = 0; i < shapes_.size() && !holder; ++i) {
        const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[i]);
        if (surface && (*surface)->contains(eye)) holder = &objects_[i];
    }
    const bool bodies = std::any_of(interiors_.begin(), interiors_.end(), [](const auto& body) { return body.has_value(); });
    for (int k = 0; bodies && k < kProbes; ++k) {
        // Up first, then a spiral down the sphere.
        const double z = 1.0 - 2.0 * k / kProbes, r = std::sqrt(std::max(0.0, 1.0 - z * z)), angle = 2.4 * k;
        Ray ray;
        ray.origin = eye;
        ray.direction = Vec3d(r * std::cos(angle), r * std::sin(angle), z);
        ray.time = time;
        const TraceHit hit = tracer_->intersect(ray);
        if (!hit.valid) continue;
        const Interaction at = tracer_->interact(ray, hit);
        const bool leaves = at.geometric_normal.dot(ray.direction) > 0.0;
        if (const Interior* body = interior(hit.object, at)) return leaves ? body : nullptr;
        if (leaves && holder) break;
    }
    if (holder)
        throw Error(ErrorKind::scene,
                    Problem{camera_.where(), "the camera stands inside the terrain \"" + holder->name + "\"", "an eye in air or water", {}, {}});
    return nullptr;
}

const Interior* Scene::interior(std::uint32_t object, const Interaction& at, float* share, std::size_t* which) const
{
    const std::vector<std::uint32_t>& names = objects_[object].materials;
    for (std::size_t i = 0; i < at.materials.count; ++i) {
        const std::optional<Interior>& body = interiors_[names[std::min<std::size_t>(at.materials.index[i], names.size() - 1)]];
        if (!body || !(at.materials.weight[i] > 0.0f)) continue;
        if (share) *share = at.materials.weight[i];
        if (which) *which = i;
        return &*body;
    }
    return nullptr;
}

Appearance Scene::appearance(std::uint32_t object, const Interaction& at, double footprint) const
{
    const std::vector<std::uint32_t>& names = objects_[object].materials;
    const auto look = [&](std::size_t i) -> const Look& { return *looks_[names[std::min<std::size_t>(at.materials.index[i], names.size() - 1)]]; };
    if (at.materials.count == 1) return look(0).appearance(at, footprint);

    Appearance sum{Vec3f(0.0f), 0.0f, Vec3d(0.0)};
    float total = 0.0f;
    for (std::size_t i = 0; i < at.materials.count; ++i) {
        const float share = at.materials.weight[i];
        if (!(share > 0.0f)) continue;
        const Appearance one = look(i).appearance(at, footprint);
        sum.albedo += one.albedo * share;
        sum.roughness += one.roughness * share;
        sum.normal += one.normal * static_cast<double>(share);
        sum.coat += one.coat * share;
        total += share;
    }
    const double length = sum.normal.length();
    if (!(total > 0.0f) || !(length > 0.0)) return {Vec3f(0.0f), 0.0f, at.shading_normal};
    return {sum.albedo / total, sum.roughness / total, sum.normal / length, sum.coat / total};
}

}  // namespace hoodoo
