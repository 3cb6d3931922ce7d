// Swell plus what breaking waves make of it (Gamito2001, section 4.2): each wave is a cross-section (wave_profile.h) carried along its crest, whose
// intensity T(y, t) grows as the break runs along it (breaker.h).
//   F_wave = z0 + d - eta(P0),  P0 the place the water came from, at the branch that holds water (the union of both);
//   F_bore = z - level - eta(P) - H exp(-tau / decay) B(x):  white water that runs on after the fall, tau the time since it began, B its
//   section;
//   F = (z - level - eta(P)) + sum over the waves of  (1 - c) (F_wave - (z - level - eta(P))) - c H exp(-tau / decay) B(x).
// The swell obeys deep water's dispersion, omega^2 = g k. Deviations: the paper stops before the wave falls; collapse and decay are ours.
// The bounds are in breaking_sea_bounds.cpp.
#include "terrain/fields/breaking_sea.h"

#include "terrain/fields/sea_kernel.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

BreakingSea::BreakingSea(std::vector<Breaker> breakers, Swells swell, double level)
    : breakers_(std::move(breakers)), swell_(std::move(swell)), level_(level)
{
}

BreakerPoint BreakingSea::point(const Breaker& b, const Vec3d& p, double t) const
{
    const Vec2d flat = Vec2d(p.x, p.y) - b.centre_at(t);
    BreakerPoint at;
    at.local = Vec3d(b.across().dot(flat), b.along().dot(flat), p.z - level_ - b.shape.depth);
    at.life = life(b, at.local.y, t);
    const WaveProfile profile(b.shape);
    const Vec2d section(at.local.x, at.local.z);
    const auto level = [&](const WaveOrigin& from) {
        const Vec2d place = b.centre_at(t) + b.across() * from.at.x + b.along() * at.local.y;
        return from.at.y + b.shape.depth - swell_.at(place, t).height;
    };
    at.origin = profile.circular(section, at.life.duration);
    at.turned = level(at.origin);
    if (section.x >= 0.0) return at;
    at.flying = profile.parabolic(section, at.life.duration);
    at.flown = level(at.flying);
    if (at.flown < at.turned) at.origin = at.flying;
    return at;
}

double BreakingSea::deviation_value(const Breaker& b, const Vec3d& p, double t, double calm) const
{
    const Vec2d centre = b.centre_at(t), flat = Vec2d(p.x, p.y) - centre;
    const double x = b.across().dot(flat), y = b.along().dot(flat);
    // Behind it nothing has turned or flown.
    if (x >= b.shape.outer) return 0.0;
    const BreakerLife l = life(b, y, t);
    if (l.duration == 0.0) return 0.0;
    double sum = 0.0;
    if (l.fallen < 1.0) {
        const WaveProfile profile(b.shape);
        const Vec2d section(x, p.z - level_ - b.shape.depth), side = centre + b.along() * y;
        const double highest = swell_.amplitude();
        const auto level = [&](const Vec2d& from) {
            return from.y + b.shape.depth - (swell_.empty() ? 0.0 : swell_.height(side + b.across() * from.x, t));
        };
        // Beyond the outer radius nothing has turned; no water has flown that far either, since a parabola's points are above its radius.
        double wave = section.length() >= b.shape.outer ? calm : level(profile.circular_place(section, l.duration));
        if (x < 0.0) {
            const Vec2d from = profile.parabolic_place(section, l.duration);
            // Only where some swell could make it the deeper one.
            if (from.y + b.shape.depth - highest < wave) wave = std::min(wave, level(from));
        }
        sum = (1.0 - l.fallen) * (wave - calm);
    }
    if (l.fallen > 0.0) sum -= l.fallen * l.white * b.bump(x);
    return sum;
}

