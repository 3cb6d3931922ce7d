// One ray and one instance of a mesh in double precision: the ray goes into the mesh's space, the story of its hit comes back.
#pragma once

#include "renderer/geometry/triangle.h"

namespace hoodoo
{

/// The rotation of an instance as a matrix of unit length columns, and its inverse by transposition.
struct InstanceFrame {
    explicit InstanceFrame(const Instance& instance);

    /// The same ray in the mesh's space: directions stay unit vectors, lengths are divided by the scale.
    Ray to_mesh(const Ray& ray) const;
    Vec3d to_world(const Vec3d& p) const { return position + (x * p.x + y * p.y + z * p.z) * scale; }
    Vec3d direction_to_world(const Vec3d& d) const { return x * d.x + y * d.y + z * d.z; }

    Vec3d position, x, y, z;  ///< x, y, z: where the mesh's axes point
    double scale;
    Imath::Quatd rotation;
};

/// World bounds of an instance of a mesh whose own bounds are `mesh`.
Box3d instance_bounds(const Instance& instance, const Box3d& mesh);

/// The story of a hit on triangle `triangle` of instance `index`. `t` is in world metres; `error` (metres of the mesh's space) is how far the
/// triangles traced may lie from those of the mesh. Textures live in the instance's own space, in world metres, each instance at its own place.
Interaction interact_instance(const Instances& instances, std::size_t index, std::size_t triangle, const Ray& ray, const TriangleHit& found,
                              double error);

}  // namespace hoodoo
