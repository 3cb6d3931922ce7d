// The points of a path. A surface's normals are turned to the side the path came from, so that nothing after this asks for sides again but a boundary
// that light passes. What lies on such a boundary in flecks, as foam does, is drawn by its share: an average of a wall and a window is neither. The
// offset that is proved to lie outside the matter leads, turned round, as far inside: the surface crosses within it.
#include "renderer/transport/vertex.h"

namespace hoodoo
{

BsdfValue evaluate(const Scattering& scattering, const Vec3d& wo, const Vec3d& wi)
{
    if (const Bsdf* bsdf = std::get_if<Bsdf>(&scattering)) return evaluate(*bsdf, wo, wi);
    const double value = std::get<HenyeyGreenstein>(scattering).value(wo, wi);
    return {Vec3f(static_cast<float>(value)), value};
}

BsdfSample sample(const Scattering& scattering, const Vec3d& wo, const std::array<double, 3>& u)
{
    if (const Bsdf* bsdf = std::get_if<Bsdf>(&scattering)) return sample(*bsdf, wo, u);
    const auto& phase = std::get<HenyeyGreenstein>(scattering);
    const Vec3d wi = phase.sample(wo, Vec2d(u[0], u[1]));
    return {wi, Vec3f(1.0f), phase.value(wo, wi)};
}

namespace
{

/// Leaves at the vertex what light meets there: the surface of a body, or what lies on it.
void choose_material(const Scene& scene, std::uint32_t object, Vertex& v, NumberStream& random)
{
    float share = 0.0f;
    std::size_t which = 0;
    v.seen = v.at.materials;
    const Interior* body = scene.interior(object, v.at, &share, &which);
    if (!body || v.seen.count == 1) {
        v.surface = body;
        return;
    }
    v.at.materials = {};
    if (random() < static_cast<double>(share)) {
        v.at.materials.add(v.seen.index[which], 1.0f);
        v.surface = body;
        return;
    }
    for (std::size_t i = 0; i < v.seen.count; ++i)
        if (i != which) v.at.materials.add(v.seen.index[i], v.seen.weight[i]);
}

}  // namespace

Vertex surface_vertex(const Scene& scene, const Ray& ray, const TraceHit& hit, const Interior* around, NumberStream& random)
{
    Vertex v;
    v.at = scene.tracer().interact(ray, hit);
    v.wo = -ray.direction;
    choose_material(scene, hit.object, v, random);
    v.around = around;
    if (v.at.geometric_normal.dot(v.wo) < 0.0) {  // from within, or the back of an open mesh, lit like its front
        v.at.geometric_normal = -v.at.geometric_normal;
        v.at.shading_normal = -v.at.shading_normal;
        v.from_inside = true;
    }
    // What the last point of the path was told may be wrong: the side of a boundary is not.
    if (v.surface) v.around = v.from_inside ? v.surface : nullptr;
    v.footprint = ray.footprint(v.at.t);
    v.look = scene.appearance(hit.object, v.at, v.footprint);
    v.point = v.at.position + v.at.geometric_normal * v.at.spawn_offset;
    return v;
}

Scattering surface_scattering(const Vertex& v)
{
    if (v.surface) {
        const double eta = v.from_inside ? 1.0 / v.surface->ior : v.surface->ior;
        return Bsdf(Dielectric(v.look.normal, v.at.geometric_normal, eta, v.look.roughness));
    }
    return make_diffuse(v.look.normal, v.at.geometric_normal, v.look.albedo, v.look.roughness, v.look.coat);
}

Vertex medium_vertex(const Ray& ray, double t, const Interior* around)
{
    Vertex v;
    v.around = around;
    v.point = ray.at(t);
    v.wo = -ray.direction;
    v.footprint = ray.footprint(t);
    return v;
}

Ray leave(const Vertex& v, const Vec3d& direction, double time, double spread)
{
    Ray ray;
    const bool beyond = v.surface && direction.dot(v.at.geometric_normal) < 0.0;
    ray.origin = beyond ? v.at.position - v.at.geometric_normal * v.at.spawn_offset : v.point;
    ray.direction = direction;
    ray.time = time;
    ray.footprint_width = v.footprint;
    ray.footprint_spread = spread;
    ray.crossing = v.medium_towards(direction) ? Crossing::any : Crossing::entering;
    return ray;
}

}  // namespace hoodoo
