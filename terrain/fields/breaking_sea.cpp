// Swell plus what breaking waves make of it (Gamito2001, section 4.2): each wave is a cross-section (wave_profile.h) carried along its crest, whose
// intensity T(y, t) grows as the break runs along it.
//   t0(y) = start + (sqrt(y^2 + w^2) - w) / peel;  T = Tmax S((t - t0) / steepening);  c = S((t - t0 - steepening) / collapse),  S a smoothstep;
//   F_wave = z0 + d - eta(P0),  P0 the place the water came from, at the branch that holds water (the union of both);
//   F_bore = z - level - eta(P) - H exp(-tau / decay) exp(-x^2 / b^2):  white water that runs on after the fall, tau the time since it began;
//   F = (z - level - eta(P)) + sum over the waves of  (1 - c) (F_wave - (z - level - eta(P))) - c H exp(-tau / decay) exp(-x^2 / b^2).
// The swell obeys deep water's dispersion, omega^2 = g k. Deviations: the paper stops before the wave falls; collapse and decay are ours.
// Bounds: intervals of every factor; the value also by its middle and the gradient. Second derivatives by norms; none across the edge where one
// branch takes over from the other inside water (the seam above the centre is C1 and has them).
#include "terrain/fields/breaking_sea.h"

#include "terrain/math/smoothstep.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 1e-12;

/// Half-width of the white water, as a share of the outer radius.
double bore_width(const Breaker& b)
{
    return 0.35 * b.shape.outer;
}

/// Local axes: x against the heading, y along the crest.
struct Frame {
    Vec2d x, y;
};
Frame frame_of(const Breaker& b)
{
    return {-b.heading, Vec2d(b.heading.y, -b.heading.x)};
}

/// Range of a . p over a rectangle.
Interval along(const Vec2d& a, const Interval& x, const Interval& y)
{
    return x.scaled(a.x) + y.scaled(a.y);
}

}  // namespace

struct BreakingSea::Life {
    double duration, duration_y, duration_t;  ///< T and its derivatives
    double fallen, fallen_y, fallen_t;        ///< c
    double white, white_y, white_t;           ///< H exp(-tau / decay)
};

struct BreakingSea::LifeBound {
    Interval duration, fallen, white;
    double duration_y = 0.0, duration_yy = 0.0, fallen_y = 0.0, fallen_yy = 0.0, white_y = 0.0, white_yy = 0.0;
};

BreakingSea::BreakingSea(std::vector<Breaker> breakers, Swells swell, double level)
    : breakers_(std::move(breakers)), swell_(std::move(swell)), level_(level)
{
}

BreakingSea::Life BreakingSea::life(const Breaker& b, double y, double t)
{
    const double root = std::sqrt(y * y + b.peel_width * b.peel_width);
    const double since = t - b.start - (root - b.peel_width) / b.peel, delay = y / root / b.peel;  // d(since)/dy = -delay
    Life l{};
    const double a = since / b.steepening, k = smoothstep_slope(a) * b.intensity / b.steepening;
    l.duration = b.intensity * smoothstep(a);
    l.duration_t = k;
    l.duration_y = -k * delay;
    const double tau = since - b.steepening, c = smoothstep_slope(tau / b.collapse) / b.collapse;
    l.fallen = smoothstep(tau / b.collapse);
    l.fallen_t = c;
    l.fallen_y = -c * delay;
    l.white = b.bore * std::exp(-std::max(0.0, tau) / b.decay);
    l.white_t = tau > 0.0 ? -l.white / b.decay : 0.0;
    l.white_y = -l.white_t * delay;
    return l;
}

