// Unidirectional path tracing with next-event estimation, multiple importance sampling and Russian roulette (Kajiya1986, Veach1997).
//
// A path x0 (eye), x1, x2 ... gathers, with the throughput b_k = product of f cos / pdf up to x_k:
//     b_k f(wo, wl) cos L(wl) V / p_l  w_l     from each light that is sampled, at every surface point: one direction wl, one shadow ray
//     b_(k+1) L(wi) w_b                        where the scattered ray wi meets no surface: lights are infinitely far away
//   with the balance heuristic w_l = p_l / (p_l + p_b), w_b = p_b / (p_b + p_l). A delta light has w_l = 1 and is never met; a light that is not
//   sampled, such as the constant sky, has w_b = 1: for it the scattered ray is the ideal sample and costs nothing. A light's p_l is that of the
//   light alone, since every light is sampled at every point.
// Roulette survives with probability q = min(1, largest channel of b) and divides by q, so a lossless path goes on for ever in a closed world;
//   after kLossless events q is at most 0.95 as well, which keeps the mean. All rays spawn on the air side of the surface and look for entries into
//   matter.
// A mirror's sample has the density infinity: what it meets counts in full, as for a camera ray. Except the sun's disc seen by way of a mirror from a
// matte
//   point (a caustic): one sample in a thousand would carry all of it. It is left out, which takes the glitter that water throws on its banks.
// Missing: media, dielectrics, caustics, lights at a finite distance.

#include "renderer/transport/path.h"

#include "renderer/shading/bsdf.h"
#include "renderer/transport/motion.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kLossless = 1000;

/// A matte surface scatters over the hemisphere: what the scattered ray looks up may be averaged over a sixteenth of it, a cone about half as wide as
/// long.
constexpr double kDiffuseSpread = 0.5;

/// A surface point of a path, ready to scatter.
struct Vertex {
    Interaction at;
    Appearance look;
    Vec3d spawn;  ///< origin of rays that leave, proved to be outside
    Vec3d wo;     ///< towards the previous point
    double footprint;
};

Vertex make_vertex(const Scene& scene, const Ray& ray, const TraceHit& hit)
{
    Vertex v;
    v.at = scene.tracer().interact(ray, hit);
    v.wo = -ray.direction;
    if (v.at.geometric_normal.dot(v.wo) < 0.0) {  // the back of an open mesh, lit like its front
        v.at.geometric_normal = -v.at.geometric_normal;
        v.at.shading_normal = -v.at.shading_normal;
    }
    v.footprint = ray.footprint(v.at.t);
    v.look = scene.appearance(hit.object, v.at, v.footprint);
    v.spawn = v.at.position + v.at.geometric_normal * v.at.spawn_offset;
    return v;
}

Ray leave(const Vertex& v, const Vec3d& direction, double time, double spread = kDiffuseSpread)
{
    Ray ray;
    ray.origin = v.spawn;
    ray.direction = direction;
    ray.time = time;
    ray.footprint_width = v.footprint;
    ray.footprint_spread = spread;
    ray.crossing = Crossing::entering;
    return ray;
}

/// What the sampled lights send through this vertex.
Vec3f next_event(const Scene& scene, const Vertex& v, const Bsdf& bsdf, const Sampler& sampler, std::uint32_t set, double time)
{
    Vec3f sum(0.0f);
    for (const Light& light : scene.lights()) {
        const bool sampled = std::visit([](const auto& l) { return l.sampled; }, light);
        if (!sampled) continue;
        LightSample to;
        if (const auto* sun = std::get_if<DeltaSun>(&light)) {
            to = sun->sample({});
        } else {
            const auto u = sampler.get(set++);
            to = std::visit([&](const auto& l) { return l.sample(Vec2d(u[0], u[1])); }, light);
        }
        const BsdfValue f = evaluate(bsdf, v.wo, to.direction);
        if (f.pdf == 0.0 || (!to.delta && !(to.pdf > 0.0))) continue;
        const double weight = to.delta ? 1.0 : 1.0 / (to.pdf + f.pdf);
        const Vec3f part = f.value * to.value * static_cast<float>(weight);
        if (part == Vec3f(0.0f) || scene.tracer().occluded(leave(v, to.direction, time))) continue;
        sum += part;
    }
    return sum;
}

