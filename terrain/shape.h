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

/// A copy of a mesh, changed by a similarity: scaled, then rotated, then moved.
struct Instance {
    Vec3d position{0.0};     ///< where the origin of the mesh's space comes to lie, metres
    Imath::Quatf rotation;   ///< normalised in double precision before use
    float scale = 1.0f;      ///< above 0
    std::uint32_t mesh = 0;  ///< index into Instances::meshes
    std::uint32_t id = 0;    ///< instanceId in a picture; from 1, different for each
    std::uint32_t seed = 0;  ///< of its tint and of its place in the texture
};

/// Many copies of few closed meshes.
struct Instances {
    std::vector<TriangleMesh> meshes;  ///< their own material does not count
    std::vector<Instance> instances;
    std::string material;
    std::uint8_t material_index = 0;  ///< of that name among the materials of the object they belong to
    RockInfo rocks;
};

/// What became of an object's Instances when it was edited.
enum class InstanceChange : std::uint8_t {
    none,
    places,  ///< others, elsewhere, more or fewer, of the same meshes
    meshes,  ///< other meshes too
};

using Shape = std::variant<std::unique_ptr<Surface>, TriangleMesh, Instances>;

/// The instances of a shape, its own or those on its surface; nullptr without.
inline const Instances* instances_of(const Shape& shape)
{
    if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape)) return (*surface)->instances();
    return std::get_if<Instances>(&shape);
}

/// World bounds of its vertices, metres; empty without any.
inline Box3d mesh_bounds(const TriangleMesh& mesh)
{
    Box3d box;
    for (const Vec3f& v : mesh.vertices) box.extendBy(mesh.origin + Vec3d(v));
    return box;
}

/// Memory of vertices, triangles, normals and coordinates.
inline std::uint64_t mesh_bytes(const TriangleMesh& mesh)
{
    return mesh.vertices.size() * sizeof(Vec3f) + mesh.triangles.size() * sizeof(mesh.triangles[0]) + mesh.normals.size() * sizeof(Vec3f) +
           mesh.uvs.size() * sizeof(Vec2f);
}

}  // namespace hoodoo
