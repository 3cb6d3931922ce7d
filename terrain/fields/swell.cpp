// A sum of cosines and its bounds: each cosine is known at the middle of what is asked for, and can change no more than its angle does.
// The fade is a product of two smoothsteps of the distances along x and y. Used by Gamito2001's waves (breaking_sea.cpp) as the calm sea.
#include "terrain/fields/swell.h"

#include "terrain/math/sincos.h"
#include "terrain/math/smoothstep.h"

namespace hoodoo
{

namespace
{

constexpr double kRounding = 1e-12;  ///< relative, of a few operations

}  // namespace

Swells::Swells(std::vector<Swell> trains, const SwellFade& fade) : trains_(std::move(trains)), fade_(fade)
{
    for (const Swell& s : trains_) amplitude_ += std::abs(s.amplitude);
}

Swells::Height Swells::at(const Vec2d& p, double t) const
{
    Height r;
    for (const Swell& s : trains_) {
        const SinCos angle = sin_cos(s.wave_number.dot(p) - s.frequency * t + s.phase);
        const double down = -s.amplitude * angle.sine;
        r.height += s.amplitude * angle.cosine;
        r.slope += s.wave_number * down;
        r.by_time -= s.frequency * down;
    }
    // The fade: a product of two smoothsteps of the distances along x and y.
    double weight = 1.0;
    Vec2d change(0.0);
    for (int k = 0; k < 2; ++k) {
        const double d = p[k] - fade_.centre[k], width = fade_.outer - fade_.inner, a = (std::abs(d) - fade_.inner) / width;
        const double w = 1.0 - smoothstep(a), slope = -smoothstep_slope(a) / width * (d < 0.0 ? -1.0 : 1.0);
        change = change * w;
        change[k] = weight * slope;
        weight *= w;
    }
    return {r.height * weight, r.slope * weight + change * r.height, r.by_time * weight};
}

double Swells::height(const Vec2d& p, double t) const
{
    double weight = 1.0, sum = 0.0;
    for (int k = 0; k < 2; ++k) weight *= 1.0 - smoothstep((std::abs(p[k] - fade_.centre[k]) - fade_.inner) / (fade_.outer - fade_.inner));
    if (weight == 0.0) return 0.0;
    for (const Swell& s : trains_) sum += s.amplitude * sin_cos(s.wave_number.dot(p) - s.frequency * t + s.phase).cosine;
    return sum * weight;
}

Swells::Bound Swells::bound(const Interval& x, const Interval& y, const Interval& times) const
{
    Bound r;
    const Vec2d middle(0.5 * (x.lo + x.hi), 0.5 * (y.lo + y.hi)), half(0.5 * (x.hi - x.lo), 0.5 * (y.hi - y.lo));
    const double t = 0.5 * (times.lo + times.hi), span = 0.5 * (times.hi - times.lo);
    double total = 0.0, slope = 0.0;
    for (const Swell& s : trains_) {
        // The cosine at the middle, give or take how far the angle goes; it can go no higher than one.
        const SinCos angle = sin_cos(s.wave_number.dot(middle) - s.frequency * t + s.phase);
        const double turn = std::abs(s.wave_number.x) * half.x + std::abs(s.wave_number.y) * half.y + std::abs(s.frequency) * span;
        const double a = std::abs(s.amplitude), k = s.wave_number.length();
        const auto about = [&](double value) {
            return Interval::common({value - std::min(turn, 2.0), value + std::min(turn, 2.0)}, {-1.0, 1.0}).scaled(s.amplitude);
        };
        const Interval cosine = about(angle.cosine), sine = about(angle.sine);
        r.height = r.height + cosine;
        for (int i = 0; i < 2; ++i) r.slope[i] = r.slope[i] + -sine.scaled(s.wave_number[i]);
        r.second += a * k * k;
        total += a;
        slope += a * k;
    }
    const Interval sides[2] = {x, y};
    const double width = fade_.outer - fade_.inner;
    Interval weight{1.0, 1.0}, change[2] = {{0.0, 0.0}, {0.0, 0.0}};
    double steep = 0.0;
    bool fades = false;
    for (int k = 0; k < 2; ++k) {
        const Interval d{sides[k].lo - fade_.centre[k], sides[k].hi - fade_.centre[k]};
        const double near = std::max({0.0, d.lo, -d.hi}), far = d.magnitude();
        const Interval a{(near - fade_.inner) / width, (far - fade_.inner) / width};
        weight = weight * Interval{1.0 - smoothstep(a.hi), 1.0 - smoothstep(a.lo)};
        const double s = smoothstep_steepest(a) / width;
        change[k] = {-s, s};
        steep = std::max(steep, s);
        fades = fades || s > 0.0;
    }
    const Interval height = r.height;
    r.height = r.height * weight;
    for (int k = 0; k < 2; ++k) r.slope[k] = r.slope[k] * weight + change[k] * height;
    if (fades) r.second += total * (12.0 / (width * width) + 2.0 * steep * steep) + 4.0 * slope * steep;
    const double size = kRounding * (1.0 + total + slope);
    r.height = {r.height.lo - size, r.height.hi + size};
    for (Interval& i : r.slope) i = {i.lo - size, i.hi + size};
    return r;
}

}  // namespace hoodoo
