// Elevation as octaves of noise: h(p) = height + relief sum_k a_k w_k(p) s_k(p) / sum_k a_k, s_k in [-1, 1] from the noise n_k of frequency f_k.
// GalinCourse, "Procedural modeling"; Musgrave1989 for the multifractal. With n in [-B, B] (math/noise.h):
//   fbm           s = n / B
//   billow        s = 2 |n| / B - 1                      round hills, creased valleys
//   ridged        s = 2 (1 - |n| / B)^2 - 1              creased crests
//   multifractal  s = n / B, each octave times clamp((1 + v) / 2, 0, 1), v the sum so far: smooth plains, rugged heights (heterogeneous terrain, with
//   a
//                 clamp so that bounds stay finite)
// w_k = smoothstep(lambda_k / (2 footprint) - 1), footprint = spread * distance from the eye: octaves that a pixel does not resolve are gone.
// Bounds over an area of radius rho about c: |n - n(c)| <= min(G f rho, |grad n(c)| f rho + H (f rho)^2 / 2), |grad n| <= min(G, |grad n(c)| + H f
// rho) f; each octave's share then by the product rule, with the largest w, |grad w| <= 3/2 x/r and |Hess w| <= 33 / r^2 (x = lambda / (2 footprint)
// in [1, 2], |w'| <= 3/2 x / r, |w''| <= 6 (x/r)^2 + 3/2 * 2 x / r^2 <= 30 / r^2, and |w'| / r <= 3 / r^2 for the direction across). Sums of octaves
// bound sums; where crests crease the curvature is infinite. Deviation: octaves are rotated and shifted against each other, so that no lattice shows.
#include "terrain/fields/elevation.h"

#include "terrain/math/hash.h"
#include "terrain/math/noise_hessian.h"
#include "terrain/math/smoothstep.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kBound = kNoise2Bound.value, kSlope = kNoise2Derivatives.slope, kHessian = kNoise2Derivatives.hessian;
constexpr double kRounding = 0x1p-40;  // of sums of at most 24 octaves, relative to their size

Noise2 shaped(ElevationKind kind, const Noise2& n)
{
    const double sign = n.value < 0.0 ? -1.0 : 1.0, size = std::abs(n.value) / kBound;
    switch (kind) {
        case ElevationKind::ridged:
            return {2.0 * (1.0 - size) * (1.0 - size) - 1.0, n.gradient * (-4.0 * (1.0 - size) * sign / kBound)};
        case ElevationKind::billow:
            return {2.0 * size - 1.0, n.gradient * (2.0 * sign / kBound)};
        default:
            return {n.value / kBound, n.gradient * (1.0 / kBound)};
    }
}

}  // namespace

/// What is known of one octave over an area: its shape s and its weight w.
struct ElevationHeight::Term {
    Interval shape;
    double slope = 0.0, curvature = 0.0;
    Interval weight{1.0, 1.0};
    double weight_slope = 0.0, weight_curvature = 0.0;
};

ElevationHeight::ElevationHeight(const ElevationShape& shape) : shape_(shape)
{
    const double count = std::min(shape.fractal.octaves, 24.0);
    double sum = 0.0, frequency = 1.0 / shape.wavelength, amplitude = 1.0;
    for (int k = 0; k < std::ceil(count); ++k) {
        const std::uint64_t h = hash_cell(shape.seed, k, 17);
        const double angle = 6.283185307179586 * unit_real(mix64(h)), share = std::min(1.0, count - k);
        octaves_.push_back({frequency, amplitude * share, std::cos(angle), std::sin(angle),
                            Vec2d(unit_real(mix64(h + 1)), unit_real(mix64(h + 2))) * 97.0, static_cast<std::uint32_t>(h)});
        sum += amplitude * share;
        frequency *= shape.fractal.lacunarity;
        amplitude *= shape.fractal.gain;
    }
    scale_ = shape.relief / sum;
}

