// Rays for the laws of surfaces, aimed at the surface's own patches and at what they hit.

#include "tests/support/numbers.h"
#include "tests/support/surface_laws.h"

namespace hoodoo::testing
{
namespace
{

PatchId pick_patch(const Surface& surface, Numbers& random)
{
    for (;;) {
        const auto tile = static_cast<std::uint32_t>(random() * surface.tile_count());
        const std::uint32_t n = surface.patch_count(tile);
        if (n > 0) return {tile, static_cast<std::uint32_t>(random() * n)};
    }
}

}  // namespace

Box3d surface_bounds(const Surface& surface)
{
    Box3d box;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
        for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) box.extendBy(surface.patch_bounds({tile, i}));
    return box;
}

Hit nearest_hit(const Surface& surface, const Ray& ray)
{
    Hit hit;
    hit.t = ray.t_max;
    bool found = false;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
        for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) found = surface.intersect({tile, i}, ray, hit) || found;
    if (!found) hit.t = kInfinity;
    return hit;
}

std::vector<Ray> law_rays(const Surface& surface, std::uint64_t seed, int count)
{
    const double size = surface_bounds(surface).size().length();
    std::vector<Ray> rays;
    for (int n = 0; n < count; ++n) {
        Numbers random(seed, static_cast<std::uint64_t>(n));
        Ray ray;
        ray.crossing = random() < 0.5 ? Crossing::any : Crossing::entering;
        ray.direction = random.direction();
        if (n % 10 == 4) {
            ray.direction = Vec3d(0.0);
            ray.direction[static_cast<int>(3.0 * random())] = random() < 0.5 ? 1.0 : -1.0;
        }
        ray.origin = random.in(surface.patch_bounds(pick_patch(surface, random))) - ray.direction * (size * random() * random());
        if (n % 10 < 2 || n % 10 == 3) {
            Ray probe = ray;
            probe.crossing = Crossing::any;
            const Hit hit = nearest_hit(surface, probe);
            if (std::isfinite(hit.t)) {
                const Interaction at = surface.interact(probe, hit);
                if (n % 10 < 2) {
                    Vec3d u, v;
                    orthonormal_frame(at.geometric_normal, u, v);
                    const double phi = random.between(0.0, 6.283185307179586);
                    ray.direction = (u * std::cos(phi) + v * std::sin(phi) + at.geometric_normal * random.between(-0.0199, 0.0199)).normalized();
                    ray.origin = at.position - ray.direction * (0.3 * size * random() * random());
                } else {
                    ray.direction = random.direction();
                    ray.origin = at.position - ray.direction * (0.01 * size * random());
                }
            }
        }
        if (random() < 0.1) ray.t_max = size * random() + 1e-9;
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace hoodoo::testing
