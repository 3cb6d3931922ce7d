// What a ray can hit. A representation of terrain implements these verbs and nothing else: no emission, no parsing, no Embree.
#pragma once

#include "terrain/math/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hoodoo
{

/// A piece of a surface with a proved box of its own. Tiles are what an edit rebuilds; patches are what a ray meets.
struct PatchId {
    std::uint32_t tile = 0;
    std::uint32_t index = 0;
};

/// Made while traversing: small on purpose. `t` is also the far limit of the search: start it at ray.t_max.
struct Hit {
    double t = kInfinity;  ///< metres along the ray
    PatchId patch;
    std::uint32_t evaluations = 0;  ///< field evaluations spent so far on this ray: the cost image
};

/// Shares of the materials seen at a point. `index` counts in Surface::materials(); weights are >= 0 and sum to 1.
struct MaterialWeights {
    static constexpr std::size_t capacity = 8;
    std::array<std::uint8_t, capacity> index{};
    std::array<float, capacity> weight{};
    std::size_t count = 0;

    void add(std::uint8_t i, float w)
    {
        index[count] = i;
        weight[count++] = w;
    }
};

/// Everything about the winner of a ray, computed once.
struct Interaction {
    double t = kInfinity;             ///< metres along the ray, refined: may differ from Hit::t by its stated error
    Vec3d position{0.0};              ///< world space, metres
    double position_error = 0.0;      ///< the true surface crosses the ray within this distance of `position`, metres
    double spawn_offset = 0.0;        ///< position + spawn_offset * geometric_normal is proved to lie outside, metres
    Vec3d geometric_normal{0, 0, 1};  ///< unit, towards air (a mesh: towards its front side)
    Vec3d shading_normal{0, 0, 1};    ///< unit, in the hemisphere of geometric_normal
    Vec2d uv{0.0};                    ///< surface coordinates where the representation has them, else 0
    Vec3d velocity{0.0};              ///< of the surface's point there, metres a unit of Ray::time: what motion vectors show
    double slope_variance = 0.0;      ///< of relief that the ray's footprint hides: roughness beside the material's own
    Vec3d texture_point{0.0};         ///< where procedural and triplanar textures are looked up (rest space), metres
    MaterialWeights materials;
    std::uint32_t instance = 0;     ///< id of the instance it lies on, from 1; 0: on none
    std::uint32_t look_seed = 0;    ///< of an instance: what makes its colour differ from its neighbours'
    Imath::Quatd texture_to_world;  ///< turns directions of texture_point's space into the world's; identity but on rotated instances
};

/// What instanced rocks cost. Zero where there are none.
struct RockInfo {
    std::uint64_t instances = 0;
    std::uint64_t per_tile = 0;       ///< rocks that a tile of the arrangement was asked to hold
    std::uint64_t meshes = 0;         ///< distinct ones
    double tile_seconds = 0.0;        ///< cells, contacts, weathering, meshes
    double instancing_seconds = 0.0;  ///< which rocks lie where
};

/// What `hoodoo info` prints about a terrain. Zero where a representation has no such thing.
struct SurfaceInfo {
    std::uint64_t columns = 0;
    std::uint64_t layers = 0;       ///< after merging equal neighbours; implicit base and top air not counted
    std::uint64_t stack_bytes = 0;  ///< the terrain itself
    std::uint64_t trace_bytes = 0;  ///< what tracing adds to it, without Embree's own BVH
    std::uint64_t patches = 0;
    double build_seconds = 0.0;
    RockInfo rocks;
};

class Density;
class Field;
class Height;
struct Instances;

/// A form of a field in which what is narrower than `width` metres is averaged away. It lives on its own.
struct CoarserField {
    double width = 0.0;
    std::shared_ptr<const Field> field;
};

/// All functions are const, pure and thread-safe after construction.
class Surface
{
public:
    virtual ~Surface() = default;

    virtual std::uint32_t tile_count() const { return 1; }
    virtual std::uint32_t patch_count(std::uint32_t tile) const = 0;

    /// Proved: contains every point at which intersect() may report a hit of this patch. World space; the caller adds what its own number format
    /// needs.
    virtual Box3d patch_bounds(PatchId patch) const = 0;

    /// Nearest crossing of the kind ray.crossing with t in (ray.t_min, hit.t). If there is one: sets hit.t and hit.patch, returns true.
    /// Otherwise leaves them alone. Adds its cost to hit.evaluations in both cases.
    virtual bool intersect(PatchId patch, const Ray& ray, Hit& hit) const = 0;

    /// Whether intersect() would find anything. An override must agree with it.
    virtual bool occluded(PatchId patch, const Ray& ray) const
    {
        Hit hit;
        hit.t = ray.t_max;
        return intersect(patch, ray, hit);
    }

    /// The full story of a hit that intersect() reported for this very ray.
    virtual Interaction interact(const Ray& ray, const Hit& hit) const = 0;

    /// What is seen at a point of the surface without a ray to it: sets shading normal, uv, texture point and materials from `at.position` and
    /// `at.geometric_normal`. How a surface that is carried elsewhere keeps its looks. By default the first material, everywhere.
    virtual void dress(Interaction& at) const
    {
        at.shading_normal = at.geometric_normal;
        at.texture_point = at.position;
        at.materials.add(0, 1.0f);
    }

    /// Whether the point lies in matter (closed, so that a point on the surface may answer either).
    virtual bool contains(const Vec3d& p) const = 0;

    /// Names the weights of an Interaction refer to.
    virtual std::vector<std::string> materials() const = 0;

    /// Whether matter is bounded by the surface on all sides, so that no ray from inside escapes.
    virtual bool closed() const = 0;

    virtual SurfaceInfo info() const = 0;

    /// The implicit function whose zero set this is, alive as long as the surface; nullptr where there is none. How hosts reach its values.
    virtual const Field* field() const { return nullptr; }

    /// Coarser forms of field(), each twice as coarse as the one before, the first twice as coarse as field() itself, until one is coarser than
    /// `width` metres or another would cost too much. None where field() itself grows coarser with the distance, or has no such forms.
    virtual std::vector<CoarserField> coarser_fields(double) const { return {}; }

    /// field() for a surface of several bodies, each the zero set of a field of its own.
    virtual std::vector<const Field*> fields() const
    {
        const Field* only = field();
        return only ? std::vector<const Field*>{only} : std::vector<const Field*>{};
    }

    /// The height over the plane that the surface is, alive as long as it; nullptr where it is none. What stands on heights asks for it.
    virtual const Height* height() const { return nullptr; }

    /// Meshes that lie on the surface and are a part of the same object, alive as long as it; nullptr where there are none. The verbs above do not
    /// know them: a tracer asks both. Their material is one of materials().
    virtual const Instances* instances() const { return nullptr; }

    /// Foam and spray about the surface, alive as long as it; nullptr where there are none. The scene says what it is made of.
    virtual const Density* density() const { return nullptr; }
};

}  // namespace hoodoo
