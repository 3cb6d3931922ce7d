// Many objects behind one question: what does this ray meet? Embree answers it; a brute-force twin answers it for the tests.
#pragma once

#include "terrain/shape.h"

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace hoodoo
{

constexpr std::uint32_t kNoInstance = 0xffffffffu;

/// The winner of a ray over all objects: small; Tracer::interact tells the rest.
struct TraceHit {
    double t = kInfinity;
    std::uint32_t object = 0;              ///< index into the shapes the tracer was built from
    PatchId patch;                         ///< of a Surface; for a mesh `index` is the triangle
    Vec2d barycentric{0.0};                ///< mesh only
    std::uint32_t instance = kNoInstance;  ///< index into the object's Instances
    std::uint32_t evaluations = 0;         ///< cost of the ray, set on a miss too
    bool valid = false;                    ///< whether anything was hit
};

/// Immutable but for update(), thread-safe. Keeps references to the shapes: they must outlive it.
/// Every ray passes one gate: a ray that is not finite or has a coordinate beyond 1e18, whose direction is not of unit length within 1e-3, whose
/// interval is negative or empty, or whose time is outside [0, 1] is counted and answered as a miss. It never reaches Embree, whose assertions would
/// end the process.
class Tracer
{
public:
    virtual ~Tracer() = default;
    TraceHit intersect(const Ray& ray) const;
    bool occluded(const Ray& ray) const;
    Interaction interact(const Ray& ray, const TraceHit& hit) const;
    /// Every crossing of the ray in its interval, by distance, ways in and ways out alike (ray.crossing does not count); at most `most`. Distances
    /// are those of interact(). Two of one object that are nearer to each other than the surface knows its place count as one.
    std::vector<TraceHit> crossings(Ray ray, std::size_t most = 100000) const;

    /// Follows a Surface that was rebuilt in place: `tiles` are those whose patches changed, `instances` what became of the instances on it. Costs
    /// what they hold and a little for every other tile; of instances all boxes are made anew. Not while other threads trace. Throws Error (memory);
    /// Error (internal) if the tracer was not made editable.
    virtual void update(std::uint32_t object, std::span<const std::uint32_t> tiles, InstanceChange instances = InstanceChange::none) = 0;

    std::uint64_t refused_rays() const { return refused_.load(std::memory_order_relaxed); }

protected:
    explicit Tracer(std::span<const Shape> shapes) : shapes_(shapes) {}
    virtual TraceHit find_nearest(const Ray& ray) const = 0;
    virtual bool find_any(const Ray& ray) const = 0;
    /// How far, in metres, a point that this tracer finds on a triangle may lie from the mesh as given, its own rounding included. 0: not at all.
    virtual double triangle_error() const { return 0.0; }
    /// The same for a mesh of the object's instances, in the mesh's own space.
    virtual double instance_error(std::uint32_t /*mesh*/, std::uint32_t /*object*/) const { return 0.0; }
    std::span<const Shape> shapes_;

private:
    bool passes_gate(const Ray& ray) const;
    mutable std::atomic<std::uint64_t> refused_{0};
};

/// What a tracer is made ready for.
struct TracerOptions {
    bool editable = false;  ///< a tree for each tile, under one over all: update() is quick, rays are a little slower
    Box3d room;             ///< space that edits may fill beside what the shapes fill; leaving it makes update() build everything anew
};

/// Builds Embree's BVH in the current arena. Throws Error (memory) if Embree runs out of it.
std::unique_ptr<Tracer> make_embree_tracer(std::span<const Shape> shapes, const TracerOptions& options = {});

/// A loop over every patch and triangle in double precision: the oracle.
std::unique_ptr<Tracer> make_brute_force_tracer(std::span<const Shape> shapes);

}  // namespace hoodoo
