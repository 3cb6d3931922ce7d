// What a catalogue row makes of its parameters. Only renderer/geometry turns it into something to trace.
#pragma once

#include "terrain/surface.h"

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace hoodoo
{

/// Triangles with counter-clockwise front faces. Vertices are relative to `origin` (double), so that a mesh far from the map's origin keeps its
/// precision.
struct TriangleMesh {
    Vec3d origin{0.0};
    std::vector<Vec3f> vertices;                          ///< metres
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices
    std::vector<Vec3f> normals;                           ///< unit, one a vertex; empty: flat shading
    std::vector<Vec2f> uvs;                               ///< one a vertex; empty: none
    std::string material;
};

using Shape = std::variant<std::unique_ptr<Surface>, TriangleMesh>;

}  // namespace hoodoo
