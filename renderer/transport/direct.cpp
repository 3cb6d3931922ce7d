// Next-event estimation with multiple importance sampling (Veach1997), through media: the weights are those of the directions alone, since a shadow
// ray's transmittance is an estimate of the same number that the scattered ray meets as a chance to get through.
// Straight shadow rays are sent in air only; water, air and the boundary between bend them. What is inside water sees the sky by its scattered rays,
// which count in full, and the sun by manifold.h.
#include "renderer/transport/direct.h"

#include "renderer/transport/manifold.h"

#include <cmath>

namespace hoodoo
{
namespace
{

template <class L>
constexpr bool is_sun = std::is_same_v<std::decay_t<L>, DeltaSun> || std::is_same_v<std::decay_t<L>, DiscSun>;

/// Share of light that comes to `v` from far away along a direction in air.
Vec3f passing(const Scene& scene, const Vertex& v, const Vec3d& direction, double time, NumberStream& random)
{
    const Ray ray = leave(v, direction, time);
    if (scene.tracer().occluded(ray)) return Vec3f(0.0f);
    return scene.media().empty() ? Vec3f(1.0f) : scene.media().transmittance(ray, kInfinity, nullptr, random);
}

}  // namespace

Vec3f next_event(const Scene& scene, const Vertex& v, const Scattering& scattering, const Sampler& sampler, std::uint32_t set, double time, bool suns,
                 NumberStream& random)
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
        const bool sun = std::visit([](const auto& l) { return is_sun<decltype(l)>; }, light);
        if (sun && !suns) continue;
        if (const Interior* water = v.medium_towards(to.direction)) {
            if (sun && water->smooth && !v.surface) sum += sun_through_boundary(scene, v, scattering, *water, to, time, random);
            continue;
        }
        const BsdfValue f = evaluate(scattering, v.wo, to.direction);
        if (f.pdf == 0.0 || (!to.delta && !(to.pdf > 0.0))) continue;
        const double weight = to.delta ? 1.0 : 1.0 / (to.pdf + f.pdf);
        const Vec3f part = f.value * to.value * static_cast<float>(weight);
        if (part == Vec3f(0.0f)) continue;
        const Vec3f share = passing(scene, v, to.direction, time, random);
        if (share != Vec3f(0.0f)) sum += part * share;
    }
    return sum;
}

Vec3f escaped(const Scene& scene, const Vec3d& direction, double pdf, bool suns)
{
    Vec3f sum(0.0f);
    for (const Light& light : scene.lights()) {
        std::visit(
            [&](const auto& l) {
                if (!suns && is_sun<decltype(l)>) return;
                const double other = std::isinf(pdf) ? 0.0 : l.pdf(direction);
                const double weight = other > 0.0 ? pdf / (pdf + other) : 1.0;
                sum += l.radiance(direction) * static_cast<float>(weight);
            },
            light);
    }
    return sum;
}

}  // namespace hoodoo
