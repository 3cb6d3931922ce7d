// Rays aimed at points of the surface, which bisection along random verticals finds.

#include "tests/support/test_rays.h"

#include "tests/support/numbers.h"

#include <cmath>

namespace hoodoo::testing
{
namespace
{

/// A crossing on a random segment of the terrain; the segment's upper end if it has none.
Vec3d surface_point(const ConvolutionField& field, Numbers& random)
{
    const MaterialStack& stack = field.ground().stack();
    const Vec3d size(stack.size().x * stack.cell(), stack.size().y * stack.cell(), stack.highest_top() * stack.unit());
    const double sigma = field.sigma();
    for (int attempt = 0;; ++attempt) {
        const auto anywhere = [&] {
            return stack.origin() + Vec3d(random.between(0.0, size.x), random.between(0.0, size.y), random.between(-sigma, size.z + sigma));
        };
        Vec3d air = anywhere(), matter = anywhere();
        if (attempt > 60) return air;
        // A point of air and one of matter, close together: then the crossing is as likely under a ledge as on top.
        matter = air + (matter - air) * (0.2 * random());
        if (field.value(air) < 0.0) std::swap(air, matter);
        if (!(field.value(air) > 0.0 && field.value(matter) < 0.0)) continue;
        for (int k = 0; k < 50; ++k) {
            const Vec3d m = (air + matter) * 0.5;
            (field.value(m) < 0.0 ? matter : air) = m;
        }
        return air;
    }
}

/// Snaps a coordinate to a plane where the field bends.
double snap(double x, double origin, double cell, double sigma, double pick)
{
    const double k = std::round((x - origin) / cell);
    return origin + k * cell + (pick < 0.34 ? 0.0 : pick < 0.67 ? sigma : -sigma);
}

}  // namespace

Ray test_ray(const ConvolutionField& field, std::uint64_t seed, std::uint64_t n)
{
    Numbers random(hash_cell(seed, static_cast<std::int64_t>(n), 1));
    const MaterialStack& stack = field.ground().stack();
    const double sigma = field.sigma(), reach = 0.5 * stack.size().x * stack.cell();
    Ray ray;
    ray.crossing = random() < 0.5 ? Crossing::any : Crossing::entering;
    const Vec3d target = surface_point(field, random);
    ray.direction = random.direction();
    double back = reach * std::pow(random(), 2.0);
    switch (n % 10) {
        case 0:
        case 1:
        case 2: {
            const Vec3d normal = field.gradient(target).normalized();
            Vec3d u, v;
            if (normal.length() < 0.5) break;
            orthonormal_frame(normal, u, v);
            const double phi = random.between(0.0, 6.283185307179586);
            ray.direction = (u * std::cos(phi) + v * std::sin(phi) + normal * random.between(-0.0199, 0.0199)).normalized();
            break;
        }
        case 3:
            back = sigma * random();
            break;
        case 4: {
            // Along an axis, or in a lattice plane; through the point or snapped to the plane's own line.
            const int axis = static_cast<int>(3.0 * random());
            if (random() < 0.5) {
                ray.direction = Vec3d(0.0);
                ray.direction[axis] = random() < 0.5 ? 1.0 : -1.0;
            } else {
                ray.direction[axis] = 0.0;
                ray.direction = ray.direction.normalized();
            }
            break;
        }
        default:
            break;
    }
    ray.origin = target - ray.direction * back;
    if (n % 10 == 4) {
        for (int k = 0; k < 3; ++k) {
            if (ray.direction[k] != 0.0 || random() < 0.3) continue;
            ray.origin[k] = k < 2 ? snap(ray.origin[k], stack.origin()[k], stack.cell(), sigma, random())
                                  : stack.origin().z + stack.unit() * std::round((ray.origin.z - stack.origin().z) / stack.unit());
        }
    }
    if (random() < 0.1) ray.t_max = back * random.between(0.5, 1.5) + 1e-9;
    return ray;
}

}  // namespace hoodoo::testing
