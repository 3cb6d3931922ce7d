// A triangle mesh as a Surface, one triangle a patch, so that the laws of surfaces apply to meshes too.
#pragma once

#include "renderer/geometry/triangle.h"
#include "terrain/surface.h"

#include <algorithm>

namespace hoodoo::testing
{

class MeshSurface final : public Surface
{
public:
    explicit MeshSurface(const TriangleMesh& mesh) : mesh_(mesh) {}
    std::uint32_t patch_count(std::uint32_t) const override { return static_cast<std::uint32_t>(mesh_.triangles.size()); }
    Box3d patch_bounds(PatchId patch) const override
    {
        Box3d box;
        for (const std::uint32_t k : mesh_.triangles[patch.index]) box.extendBy(mesh_.origin + Vec3d(mesh_.vertices[k]));
        // Rounding of a hit's position at the far end of a ray.
        const Vec3d slack(0x1p-46 * (box.min.length() + box.max.length() + 100.0 * box.size().length()));
        return {box.min - slack, box.max + slack};
    }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        Ray shorter = ray;
        shorter.t_max = hit.t;
        // Closed meshes have an outside; back faces are exits.
        const auto found = intersect_triangle(mesh_, patch.index, shorter);
        if (!found || (ray.crossing == Crossing::entering && normal(patch.index).dot(ray.direction) > 0.0)) return false;
        hit.t = found->t;
        hit.patch = patch;
        return true;
    }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Ray around = ray;
        around.t_min = 0.0, around.t_max = kInfinity;
        return interact_triangle(mesh_, hit.patch.index, ray, intersect_triangle(mesh_, hit.patch.index, around).value_or(TriangleHit{hit.t, {}}),
                                 0.0);
    }
    /// Odd number of faces above.
    bool contains(const Vec3d& p) const override
    {
        Ray up;
        up.origin = p;
        up.direction = Vec3d(0.36, 0.48, 0.8);
        std::size_t faces = 0;
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) faces += intersect_triangle(mesh_, i, up).has_value();
        return faces % 2 == 1;
    }
    std::vector<std::string> materials() const override { return {mesh_.material}; }
    bool closed() const override { return true; }
    SurfaceInfo info() const override { return {}; }

private:
    Vec3d normal(std::size_t triangle) const
    {
        const auto& index = mesh_.triangles[triangle];
        const Vec3d a(mesh_.vertices[index[0]]), b(mesh_.vertices[index[1]]), c(mesh_.vertices[index[2]]);
        return (b - a).cross(c - a);
    }
    const TriangleMesh& mesh_;
};

}  // namespace hoodoo::testing
