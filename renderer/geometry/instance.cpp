// An instance is met in its mesh's own space, by a similarity of our own in double precision: a rock a metre wide keeps the precision of a metre,
// wherever it lies.
//
//   o' = R^T (o - p) / s,  d' = R^T d,  t' = t / s.
// Normals turn with R. The texture is looked up at s x' + a place hashed from the instance's seed, so that copies of one mesh differ and none swims
// when it is moved or turned. A hit's error is that of the mesh's space times s, and the rounding of the two changes of space: each coordinate is a
// sum of four products, so gamma(8) times their magnitudes bounds it (Higham2002, section 3.5).

#include "renderer/geometry/instance.h"

#include "terrain/math/hash.h"

#include <algorithm>

namespace hoodoo
{

InstanceFrame::InstanceFrame(const Instance& instance) : position(instance.position), scale(instance.scale)
{
    if (instance.rotation.v == Vec3f(0.0f)) {  // most rocks are not turned
        x = Vec3d(1, 0, 0), y = Vec3d(0, 1, 0), z = Vec3d(0, 0, 1);
        return;
    }
    rotation = Imath::Quatd(instance.rotation.r, Vec3d(instance.rotation.v)).normalized();
    x = rotated(rotation, Vec3d(1, 0, 0)), y = rotated(rotation, Vec3d(0, 1, 0)), z = rotated(rotation, Vec3d(0, 0, 1));
}

Ray InstanceFrame::to_mesh(const Ray& ray) const
{
    Ray local = ray;
    const Vec3d o = (ray.origin - position) / scale;
    local.origin = Vec3d(x.dot(o), y.dot(o), z.dot(o));
    local.direction = Vec3d(x.dot(ray.direction), y.dot(ray.direction), z.dot(ray.direction));
    local.t_min = ray.t_min / scale;
    local.t_max = ray.t_max / scale;
    return local;
}

Box3d instance_bounds(const Instance& instance, const Box3d& mesh)
{
    if (mesh.isEmpty()) return {};
    const InstanceFrame frame(instance);
    const Vec3d centre = frame.to_world(mesh.center()), half = mesh.size() * 0.5;
    Vec3d reach;
    for (int k = 0; k < 3; ++k)
        reach[k] = (std::abs(frame.x[k]) * half.x + std::abs(frame.y[k]) * half.y + std::abs(frame.z[k]) * half.z) * frame.scale;
    // Rounding of a hit's position as gamma(8) of all that enters it.
    const double slack = 0x1p-48 * (centre.length() + reach.length());
    return {centre - reach - Vec3d(slack), centre + reach + Vec3d(slack)};
}

Interaction interact_instance(const Instances& instances, std::size_t index, std::size_t triangle, const Ray& ray, const TriangleHit& found,
                              double error)
{
    const Instance& instance = instances.instances[index];
    const InstanceFrame frame(instance);
    Interaction it =
        interact_triangle(instances.meshes[instance.mesh], triangle, frame.to_mesh(ray), {found.t / frame.scale, found.barycentric}, error);

    const Vec3d place(unit_real(hash_cell(instance.seed, 0, 0)), unit_real(hash_cell(instance.seed, 1, 0)),
                      unit_real(hash_cell(instance.seed, 2, 0)));
    it.texture_point = it.position * frame.scale + place * 1000.0;
    it.texture_to_world = frame.rotation;
    it.t *= frame.scale;
    const double rounding = 0x1p-49 * (frame.position.length() + it.position.length() * frame.scale + ray.origin.length() + std::abs(it.t));
    it.position = frame.to_world(it.position);
    it.position_error = it.position_error * frame.scale + rounding;
    it.spawn_offset = it.spawn_offset * frame.scale + 2.0 * rounding;
    it.geometric_normal = frame.direction_to_world(it.geometric_normal).normalized();
    it.shading_normal = frame.direction_to_world(it.shading_normal).normalized();
    it.instance = instance.id;
    it.look_seed = instance.seed;
    it.materials.index[0] = instances.material_index;
    return it;
}

}  // namespace hoodoo