BreakingSea::LifeBound BreakingSea::life_bound(const Breaker& b, const Interval& y, const Interval& times)
{
    const double near = std::max({0.0, y.lo, -y.hi}), far = y.magnitude();
    const auto lag = [&](double d) { return (std::sqrt(d * d + b.peel_width * b.peel_width) - b.peel_width) / b.peel; };
    const double size = kRounding * (1.0 + times.magnitude() + std::abs(b.start) + lag(far));
    const Interval since{times.lo - b.start - lag(far) - size, times.hi - b.start - lag(near) + size};
    const double delay = far / std::sqrt(far * far + b.peel_width * b.peel_width) / b.peel, delay_slope = 1.0 / (b.peel_width * b.peel);
    LifeBound l;
    const Interval a = since.scaled(1.0 / b.steepening), c = Interval{since.lo - b.steepening, since.hi - b.steepening}.scaled(1.0 / b.collapse);
    l.duration = {b.intensity * smoothstep(a.lo), b.intensity * smoothstep(a.hi)};
    l.fallen = {smoothstep(c.lo), smoothstep(c.hi)};
    const auto bend = [](const Interval& i) { return i.hi <= 0.0 || i.lo >= 1.0 ? 0.0 : 6.0; };
    const double k = b.intensity / b.steepening;
    l.duration_y = k * smoothstep_steepest(a) * delay;
    l.duration_yy = k * (bend(a) / b.steepening * delay * delay + smoothstep_steepest(a) * delay_slope);
    l.fallen_y = smoothstep_steepest(c) / b.collapse * delay;
    l.fallen_yy = (bend(c) / b.collapse * delay * delay + smoothstep_steepest(c) * delay_slope) / b.collapse;
    l.white = {b.bore * std::exp(-std::max(0.0, since.hi - b.steepening) / b.decay),
               b.bore * std::exp(-std::max(0.0, since.lo - b.steepening) / b.decay)};
    l.white_y = l.white.hi / b.decay * delay;
    l.white_yy = l.white.hi / b.decay * (delay * delay / b.decay + delay_slope);
    return l;
}

BreakingSea::Deviation BreakingSea::deviation(const Breaker& b, const Vec3d& p, double t) const
{
    const Frame frame = frame_of(b);
    const Vec2d flat(p.x, p.y), centre = b.centre + b.heading * (b.speed * t);
    const double x = frame.x.dot(flat - centre), y = frame.y.dot(flat - centre), z = p.z - level_ - b.shape.depth;
    const Life l = life(b, y, t);
    Deviation out;
    out.rest = p;
    if (l.duration == 0.0) return out;
    const WaveProfile profile(b.shape);

    // The branch that holds water.
    WaveOrigin o = profile.circular({x, z}, l.duration);
    const auto place = [&](const WaveOrigin& from) { return centre + frame.x * from.at.x + frame.y * y; };
    const auto level = [&](const WaveOrigin& from) { return from.at.y + b.shape.depth - swell_.at(place(from), t).height; };
    if (x < 0.0) {
        const WaveOrigin fallen = profile.parabolic({x, z}, l.duration);
        if (level(fallen) < level(o)) o = fallen;
    }
    const Vec2d where = place(o);
    const Swells::Height there = swell_.at(where, t), here = swell_.at(flat, t);
    const double eta_x = there.slope.dot(frame.x), eta_y = there.slope.dot(frame.y);
    const Vec2d by(o.by_x.y - eta_x * o.by_x.x, o.by_z.y - eta_x * o.by_z.x);  // of F_wave by local x and z
    const double by_duration = o.by_duration.y - eta_x * o.by_duration.x;
    const double wave = o.at.y + b.shape.depth - there.height, calm = p.z - level_ - here.height, apart = wave - calm;
    const Vec2d wave_flat = frame.x * by.x + frame.y * (by_duration * l.duration_y - eta_y);
    // x grows by `speed` in a second as the frame moves on; the place the water came from moves with the frame.
    const double moved = there.slope.dot(b.heading) * b.speed;
    const double apart_t = by.x * b.speed + by_duration * l.duration_t - there.by_time - moved + here.by_time;

    const double width = bore_width(b), bump = std::exp(-x * x / (width * width)), bump_x = -2.0 * x / (width * width) * bump;
    const double white = l.white * bump, keep = 1.0 - l.fallen;
    out.value = keep * apart - l.fallen * white;
    const Vec2d flat_gradient = (wave_flat + here.slope) * keep - frame.x * (l.fallen * l.white * bump_x) -
                                frame.y * (l.fallen * l.white_y * bump + l.fallen_y * (apart + white));
    out.gradient = Vec3d(flat_gradient.x, flat_gradient.y, keep * (by.y - 1.0));
    out.by_time = keep * apart_t - l.fallen * (l.white_t * bump + l.white * bump_x * b.speed) - l.fallen_t * (apart + white);
    out.rest = Vec3d(where.x, where.y, level_ + b.shape.depth + o.at.y);
    out.falling = o.falling;
    out.strength = keep * l.duration * profile.speed(std::hypot(x, z));
    return out;
}

