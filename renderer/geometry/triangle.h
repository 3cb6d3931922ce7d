// One ray and one triangle in double precision: what the oracle traces with, and what makes a hit of Embree exact afterwards.
#pragma once

#include "terrain/shape.h"

#include <optional>

namespace hoodoo
{

struct TriangleHit {
    double t = kInfinity;    ///< metres along the ray, in the ray's open interval
    Vec2d barycentric{0.0};  ///< weights of vertices 1 and 2, as Embree gives them
};

/// Both sides count, whatever ray.crossing says: a mesh need not be closed. Watertight: a ray through a shared edge or corner meets at least one
/// of the triangles there. A triangle without area is never met.
std::optional<TriangleHit> intersect_triangle(const TriangleMesh& mesh, std::size_t triangle, const Ray& ray);

/// The story of a hit on a mesh. `barycentric` is what the tracer found; `error` (metres) is how far the triangles it traced may lie from
/// those of the mesh, its own rounding included.
Interaction interact_triangle(const TriangleMesh& mesh, std::size_t triangle, const Ray& ray, const TriangleHit& found, double error);

}  // namespace hoodoo