BreakingSea::Deviation BreakingSea::deviation(const Breaker& b, const Vec3d& p, double t) const
{
    Deviation out;
    const BreakerPoint at = point(b, p, t);
    const BreakerLife& l = at.life;
    if (l.duration == 0.0) return out;
    const WaveOrigin& o = at.origin;
    const Vec2d across = b.across(), along = b.along(), flat(p.x, p.y);
    const Swells::Height there = swell_.at(b.centre_at(t) + across * o.at.x + along * at.local.y, t), here = swell_.at(flat, t);
    const double eta_x = there.slope.dot(across), eta_y = there.slope.dot(along);
    const Vec2d by(o.by_x.y - eta_x * o.by_x.x, o.by_z.y - eta_x * o.by_z.x);  // of F_wave by local x and z
    const double by_duration = o.by_duration.y - eta_x * o.by_duration.x;
    const double wave = std::min(at.turned, at.flown), calm = p.z - level_ - here.height, apart = wave - calm;
    const Vec2d wave_flat = across * by.x + along * (by_duration * l.duration_y - eta_y);
    // x grows by `speed` in a second as the frame moves on; the place the water came from moves with the frame.
    const double moved = there.slope.dot(b.heading) * b.speed;
    const double apart_t = by.x * b.speed + by_duration * l.duration_t - there.by_time - moved + here.by_time;

    const double x = at.local.x, bump = b.bump(x), bump_x = b.bump_slope(x);
    const double white = l.white * bump, keep = 1.0 - l.fallen;
    out.value = keep * apart - l.fallen * white;
    const Vec2d flat_gradient = (wave_flat + here.slope) * keep - across * (l.fallen * l.white * bump_x) -
                                along * (l.fallen * l.white_y * bump + l.fallen_y * (apart + white));
    out.gradient = Vec3d(flat_gradient.x, flat_gradient.y, keep * (by.y - 1.0));
    out.by_time = keep * apart_t - l.fallen * (l.white_t * bump + l.white * bump_x * b.speed) - l.fallen_t * (apart + white);
    return out;
}

double BreakingSea::value(const Vec3d& p, double t) const
{
    const double calm = p.z - level_ - swell_.height({p.x, p.y}, t);
    double sum = calm;
    for (const Breaker& b : breakers_) sum += deviation_value(b, p, t, calm);
    return sum;
}

void BreakingSea::values(const Vec3d (&p)[8], double t, double* out) const
{
    SeaPoints at;
    for (int i = 0; i < SeaLanes::count; ++i) at.x[i] = p[i].x, at.y[i] = p[i].y, at.z[i] = p[i].z;
    sea_values({breakers_, swell_.trains(), swell_.fade(), swell_.amplitude(), level_}, at, t, out);
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

SeaRest BreakingSea::rest(const Vec3d& p, double t) const
{
    // Shares by the square of what moves, so that of two waves the nearer one counts, and where one has fallen, less of both.
    SeaRest out;
    out.point = p;
    double total = 0.0;
    struct Part {
        const Breaker* b;
        BreakerPoint at;
        double strength;
    };
    std::vector<Part> parts;
    for (const Breaker& b : breakers_) {
        const BreakerPoint at = point(b, p, t);
        const double moves = WaveProfile(b.shape).speed(std::hypot(at.local.x, at.local.z)) * at.life.duration;
        if (!(moves > 0.0) || at.life.fallen == 1.0) continue;
        parts.push_back({&b, at, moves * moves});
        total += moves * moves;
    }
    for (const Part& part : parts) {
        const Breaker& b = *part.b;
        const WaveOrigin& o = part.at.origin;
        const double share = part.strength / total * (1.0 - part.at.life.fallen), down = o.by_duration.y * part.at.life.duration_y;
        const Vec2d across = b.across(), along = b.along(), place = b.centre_at(t) + across * o.at.x + along * part.at.local.y;
        out.point += (Vec3d(place.x, place.y, level_ + b.shape.depth + o.at.y) - p) * share;
        // Of x0 and z0 in the world; the place along the crest stays.
        const Vec2d x0_flat = across * o.by_x.x + along * (o.by_duration.x * part.at.life.duration_y), z0_flat = across * o.by_x.y + along * down;
        for (int k = 0; k < 2; ++k) {
            const Vec2d flat = x0_flat * across[k] + along * along[k];
            Vec3d row(flat.x, flat.y, o.by_z.x * across[k]);
            row[k] -= 1.0;
            out.gradient[k] += row * share;
        }
        out.gradient[2] += Vec3d(z0_flat.x, z0_flat.y, o.by_z.y - 1.0) * share;
    }
    return out;
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
