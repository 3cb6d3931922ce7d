// A rock as triangles: a ball of directions around its middle, each moved out to where the rock ends.
#pragma once

#include "terrain/rocks/weathering.h"
#include "terrain/shape.h"

#include <array>
#include <vector>

namespace hoodoo
{

constexpr int kRockLevels = 4;

/// Triangles of a rock at a level of detail, 0 = finest: 20 n^2 with n = 20, 12, 6, 3.
std::size_t rock_triangles(int level);

/// A closed net of unit directions, counter-clockwise seen from outside: each face of an icosahedron cut into n^2.
struct DirectionBall {
    std::vector<Vec3d> directions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::vector<std::uint32_t>> neighbours;  ///< of each direction
};
DirectionBall direction_ball(int level);

/// The surface of the rock seen from `centre` (inside it), which the mesh is a graph over: closed, of the topology of a sphere, outward-facing,
/// without self-intersection. Vertices are where Phi = 0 within 1e-7 r, contacts are vertices; normals are the field's. `stretch` shapes the net.
/// Throws Error (internal) if `centre` is not inside.
TriangleMesh rock_mesh(const RockField& field, const Vec3d& centre, const DirectionBall& ball, const Vec3d& stretch);

}  // namespace hoodoo