Vec2d ElevationHeight::lattice_point(const Octave& octave, const Vec2d& p) const
{
    const Vec2d q = (p - shape_.origin) * octave.per_metre;
    return Vec2d(octave.cosine * q.x - octave.sine * q.y, octave.sine * q.x + octave.cosine * q.y) + octave.shift;
}

ElevationHeight::Fade ElevationHeight::fade(const Octave& octave, const Vec2d& p) const
{
    if (!shape_.limit) return {};
    const OctaveLimit& limit = *shape_.limit;
    const Vec2d from(p.x - limit.eye.x, p.y - limit.eye.y);
    const double r = std::hypot(from.x, from.y, limit.nearest), x = 1.0 / (octave.per_metre * 2.0 * limit.spread * r);
    return {smoothstep(x - 1.0), from * (-smoothstep_slope(x - 1.0) * x / (r * r))};
}

Noise2 ElevationHeight::at(const Vec2d& p) const
{
    Noise2 sum;
    for (const Octave& octave : octaves_) {
        const Fade w = fade(octave, p);
        if (w.weight == 0.0) continue;
        Noise2 n = gradient_noise(lattice_point(octave, p), octave.seed);
        const Vec2d g = n.gradient * octave.per_metre;
        n.gradient = Vec2d(octave.cosine * g.x + octave.sine * g.y, -octave.sine * g.x + octave.cosine * g.y);
        const Noise2 s = shaped(shape_.kind, n);
        double value = w.weight * s.value;
        Vec2d gradient = s.gradient * w.weight + w.gradient * s.value;
        if (shape_.kind == ElevationKind::multifractal && &octave != octaves_.data()) {
            const double part = 0.5 + 0.5 * sum.value, clamped = std::clamp(part, 0.0, 1.0);
            gradient = gradient * clamped + (part == clamped ? sum.gradient * (0.5 * value) : Vec2d(0.0));
            value *= clamped;
        }
        sum.value += octave.amplitude * value;
        sum.gradient += gradient * octave.amplitude;
    }
    return {shape_.height + scale_ * sum.value, sum.gradient * scale_};
}

ElevationHeight::Term ElevationHeight::term(const Octave& octave, const Vec2d& centre, double radius, const Interval& distance) const
{
    Term t;
    if (shape_.limit) {
        const double unit = 1.0 / (octave.per_metre * 2.0 * shape_.limit->spread);
        const Interval x{unit / distance.hi, unit / distance.lo};
        t.weight = {smoothstep(x.lo - 1.0), smoothstep(x.hi - 1.0)};
        if (t.weight.hi == 0.0) return t;
        if (x.lo < 2.0) {
            t.weight_slope = smoothstep_steepest({x.lo - 1.0, x.hi - 1.0}) * std::min(x.hi, 2.0) / distance.lo;
            t.weight_curvature = 33.0 / (distance.lo * distance.lo);
        }
    }
    const Noise2 n = gradient_noise(lattice_point(octave, centre), octave.seed);
    const double reach = octave.per_metre * radius, g = n.gradient.length();
    const double away = std::min(kSlope * reach, g * reach + 0.5 * kHessian * reach * reach) + kRounding;
    const Interval value{std::max(n.value - away, -kBound), std::min(n.value + away, kBound)};
    const double slope = std::min(kSlope, g + kHessian * reach + kRounding) * octave.per_metre / kBound;
    const bool creased = value.contains(0.0);
    const Interval size = Interval{creased ? 0.0 : std::min(std::abs(value.lo), std::abs(value.hi)), value.magnitude()}.scaled(1.0 / kBound);
    const double hessian = kHessian * octave.per_metre * octave.per_metre / kBound;
    switch (shape_.kind) {
        case ElevationKind::ridged: {
            const double high = 1.0 - size.lo, low = std::max(0.0, 1.0 - size.hi);
            t.shape = {2.0 * low * low - 1.0, 2.0 * high * high - 1.0};
            t.slope = 4.0 * high * slope;
            t.curvature = creased ? kInfinity : 4.0 * (high * hessian + slope * slope);
            break;
        }
        case ElevationKind::billow:
            t.shape = {2.0 * size.lo - 1.0, 2.0 * size.hi - 1.0};
            t.slope = 2.0 * slope;
            t.curvature = creased ? kInfinity : 2.0 * hessian;
            break;
        default:
            t.shape = value.scaled(1.0 / kBound);
            t.slope = slope;
            t.curvature = hessian;
    }
    return t;
}

