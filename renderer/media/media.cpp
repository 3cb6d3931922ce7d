// Several media at once: each has its own random collision, and the first of them is the collision of their sum, since independent exponentials race
// (Poisson processes superpose). Regions are grey, so their collisions are exact and weigh their albedo; the even medium then flies as far as the
// nearest of those. Missing: regions that are displaced by the body they float in; a body inside another body keeps the inner one's medium alone.
#include "renderer/media/media.h"

#include <algorithm>

namespace hoodoo
{

Passage Media::pass(const Ray& ray, double t_max, const Interior* inside, const Vec2d& u, NumberStream& random) const
{
    Passage way{t_max, false, Vec3f(1.0f), 0.0};
    const Region* met = nullptr;
    for (const Region& region : regions) {
        if (const auto t = region.collide(ray, way.t, random)) {
            way.t = *t;
            met = &region;
        }
    }

    Flight flight;
    double asymmetry = 0.0;
    if (inside) {
        flight = fly(inside->medium, way.t, u);
        asymmetry = inside->medium.asymmetry;
        if (flight.scattered) way.t = flight.column;
    } else if (haze) {
        flight = fly(haze->medium(), haze->column(ray.origin, ray.direction, way.t), u);
        asymmetry = haze->medium().asymmetry;
        if (flight.scattered) way.t = std::min(way.t, haze->distance(ray.origin, ray.direction, flight.column));
    }
    way.weight = flight.weight;
    way.scattered = flight.scattered || met;
    way.asymmetry = asymmetry;
    if (met && !flight.scattered) {
        way.weight *= met->material().albedo;
        way.asymmetry = met->material().asymmetry;
    }
    return way;
}

Vec3f Media::transmittance(const Ray& ray, double t_max, const Interior* inside, NumberStream& random) const
{
    Vec3f share(1.0f);
    if (inside)
        share = hoodoo::transmittance(inside->medium, t_max);
    else if (haze)
        share = hoodoo::transmittance(haze->medium(), haze->column(ray.origin, ray.direction, t_max));
    for (const Region& region : regions) {
        if (share == Vec3f(0.0f)) break;
        share *= static_cast<float>(region.transmittance(ray, t_max, random));
    }
    return share;
}

std::uint64_t Media::samples_above_bound() const
{
    std::uint64_t sum = 0;
    for (const Region& region : regions) sum += region.samples_above_bound();
    return sum;
}

}  // namespace hoodoo
