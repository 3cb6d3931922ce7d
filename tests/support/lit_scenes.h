// Small worlds whose light is known in closed form, and pictures of them.
#pragma once

#include "renderer/scene/scene.h"
#include "renderer/transport/tiles.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace hoodoo::testing
{

/// The look of a surface of one albedo. `tilt`: the normal is bent by up to this angle (radians), differently at each point.
class PlainLook final : public Look
{
public:
    explicit PlainLook(float albedo, double tilt = 0.0, float roughness = 0.0f) : albedo_(albedo), tilt_(tilt), roughness_(roughness) {}
    Appearance appearance(const Interaction& at, double) const override
    {
        Appearance look{Vec3f(albedo_), roughness_, at.shading_normal};
        if (tilt_ > 0.0) {
            Vec3d t, b;
            orthonormal_frame(at.geometric_normal, t, b);
            const double angle = 40.0 * at.position.x + 70.0 * at.position.y + 100.0 * at.position.z;
            look.normal = (at.geometric_normal * std::cos(tilt_) + (t * std::cos(angle) + b * std::sin(angle)) * std::sin(tilt_)).normalized();
        }
        return look;
    }

private:
    float albedo_;
    double tilt_;
    float roughness_;
};

/// A hollow sphere of radius 1 around the origin, seen from inside, open where z > `lid`. Its matter is everything outside the sphere, but rays that
/// leave through the opening meet nothing.
class Cave final : public Surface
{
public:
    explicit Cave(double lid) : lid_(lid) {}
    std::uint32_t patch_count(std::uint32_t) const override { return 1; }
    Box3d patch_bounds(PatchId) const override { return Box3d(Vec3d(-1.001), Vec3d(1.001)); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        ++hit.evaluations;
        const double b = ray.origin.dot(ray.direction), c = ray.origin.dot(ray.origin) - 1.0, d = b * b - c;
        if (!(d > 0.0)) return false;
        const double t = -b + std::sqrt(d);  // the exit from the hollow is the entry into matter
        if (!(t > ray.t_min && t < hit.t) || ray.at(t).z > lid_) return false;
        hit.t = t;
        hit.patch = patch;
        return true;
    }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction it;
        it.t = hit.t;
        it.position = ray.at(hit.t).normalized();
        it.position_error = 1e-14;
        it.spawn_offset = 1e-13;
        it.geometric_normal = it.shading_normal = -it.position;
        it.texture_point = it.position;
        it.materials.add(0, 1.0f);
        return it;
    }
    bool contains(const Vec3d& p) const override { return p.length2() > 1.0 && p.z <= lid_; }
    std::vector<std::string> materials() const override { return {"wall"}; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override { return {}; }

private:
    double lid_;
};

/// A horizontal square of matter below z = 0, 2 `half` wide: two triangles that face up.
inline TriangleMesh ground(float half = 1000.0f)
{
    TriangleMesh mesh;
    mesh.vertices = {Vec3f(-half, -half, 0), Vec3f(half, -half, 0), Vec3f(half, half, 0), Vec3f(-half, half, 0)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = "wall";
    return mesh;
}

inline SceneParts lit_parts(const Camera& camera, Shape shape, std::vector<Light> lights, std::unique_ptr<Look> look)
{
    SceneParts parts{camera, std::move(lights), {}, {}, {}, {}, {}};
    parts.objects.push_back({"thing", "test", {}, {}});
    parts.shapes.push_back(std::move(shape));
    parts.looks["wall"] = std::move(look);
    return parts;
}

struct Shot {
    int width = 16, height = 16, samples = 16, replicates = 1;
    PixelBounds data{0, 16, 0, 16};
    PathSettings path{};
    int threads = 1, tile_size = 32;
};

inline Image shoot(const Scene& scene, const Shot& shot)
{
    FilmLayout layout;
    layout.width = shot.width, layout.height = shot.height, layout.data = shot.data;
    layout.samples = shot.samples, layout.replicates = shot.replicates;
    layout.materials = scene.material_names();
    Film film(layout);
    TileSettings tiles;
    tiles.threads = shot.threads, tiles.tile_size = shot.tile_size;
    trace_tiles(scene, shot.path, tiles, film);
    return film.develop();
}

/// Mean of a channel over the picture.
inline double mean(const Image& image, const std::string& channel)
{
    double sum = 0.0;
    const std::vector<float>& pixels = image.find(channel)->pixels;
    for (const float p : pixels) sum += p;
    return sum / static_cast<double>(pixels.size());
}

}  // namespace hoodoo::testing