HeightBounds ElevationHeight::bounds(const Box2d& area) const
{
    const bool finite = std::isfinite(area.min.x) && std::isfinite(area.min.y) && std::isfinite(area.max.x) && std::isfinite(area.max.y);
    const Vec2d centre = finite ? (area.min + area.max) * 0.5 : Vec2d(0.0);
    const double radius = finite ? 0.5 * (area.max - area.min).length() : kInfinity;
    Interval distance{1.0, 1.0};
    if (shape_.limit) {
        const double away = std::hypot(centre.x - shape_.limit->eye.x, centre.y - shape_.limit->eye.y), nearest = shape_.limit->nearest;
        distance = {finite ? std::hypot(std::max(0.0, away - radius), nearest) : nearest, finite ? std::hypot(away + radius, nearest) : kInfinity};
        distance = {distance.lo * (1.0 - kRounding), distance.hi * (1.0 + kRounding)};
    }
    Interval sum;
    double slope = 0.0, curvature = 0.0;
    for (const Octave& octave : octaves_) {
        const Term t = term(octave, centre, finite ? radius : 1e30, distance);
        if (t.weight.hi == 0.0) continue;
        const double size = t.shape.magnitude();
        Interval value = t.weight * t.shape;
        double rise = t.weight.hi * t.slope + t.weight_slope * size;
        double bend = t.weight.hi * t.curvature + 2.0 * t.weight_slope * t.slope + t.weight_curvature * size;
        if (shape_.kind == ElevationKind::multifractal && &octave != octaves_.data()) {
            const Interval open{0.5 + 0.5 * sum.lo, 0.5 + 0.5 * sum.hi}, part{std::clamp(open.lo, 0.0, 1.0), std::clamp(open.hi, 0.0, 1.0)};
            const bool clamps = open.lo < 0.0 || open.hi > 1.0;
            bend = clamps || !std::isfinite(curvature) ? kInfinity : bend * part.hi + rise * slope + value.magnitude() * 0.5 * curvature;
            rise = rise * part.hi + value.magnitude() * 0.5 * slope;
            value = value * part;
        }
        sum = sum + value.scaled(octave.amplitude);
        slope += octave.amplitude * rise;
        curvature += octave.amplitude * bend;
    }
    const double rounding = kRounding * (std::abs(shape_.height) + shape_.relief);
    HeightBounds known;
    known.value = {shape_.height + scale_ * sum.lo - rounding, shape_.height + scale_ * sum.hi + rounding};
    known.slope = slope * scale_ * (1.0 + kRounding);
    known.curvature = curvature * scale_ * (1.0 + kRounding);
    known.gradient = {Interval{-known.slope, known.slope}, Interval{-known.slope, known.slope}};
    if (!finite || !std::isfinite(known.curvature)) return known;
    // The gradient at the centre and how far it can turn from there; with its slope, the height too.
    const Noise2 middle = at(centre);
    const double turn = known.curvature * radius, reach = middle.gradient.length() * radius + 0.5 * turn * radius + rounding;
    known.value = Interval::common(known.value, {middle.value - reach, middle.value + reach});
    known.slope = std::min(known.slope, middle.gradient.length() + turn);
    for (int k = 0; k < 2; ++k) {
        Interval& g = known.gradient[static_cast<std::size_t>(k)];
        g = Interval::common(g, {middle.gradient[k] - turn, middle.gradient[k] + turn});
    }
    return known;
}

}  // namespace hoodoo
