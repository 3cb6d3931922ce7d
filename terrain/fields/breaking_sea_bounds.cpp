// Enclosures of the breaking sea over boxes of space and time (breaking_sea.cpp has the function).
// Intervals of every factor; the value also by its middle and the gradient. Second derivatives by norms; none across the edge where one branch takes
// over from the other inside water (the seam above the centre is C1 and has them).
#include "terrain/fields/breaking_sea.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 1e-12;

/// Range of a . p over a rectangle.
Interval along(const Vec2d& a, const Interval& x, const Interval& y)
{
    return x.scaled(a.x) + y.scaled(a.y);
}

/// A box in a breaker's own axes, over all times.
struct LocalBox {
    Interval x, y, z;
};

LocalBox local_box(const Breaker& b, const Box3d& box, const Interval& times, double level)
{
    const Interval wx{box.min.x, box.max.x}, wy{box.min.y, box.max.y};
    const double from = b.across().dot(b.centre), side = b.along().dot(b.centre), origin = level + b.shape.depth;
    const Interval y = along(b.along(), wx, wy);
    return {along(b.across(), wx, wy) + Interval{b.speed * times.lo - from, b.speed * times.hi - from},
            {y.lo - side, y.hi - side},
            {box.min.z - origin, box.max.z - origin}};
}

}  // namespace

BreakerPointBound BreakingSea::point_bound(const Breaker& b, const Box3d& box, const Interval& times) const
{
    const LocalBox in = local_box(b, box, times, level_);
    BreakerPointBound out;
    out.x = in.x, out.y = in.y, out.z = in.z;
    out.life = life_bound(b, in.y, times);
    const WaveProfile profile(b.shape);
    const double swell = swell_.amplitude(), size = kRounding * (1.0 + in.x.magnitude() + in.z.magnitude());
    const auto level = [&](const WaveBound& w) { return Interval{w.z0.lo + b.shape.depth - swell - size, w.z0.hi + b.shape.depth + swell + size}; };
    if (in.x.hi >= 0.0) out.turned = level(profile.circular_bound({std::max(in.x.lo, 0.0), in.x.hi}, in.z, out.life.duration));
    if (in.x.lo < 0.0) {
        const Interval part{in.x.lo, std::min(in.x.hi, 0.0)};
        const Interval turned = level(profile.circular_bound(part, in.z, out.life.duration));
        const WaveBound flown = profile.parabolic_bound(part, in.z, out.life.duration);
        out.turned = in.x.hi >= 0.0 ? Interval::hull(out.turned, turned) : turned;
        out.flown = level(flown);
        out.flown_x0 = flown.x0;
    }
    return out;
}

