// The gate every ray passes, and the full story of a winner, whatever kind of shape it lies on.
//
// Embree as Debian builds it ends the process on a ray it does not like (not a number, components near 1e19, a negative interval): so no such
// ray may reach it. A refused ray is counted and answers as a miss.

#include "renderer/geometry/tracer.h"

#include <algorithm>
#include <cmath>

#include "renderer/geometry/instance.h"

namespace hoodoo
{
namespace
{

/// Embree's assertions accept components up to 1.8e18 (its FLT_LARGE); terrains end long before.
constexpr double kLargest = 1e18;
/// Bounds of a unit direction's squared length: 1e-3 to either side of its length.
constexpr double kShortest2 = 0.999 * 0.999, kLongest2 = 1.001 * 1.001;

bool is_small(const Vec3d& v)
{
    return std::abs(v.x) < kLargest && std::abs(v.y) < kLargest && std::abs(v.z) < kLargest;
}

}  // namespace

bool Tracer::passes_gate(const Ray& ray) const
{
    // Each comparison is false for a NaN.
    const double length2 = ray.direction.length2();
    const bool straight = is_small(ray.origin) && length2 >= kShortest2 && length2 <= kLongest2;
    const bool interval = ray.t_min >= 0.0 && ray.t_min < ray.t_max && ray.t_min < kLargest;
    const bool shutter = ray.time >= 0.0 && ray.time <= 1.0;
    if (straight && interval && shutter) return true;
    refused_.fetch_add(1, std::memory_order_relaxed);
    return false;
}

TraceHit Tracer::intersect(const Ray& ray) const
{
    return passes_gate(ray) ? find_nearest(ray) : TraceHit{};
}

bool Tracer::occluded(const Ray& ray) const
{
    return passes_gate(ray) && find_any(ray);
}

std::vector<TraceHit> Tracer::crossings(Ray ray, std::size_t most) const
{
    std::vector<TraceHit> found;
    ray.crossing = Crossing::any;
    while (found.size() < most && ray.t_min < ray.t_max) {
        TraceHit hit = intersect(ray);
        if (!hit.valid) break;
        const Interaction at = interact(ray, hit);
        hit.t = at.t;
        found.push_back(hit);
        // Past where this crossing may truly lie, and by at least one representable distance.
        ray.t_min = std::max(hit.t + 2.0 * at.position_error, std::nextafter(hit.t, kInfinity));
    }
    return found;
}

Interaction Tracer::interact(const Ray& ray, const TraceHit& hit) const
{
    const Shape& shape = shapes_[hit.object];
    if (hit.instance != kNoInstance) {
        const Instances& instances = *instances_of(shape);
        return interact_instance(instances, hit.instance, hit.patch.index, ray, {hit.t, hit.barycentric},
                                 instance_error(instances.instances[hit.instance].mesh, hit.object));
    }
    if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape)) {
        Hit local;
        local.t = hit.t;
        local.patch = hit.patch;
        local.evaluations = hit.evaluations;
        return (*surface)->interact(ray, local);
    }
    return interact_triangle(std::get<TriangleMesh>(shape), hit.patch.index, ray, {hit.t, hit.barycentric}, triangle_error());
}

}  // namespace hoodoo
