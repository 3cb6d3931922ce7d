// Unidirectional path tracing with next-event estimation, multiple importance sampling and Russian roulette (Kajiya1986, Veach1997), through media.
//
// A path x0 (eye), x1, x2 ... of points on surfaces and in media gathers, with the throughput b_k = product of f cos / pdf (in a medium: of the phase
// function) and of the media's weights up to x_k:
//     b_k f(wo, wl) cos L(wl) V / p_l  w_l     from each light that is sampled, at every point: one direction wl, one shadow ray
//     b_(k+1) L(wi) w_b                        where the scattered ray wi meets no surface: lights are infinitely far away
//   with the balance heuristic w_l = p_l / (p_l + p_b), w_b = p_b / (p_b + p_l). A delta light has w_l = 1 and is never met; a light that is not
//   sampled, such as the constant sky, has w_b = 1: for it the scattered ray is the ideal sample and costs nothing. A light's p_l is that of the
//   light alone, since every light is sampled at every point.
// Roulette survives with probability q = min(1, largest channel of b) and divides by q, so a lossless path goes on for ever in a closed world;
//   after kLossless events q is at most 0.95 as well, which keeps the mean. In air all rays spawn on the air side of the surface and look for entries
//   into matter; in water they look for both sides. Radiance is basic radiance, L / n^2 (shading/dielectric.h).
// A mirror's sample has the density infinity: what it meets counts in full, as for a camera ray. Except the sun's disc seen by way of a mirror or a
//   boundary from a matte point (a caustic): one sample in a thousand would carry all of it. It is left out, but where a point within water sees it
//   through a smooth surface (manifold.h). A picture's header says so.
// The medium a path is in follows from the last boundary it crossed and starts at the eye; a boundary that it meets knows better and corrects it.
// Missing: the caustics left out; lights at a finite distance; boundaries within boundaries (the inner one's medium alone counts).

#include "renderer/transport/path.h"

#include "renderer/transport/direct.h"
#include "renderer/transport/motion.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kLossless = 1000;

/// Sets of random numbers far beyond those of the events: for even media, one a vertex, and for the seed of the path's stream.
constexpr std::uint32_t kMediaSets = 1u << 30, kStreamSet = 1u << 31;