LocalField BreakingSea::deviation_bound(const Breaker& b, const Box3d& box, const Interval& times) const
{
    const Interval wx{box.min.x, box.max.x}, wy{box.min.y, box.max.y};
    const LocalBox in = local_box(b, box, times, level_);
    const Interval &x = in.x, &y = in.y, &z = in.z;
    const struct {
        Vec2d x, y;
    } frame{b.across(), b.along()};
    const BreakerBound l = life_bound(b, y, times);
    LocalField out;
    out.value = {0.0, 0.0};
    out.gradient = {Interval{0, 0}, Interval{0, 0}, Interval{0, 0}};
    out.curvature = 0.0;
    if (l.duration.hi == 0.0 || x.lo >= b.shape.outer) return out;
    const WaveProfile profile(b.shape);

    // Each branch over its part of the box.
    struct Part {
        Interval value, by_x, by_z, by_duration, eta_y;
        double curvature, y_curvature;
    };
    const Vec2d heading = b.heading;
    const auto part = [&](const WaveBound& w) {
        // Where the water came from, in the world: centre(t) + x0 frame.x + y frame.y, around the box's own middle.
        const Interval shift{b.speed * times.lo, b.speed * times.hi};
        const auto axis = [&](int k) {
            return Interval{b.centre[k], b.centre[k]} + shift.scaled(heading[k]) + w.x0.scaled(frame.x[k]) + y.scaled(frame.y[k]);
        };
        const Swells::Bound eta = swell_.bound(axis(0), axis(1), times);
        const Interval ex = eta.slope[0].scaled(frame.x.x) + eta.slope[1].scaled(frame.x.y);
        Part out;
        out.eta_y = eta.slope[0].scaled(frame.y.x) + eta.slope[1].scaled(frame.y.y);
        out.value = w.z0 + Interval{b.shape.depth, b.shape.depth} + -eta.height;
        out.by_x = w.by_x[1] + -(ex * w.by_x[0]);
        out.by_z = w.by_z[1] + -(ex * w.by_z[0]);
        out.by_duration = w.by_duration[1] + -(ex * w.by_duration[0]);
        const double e = ex.magnitude(), gx = std::hypot(w.by_x[0].magnitude(), w.by_z[0].magnitude()), gt = w.by_duration[0].magnitude();
        const double ty = l.duration_y;
        out.curvature = swell_.empty() ? w.second : w.second * (1.0 + e) + eta.second * gx * gx;
        if (w.x0_bends && !swell_.empty()) out.curvature = kInfinity;
        // Everything that has a derivative along the crest in it.
        const double cross = w.duration_slope * (1.0 + e) + eta.second * gx * gt, twice = w.duration_second * (1.0 + e) + eta.second * gt * gt;
        const double mixed = ty > 0.0 ? 2.0 * cross * ty + twice * ty * ty : 0.0;
        out.y_curvature = mixed + out.by_duration.magnitude() * l.duration_yy + eta.second * (2.0 * gx + 2.0 * gt * ty + 1.0);
        return out;
    };
    const auto hull = [](const Part& a, const Part& b) {
        return Part{Interval::hull(a.value, b.value),      Interval::hull(a.by_x, b.by_x),
                    Interval::hull(a.by_z, b.by_z),        Interval::hull(a.by_duration, b.by_duration),
                    Interval::hull(a.eta_y, b.eta_y),      std::max(a.curvature, b.curvature),
                    std::max(a.y_curvature, b.y_curvature)};
    };
    Part all{};
    bool first = true;
    enum { none, turning, flying, either } left = none, right = none;
    if (x.hi >= 0.0) {
        all = part(profile.circular_bound({std::max(x.lo, 0.0), x.hi}, z, l.duration));
        first = false;
        right = turning;
    }
    if (x.lo < 0.0) {
        const Interval part_x{x.lo, std::min(x.hi, 0.0)};
        const Part turned = part(profile.circular_bound(part_x, z, l.duration)), flown = part(profile.parabolic_bound(part_x, z, l.duration));
        left = flown.value.lo >= turned.value.hi ? turning : turned.value.lo >= flown.value.hi ? flying : either;
        Part least = left == turning ? turned : left == flying ? flown : hull(turned, flown);
        least.value = {std::min(turned.value.lo, flown.value.lo), std::min(turned.value.hi, flown.value.hi)};
        all = first ? least : hull(all, least);
    }
    // Across x = 0 the branches meet smoothly as long as each side is on its own: the parabola above the centre, the circle below.
    const bool smooth_seam = left == none || right == none || (left == flying && z.lo > 0.0) || (left == turning && z.hi < 0.0);
    if (left == either || !smooth_seam) all.curvature = kInfinity;

    const Swells::Bound here = swell_.bound(wx, wy, times);
    const Interval calm = Interval{box.min.z - level_, box.max.z - level_} + -here.height, apart = all.value + -calm;
    // Of the section of the white water: the slope is steepest at R1 / sqrt(15), 16 / sqrt(15) (14 / 15)^7 / R1; it bends most in its middle.
    const double near = std::max({0.0, x.lo, -x.hi}), outer = b.shape.outer;
    const Interval bump{b.bump(x.magnitude()), b.bump(near)};
    const double bump_x = near >= outer ? 0.0 : 2.5494 / outer, bump_xx = near >= outer ? 0.0 : 16.0 / (outer * outer);
    const Interval keep{1.0 - l.fallen.hi, 1.0 - l.fallen.lo}, white = l.white * bump;
    out.value = keep * apart + -(l.fallen * white);

    const Interval dy =
        all.by_duration.scaled(0.0) + Interval{-all.by_duration.magnitude() * l.duration_y, all.by_duration.magnitude() * l.duration_y} + -all.eta_y;
    const double sway = l.fallen.hi * l.white.hi * bump_x, drift = l.fallen.hi * l.white_y * bump.hi + l.fallen_y * (apart + white).magnitude();
    for (int k = 0; k < 2; ++k) {
        const Interval wave = all.by_x.scaled(frame.x[k]) + dy.scaled(frame.y[k]) + here.slope[k];
        const double more = std::abs(frame.x[k]) * sway + std::abs(frame.y[k]) * drift;
        out.gradient[static_cast<std::size_t>(k)] = keep * wave + Interval{-more, more};
    }
    out.gradient[2] = keep * Interval{all.by_z.lo - 1.0, all.by_z.hi - 1.0};

    double bend = all.curvature + all.y_curvature + here.second;
    if (l.fallen.hi > 0.0) {
        const double steep = std::sqrt(std::pow(all.by_x.magnitude() + here.slope[0].magnitude() + here.slope[1].magnitude() + dy.magnitude(), 2) +
                                       std::pow(all.by_z.magnitude() + 1.0, 2));
        bend += l.fallen.hi * (l.white.hi * bump_xx + 2.0 * l.white_y * bump_x + l.white_yy * bump.hi) +
                2.0 * l.fallen_y * (steep + l.white.hi * bump_x + l.white_y) + l.fallen_yy * (apart + white).magnitude();
    }
    out.curvature = bend;
    return out;
}