/// What a ray brings that leaves the world. `pdf`: of the scattering that made it; infinite for a camera ray and a mirror. `caustic`: by way of a
/// mirror from a matte point.
Vec3f escaped(const Scene& scene, const Vec3d& direction, double pdf, bool caustic)
{
    Vec3f sum(0.0f);
    for (const Light& light : scene.lights()) {
        std::visit(
            [&](const auto& l) {
                if (caustic && std::is_same_v<std::decay_t<decltype(l)>, DiscSun>) return;
                const double other = std::isinf(pdf) ? 0.0 : l.pdf(direction);
                const double weight = other > 0.0 ? pdf / (pdf + other) : 1.0;
                sum += l.radiance(direction) * static_cast<float>(weight);
            },
            light);
    }
    return sum;
}

void record_first_hit(const Scene& scene, const Vertex& v, double time, std::uint32_t object, const Vec2i& size, std::span<float> shares,
                      PixelSample& out)
{
    out.alpha = 1.0f;
    out.z = static_cast<float>(scene.camera().depth(v.at.position, time));
    out.position = Vec3f(v.at.position);
    out.shading_normal = Vec3f(v.look.normal);
    out.geometric_normal = Vec3f(v.at.geometric_normal);
    out.albedo = v.look.albedo;
    out.motion = picture_motion(scene.camera(), v.at, time, size);
    out.object = object + 1;
    out.instance = v.at.instance;
    const std::vector<std::uint32_t>& names = scene.objects()[object].materials;
    for (std::size_t i = 0; i < v.at.materials.count; ++i) {
        const std::size_t index = v.at.materials.index[i];
        if (index < names.size()) shares[names[index]] += v.at.materials.weight[i];
    }
}

/// Ends the path or lets it go on; the expectation of the throughput stays.
bool survives(Vec3f& throughput, int events, const PathSettings& settings, double u)
{
    if (events < settings.roulette_depth) return true;
    const double largest = std::max({throughput.x, throughput.y, throughput.z});
    const double q = std::min(events > kLossless ? 0.95 : 1.0, largest);
    if (!(u < q)) return false;
    throughput /= static_cast<float>(q);
    return true;
}

}  // namespace

PixelSample trace_path(const Scene& scene, const PathSettings& settings, const Ray& camera_ray, const Sampler& sampler, std::span<float> shares)
{
    PixelSample out;
    out.z = std::numeric_limits<float>::infinity();
    std::fill(shares.begin(), shares.end(), 0.0f);
    out.materials = shares;

    // Sets of random numbers: the camera takes set 0; each event one for scattering and one for each light.
    const auto sets_an_event = static_cast<std::uint32_t>(1 + scene.lights().size());
    Ray ray = camera_ray;
    Vec3f throughput(1.0f);
    double pdf = kInfinity;
    bool matte = false;  // whether the path has met a matte surface
    for (int events = 0;; ++events) {
        const TraceHit hit = scene.tracer().intersect(ray);
        out.cost += static_cast<float>(hit.evaluations);
        if (!hit.valid) {
            out.radiance += throughput * escaped(scene, ray.direction, pdf, matte && std::isinf(pdf));
            return out;
        }
        const Vertex v = make_vertex(scene, ray, hit);
        if (events == 0) record_first_hit(scene, v, ray.time, hit.object, settings.size, shares, out);
        const std::uint32_t set = 1 + static_cast<std::uint32_t>(events) * sets_an_event;

        // Light that arrives straight from the lights.
        const Bsdf bsdf = make_diffuse(v.look.normal, v.at.geometric_normal, v.look.albedo, v.look.roughness, v.look.coat);
        out.radiance += throughput * next_event(scene, v, bsdf, sampler, set + 1, ray.time);

        // Go on in a direction that the surface prefers.
        const auto u = sampler.get(set);
        if (!survives(throughput, events, settings, u[2])) return out;
        const BsdfSample next = sample(bsdf, v.wo, {u[0], u[1], u[3]});
        if (!(next.pdf > 0.0)) return out;
        throughput *= next.weight;
        pdf = next.pdf;
        const bool mirrored = std::isinf(pdf);
        matte = matte || !mirrored;
        ray = leave(v, next.direction, ray.time, mirrored ? ray.footprint_spread : kDiffuseSpread);

        // The last event still sees the sky, but needs no more than to know whether it does.
        if (events + 1 == settings.max_depth) {
            if (!scene.tracer().occluded(ray)) out.radiance += throughput * escaped(scene, ray.direction, pdf, matte && mirrored);
            return out;
        }
    }
}

}  // namespace hoodoo
