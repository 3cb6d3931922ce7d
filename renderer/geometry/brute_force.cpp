// The oracle of the tracer: every patch and every triangle is asked, in double precision, without any structure that could lose one.

#include "renderer/geometry/instance.h"
#include "renderer/geometry/tracer.h"

namespace hoodoo
{
namespace
{

class BruteForceTracer final : public Tracer
{
public:
    explicit BruteForceTracer(std::span<const Shape> shapes) : Tracer(shapes) {}

    /// It keeps nothing that could be old.
    void update(std::uint32_t, std::span<const std::uint32_t>, InstanceChange) override {}

protected:
    TraceHit find_nearest(const Ray& ray) const override
    {
        TraceHit best;
        Ray shortened = ray;
        for (std::size_t i = 0; i < shapes_.size(); ++i) {
            const auto object = static_cast<std::uint32_t>(i);
            if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shapes_[i])) {
                nearest_on_surface(**surface, object, shortened, best);
            } else if (const auto* mesh = std::get_if<TriangleMesh>(&shapes_[i])) {
                nearest_on_mesh(*mesh, object, shortened, best);
            }
            if (const Instances* instances = instances_of(shapes_[i])) nearest_on_instances(*instances, object, shortened, best);
        }
        return best;
    }

    bool find_any(const Ray& ray) const override
    {
        for (const Shape& shape : shapes_) {
            if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape)) {
                for (std::uint32_t tile = 0; tile < (*surface)->tile_count(); ++tile)
                    for (std::uint32_t i = 0; i < (*surface)->patch_count(tile); ++i)
                        if ((*surface)->occluded({tile, i}, ray)) return true;
            } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
                for (std::size_t i = 0; i < mesh->triangles.size(); ++i)
                    if (intersect_triangle(*mesh, i, ray)) return true;
            }
            TraceHit hit;
            Ray shortened = ray;
            if (const Instances* instances = instances_of(shape)) nearest_on_instances(*instances, 0, shortened, hit);
            if (hit.valid) return true;
        }
        return false;
    }

private:
    /// Shortens the ray to what it found, so that the next shape has to be nearer.
    static void nearest_on_surface(const Surface& surface, std::uint32_t object, Ray& ray, TraceHit& best)
    {
        Hit hit;
        hit.t = ray.t_max;
        bool found = false;
        for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
            for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) found = surface.intersect({tile, i}, ray, hit) || found;
        best.evaluations += hit.evaluations;
        if (!found) return;
        best.valid = true;
        best.t = ray.t_max = hit.t;
        best.object = object;
        best.patch = hit.patch;
        best.instance = kNoInstance;
    }

    static void nearest_on_mesh(const TriangleMesh& mesh, std::uint32_t object, Ray& ray, TraceHit& best)
    {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::optional<TriangleHit> hit = intersect_triangle(mesh, i, ray);
            if (!hit) continue;
            best.valid = true;
            best.t = ray.t_max = hit->t;
            best.object = object;
            best.patch = {0, static_cast<std::uint32_t>(i)};
            best.barycentric = hit->barycentric;
            best.instance = kNoInstance;
        }
    }

    static void nearest_on_instances(const Instances& instances, std::uint32_t object, Ray& ray, TraceHit& best)
    {
        for (std::size_t k = 0; k < instances.instances.size(); ++k) {
            const InstanceFrame frame(instances.instances[k]);
            Ray local = frame.to_mesh(ray);
            TraceHit hit;
            nearest_on_mesh(instances.meshes[instances.instances[k].mesh], object, local, hit);
            if (!hit.valid) continue;
            hit.t = ray.t_max = hit.t * frame.scale;
            hit.evaluations = best.evaluations;
            hit.instance = static_cast<std::uint32_t>(k);
            best = hit;
        }
    }
};

}  // namespace

std::unique_ptr<Tracer> make_brute_force_tracer(std::span<const Shape> shapes)
{
    return std::make_unique<BruteForceTracer>(shapes);
}

}  // namespace hoodoo