LocalField BreakingSea::sum_of_bounds(const Box3d& box, const Interval& times) const
{
    const Swells::Bound here = swell_.bound({box.min.x, box.max.x}, {box.min.y, box.max.y}, times);
    LocalField sum;
    sum.value = Interval{box.min.z - level_, box.max.z - level_} + -here.height;
    sum.gradient = {-here.slope[0], -here.slope[1], Interval{1.0, 1.0}};
    sum.curvature = here.second;
    for (const Breaker& b : breakers_) {
        const LocalField d = deviation_bound(b, box, times);
        sum.value = sum.value + d.value;
        for (std::size_t k = 0; k < 3; ++k) sum.gradient[k] = sum.gradient[k] + d.gradient[k];
        sum.curvature += d.curvature;
    }
    const double rounding = kRounding * (1.0 + sum.value.magnitude() + Interval{box.min.z, box.max.z}.magnitude());
    sum.value = {sum.value.lo - rounding, sum.value.hi + rounding};
    return sum;
}

LocalField BreakingSea::local(const Box3d& box, const Interval& times) const
{
    LocalField sum = sum_of_bounds(box, times);
    sum.mixed = 0.0;
    sum.upright = sum.curvature;
    // The mean value theorem: from the centre, over all times, no further than the gradient allows.
    const Vec3d half = box.size() * 0.5, middle = box.center();
    sum.centre = value(middle, 0.5 * (times.lo + times.hi));
    const Interval there = times.lo == times.hi ? Interval{sum.centre, sum.centre} : sum_of_bounds(Box3d(middle), times).value;
    const double rounding = kRounding * (1.0 + std::abs(sum.centre) + Interval{box.min.z, box.max.z}.magnitude());
    double reach = rounding;
    for (int k = 0; k < 3; ++k) reach += sum.gradient[static_cast<std::size_t>(k)].magnitude() * half[k];
    sum.value = Interval::common(sum.value, {there.lo - reach, there.hi + reach});
    sum.sway = std::max(there.hi - sum.centre, sum.centre - there.lo) + rounding;
    return sum;
}

}  // namespace hoodoo