LocalField BreakingSea::deviation_bound(const Breaker& b, const Box3d& box, const Interval& times) const
{
    const Frame frame = frame_of(b);
    const Interval wx{box.min.x, box.max.x}, wy{box.min.y, box.max.y};
    const double from = frame.x.dot(b.centre), side = frame.y.dot(b.centre);
    const Interval x = along(frame.x, wx, wy) + Interval{b.speed * times.lo - from, b.speed * times.hi - from};
    Interval y = along(frame.y, wx, wy);
    y = {y.lo - side, y.hi - side};
    const double origin = level_ + b.shape.depth;
    const Interval z{box.min.z - origin, box.max.z - origin};
    const LifeBound l = life_bound(b, y, times);
    LocalField out;
    out.value = {0.0, 0.0};
    out.gradient = {Interval{0, 0}, Interval{0, 0}, Interval{0, 0}};
    out.curvature = 0.0;
    if (l.duration.hi == 0.0) return out;
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
    const double width = bore_width(b), near = std::max({0.0, x.lo, -x.hi});
    const Interval bump{std::exp(-std::pow(x.magnitude() / width, 2)), std::exp(-near * near / (width * width))};
    const double bump_x = std::min(0.8578 / width, 2.0 * x.magnitude() / (width * width) * bump.hi), bump_xx = 2.0 / (width * width);
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

double BreakingSea::value(const Vec3d& p, double t) const
{
    double sum = p.z - level_ - swell_.at({p.x, p.y}, t).height;
    for (const Breaker& b : breakers_) sum += deviation(b, p, t).value;
    return sum;
}

Vec3d BreakingSea::gradient(const Vec3d& p, double t, double* by_time) const
{
    const Swells::Height here = swell_.at({p.x, p.y}, t);
    Vec3d sum(-here.slope.x, -here.slope.y, 1.0);
    double change = -here.by_time;
    for (const Breaker& b : breakers_) {
        const Deviation d = deviation(b, p, t);
        sum += d.gradient;
        change += d.by_time;
    }
    if (by_time) *by_time = change;
    return sum;
}

LocalField BreakingSea::local(const Box3d& box, const Interval& times) const
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
    if (times.lo == times.hi) {
        const Vec3d half = box.size() * 0.5;
        const double centre = value(box.center(), times.lo);
        double reach = rounding;
        for (int k = 0; k < 3; ++k) reach += (sum.gradient[static_cast<std::size_t>(k)]).magnitude() * half[k];
        sum.value = Interval::common(sum.value, {centre - reach, centre + reach});
    }
    return sum;
}

Vec3d BreakingSea::rest(const Vec3d& p, double t, double* falling) const
{
    Vec3d place = p;
    double strongest = 0.0, since = 0.0;
    for (const Breaker& b : breakers_) {
        const Deviation d = deviation(b, p, t);
        if (!(d.strength > strongest)) continue;
        strongest = d.strength;
        place = d.rest;
        since = d.falling;
    }
    if (falling) *falling = since;
    return place;
}

Interval BreakingSea::heights() const
{
    double highest = 0.0, lowest = 0.0;
    for (const Breaker& b : breakers_) {
        // Circles keep the depth as their least radius of water at rest; a particle rises to its own radius at most, and falls as deep.
        highest = std::max(highest, b.shape.outer + b.shape.depth);
        lowest = std::max(lowest, b.shape.outer);
    }
    return {level_ - swell_.amplitude() - lowest, level_ + swell_.amplitude() + highest};
}

}  // namespace hoodoo
