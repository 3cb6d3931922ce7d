// Heights against their own bounds, at random points of random areas.
#include "tests/support/height_laws.h"

#include "tests/support/numbers.h"

#include <fmt/format.h>

namespace hoodoo::testing
{
namespace
{

constexpr double kRounding = 1e-9;  // of heights, relative to their own size and the point's

Verdict fault(const Vec2d& p, const std::string& what, double got, double bound)
{
    return {fmt::format("at ({:.17g}, {:.17g}): {} {:.9g}, bound {:.9g}", p.x, p.y, what, got, bound)};
}

Vec2d in_area(Numbers& random, const Box2d& area)
{
    const double u = random(), v = random();
    return {area.min.x + u * (area.max.x - area.min.x), area.min.y + v * (area.max.y - area.min.y)};
}

/// Differences on the four sides. Where they agree with each other there is no crease near, and the gradient must agree with them.
Verdict gradient_agrees(const Height& height, const Vec2d& p, double step, double slope)
{
    const double h = height.height(p);
    const Vec2d g = height.gradient(p);
    for (int k = 0; k < 2; ++k) {
        Vec2d d(0.0);
        d[k] = step;
        const double up = (height.height(p + d) - h) / step, down = (h - height.height(p - d)) / step;
        const double noise = 1e-5 * (1.0 + slope) + 4e-16 * std::abs(h) / step;
        if (std::abs(up - down) > noise) continue;
        if (std::abs(g[k] - 0.5 * (up + down)) > 4.0 * noise) return fault(p, "gradient off its difference by", std::abs(g[k] - up), noise);
    }
    return {};
}

}  // namespace

Verdict height_bounds_hold(const Height& height, const Box2d& where, std::uint64_t seed, int count)
{
    const double size = (where.max - where.min).length();
    for (int n = 0; n < count; ++n) {
        Numbers random(seed, static_cast<std::uint64_t>(n));
        const Vec2d corner = in_area(random, where);
        const double length = size * std::pow(10.0, -5.0 * random());
        Box2d area(corner);
        area.extendBy(corner + Vec2d(random(), random()) * length);
        const Interval range = height.range(area);
        const double slope = height.slope_bound(area), curvature = height.curvature_bound(area);
        const std::array<Interval, 2> gradients = height.gradient_range(area);
        for (int k = 0; k < 12; ++k) {
            const Vec2d p = in_area(random, area), q = in_area(random, area);
            const double hp = height.height(p), hq = height.height(q), rounding = kRounding * (1.0 + std::abs(hp)), apart = (p - q).length();
            if (hp < range.lo - rounding || hp > range.hi + rounding)
                return fault(p, "height outside its range", hp, hp < range.lo ? range.lo : range.hi);
            if (std::abs(hp - hq) > slope * apart + rounding) return fault(p, "slope", std::abs(hp - hq) / apart, slope);
            const Vec2d gp = height.gradient(p), gq = height.gradient(q);
            for (int axis = 0; axis < 2; ++axis) {
                const Interval& g = gradients[static_cast<std::size_t>(axis)];
                if (gp[axis] < g.lo - kRounding * (1.0 + slope) || gp[axis] > g.hi + kRounding * (1.0 + slope))
                    return fault(p, "gradient outside its range", gp[axis], g.hi);
            }
            if ((gp - gq).length() > curvature * apart + kRounding * (1.0 + slope))
                return fault(p, "curvature", (gp - gq).length() / apart, curvature);
        }
        const Verdict agrees = gradient_agrees(height, in_area(random, area), 1e-6 * size, slope);
        if (!agrees.holds()) return agrees;
    }
    return {};
}

}  // namespace hoodoo::testing