void record_first_hit(const Scene& scene, const Vertex& v, double time, std::uint32_t object, const Vec2i& size, std::span<float> shares,
                      PixelSample& out)
{
    out.alpha = 1.0f;
    out.z = static_cast<float>(scene.camera().depth(v.at.position, time));
    out.position = Vec3f(v.at.position);
    out.shading_normal = Vec3f(v.look.normal);
    out.geometric_normal = Vec3f(v.at.geometric_normal);
    out.albedo = v.surface ? Vec3f(1.0f) : v.look.albedo;  // a boundary keeps all light
    out.motion = picture_motion(scene.camera(), v.at, time, size);
    out.object = object + 1;
    out.instance = v.at.instance;
    const std::vector<std::uint32_t>& names = scene.objects()[object].materials;
    for (std::size_t i = 0; i < v.seen.count; ++i) {
        const std::size_t index = v.seen.index[i];
        if (index < names.size()) shares[names[index]] += v.seen.weight[i];
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

/// What a path is between two vertices.
struct Path {
    Ray ray;
    Vec3f throughput{1.0f};
    double pdf = kInfinity;  ///< of the direction, as `escaped` wants it
    bool suns = true;        ///< whether it may meet the sun's disc
    bool matte = false;      ///< whether it has met a matte surface or a medium
    const Interior* inside;  ///< what it is in; nullptr: air
};

/// Sends the path on in a direction that the vertex prefers; false if there is none.
bool scatter(Path& path, const Vertex& v, const Scattering& how, const std::array<double, 3>& u, bool suns)
{
    const BsdfSample next = sample(how, v.wo, u);
    if (!(next.pdf > 0.0)) return false;
    const bool mirrored = std::isinf(next.pdf);
    path.throughput *= next.weight;
    path.matte = path.matte || (!mirrored && !v.surface);
    path.suns = suns && !(mirrored && (path.matte || next.stray));
    path.pdf = next.pdf;
    path.ray = leave(v, next.direction, path.ray.time, mirrored || v.surface ? path.ray.footprint_spread : kMatteSpread);
    path.inside = v.medium_towards(next.direction);

    // Within water no light was sampled straight: the sky counts in full where it is met, the sun was sought through the surface.
    if (path.inside) path.pdf = kInfinity, path.suns = path.suns && !path.matte;
    return true;
}

NumberStream stream_of(const Scene& scene, const Sampler& sampler)
{
    if (scene.is_plain()) return NumberStream(0);
    const auto u = sampler.get(kStreamSet);
    return NumberStream(hash_combine(std::bit_cast<std::uint64_t>(u[0]), std::bit_cast<std::uint64_t>(u[1])));
}

}  // namespace

PixelSample trace_path(const Scene& scene, const PathSettings& settings, const Ray& camera_ray, const Sampler& sampler, std::span<float> shares)
{
    PixelSample out;
    out.z = std::numeric_limits<float>::infinity();
    std::fill(shares.begin(), shares.end(), 0.0f);
    out.materials = shares;

    // Sets of random numbers: after the camera's, each vertex has one for scattering and one for each light.
    const auto sets_a_vertex = static_cast<std::uint32_t>(1 + scene.lights().size());
    const double time = camera_ray.time;
    NumberStream random = stream_of(scene, sampler);
    Path path{.ray = camera_ray, .inside = scene.around_eye(time)};
    if (path.inside) path.ray.crossing = Crossing::any;
    int events = 0;  // at surfaces; media have no limit but roulette
    for (std::uint32_t vertices = 0;; ++vertices) {
        const TraceHit hit = scene.tracer().intersect(path.ray);
        out.cost += static_cast<float>(hit.evaluations);

        // What lies on the way.
        Passage way;
        if (!scene.is_plain() && (path.inside || !scene.media().empty())) {
            const auto u = sampler.get(kMediaSets + vertices);
            way = scene.media().pass(path.ray, hit.valid ? hit.t : kInfinity, path.inside, {u[0], u[1]}, random);
            path.throughput *= way.weight;
        }
        if (!hit.valid && !way.scattered) {
            out.radiance += path.throughput * escaped(scene, path.ray.direction, path.pdf, path.suns);
            return out;
        }
        Vertex v;
        if (hit.valid && (!way.scattered || vertices == 0)) v = surface_vertex(scene, path.ray, hit, path.inside, random);
        if (hit.valid && vertices == 0) record_first_hit(scene, v, time, hit.object, settings.size, shares, out);
        if (way.scattered) v = medium_vertex(path.ray, way.t, path.inside);
        const Scattering how = way.scattered ? Scattering(HenyeyGreenstein(way.asymmetry)) : surface_scattering(v);

        // Light that arrives straight from the lights. A surface whose only roughness is that of ripples too fine to see is a mirror to matte points:
        // the sun through it was sought by the point behind it, its glitter is left out.
        const std::uint32_t set = 1 + vertices * sets_a_vertex;
        const bool suns = !(v.surface && v.surface->smooth && path.matte);
        out.radiance += path.throughput * next_event(scene, v, how, sampler, set + 1, time, suns, random);

        // Go on.
        auto u = sampler.get(set);
        if (vertices == 0) {
            const auto camera = sampler.get(kCameraSet);
            u[0] = camera[2], u[1] = camera[3];
        }
        if (!survives(path.throughput, static_cast<int>(vertices), settings, u[2])) return out;
        if (!scatter(path, v, how, {u[0], u[1], u[3]}, suns)) return out;

        // The last event still sees the sky, but needs no more than to know whether it does.
        if (!way.scattered && ++events == settings.max_depth) {
            if (scene.tracer().occluded(path.ray)) return out;
            Vec3f last = path.throughput * escaped(scene, path.ray.direction, path.pdf, path.suns);
            if (!scene.is_plain()) last *= scene.media().transmittance(path.ray, kInfinity, path.inside, random);
            out.radiance += last;
            return out;
        }
    }
}

}  // namespace hoodoo
