// An implicit surface as triangles, tile by tile, so that no terrain is too large.
#pragma once

#include "terrain/field.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace hoodoo
{

struct PolygoniseOptions {
    double spacing = 1.0;  ///< metres between the lattice points at which the field is sampled
    Box3d region;          ///< finite; where the surface is wanted. Surface that goes on beyond a side of it is cut there, vertically
    int tile = 128;        ///< lattice cells along x and y that are held at a time; a multiple of 8. Never changes the surface
};

/// One tile's share of the mesh. Triangles turn counter-clockwise seen from the air; their indices count the vertices of all tiles in the order in
/// which they were delivered.
struct MeshPart {
    std::vector<Vec3d> vertices;
    std::vector<Vec3d> normals;  ///< unit, towards air: the field's gradient
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct PolygoniseReport {
    std::uint64_t vertices = 0, triangles = 0;
    std::uint64_t unrefined = 0;      ///< vertices without a root within a lattice cell: they stay where the samples put them
    double area = 0.0;                ///< m2
    double mean_error = 0.0;          ///< metres: distance from centroids and edge midpoints of triangles to the field's zero, by area
    double maximum_error = 0.0;       ///< metres: the greatest of them; each is the length of a way to a zero, so no distance is longer
    std::uint64_t far_triangles = 0;  ///< triangles with a place from which no zero was found, however far; they count in none of the above
};

/// How far the field's zero lies from `p` along its gradient there, metres: an upper bound of the distance. `reach` if there is none so near.
double distance_along_gradient(const Field& field, const Vec3d& p, double reach);

/// Calls deliver(part) once for each tile that holds surface, in a fixed order: the same bits for any number of threads. Throws Error (scene) if the
/// lattice has over 2^31 points a side or the mesh over 2^31 vertices, Error (internal) without OpenVDB, and what `deliver` throws.
PolygoniseReport polygonise(const Field& field, const PolygoniseOptions& options, const std::function<void(const MeshPart&)>& deliver);

}  // namespace hoodoo
