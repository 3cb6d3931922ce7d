// Weights (1 - t^2)^n by Genevaux2015; sections as monotone cubics (Fritsch1984), so that a profile has no hills that its knots do not have.
// A function f(d) of the distance d from a convex set has second derivatives of at most max(|f''|, |f'| / d): d itself has curvature 1/d across its
// gradient, and f'/d stays below sup |f''| where f'(0) = 0. The falloff has f' = -2 n t (1 - t^2)^(n-1) / T, T = radius - core.
#include "terrain/fields/radial.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

// -- Weights -----------------------------------------------------------------------------------------------------------

std::pair<double, double> falloff_at(const Falloff& f, double distance)
{
    const double reach = f.radius - f.core, t = std::max(0.0, (distance - f.core) / reach);
    if (t >= 1.0) return {0.0, 0.0};
    const double u = 1.0 - t * t, v = f.power == 2 ? u : u * u;
    return {u * v, -2.0 * f.power * t * v / reach};
}

RadialBounds falloff_over(const Falloff& f, const Interval& distance)
{
    const double reach = f.radius - f.core;
    const auto part = [&](double d) { return std::clamp((d - f.core) / reach, 0.0, 1.0); };
    const Interval t{part(distance.lo), part(distance.hi)}, u{1.0 - t.hi * t.hi, 1.0 - t.lo * t.lo};
    const double n = f.power;
    const auto power = [](double x, int k) { return k == 0 ? 1.0 : k == 1 ? x : k == 2 ? x * x : x * x * x; };
    RadialBounds b;
    if (t.lo >= 1.0) return {{{0.0, 0.0}, {0.0, 0.0}, 0.0}, 0.0};
    b.curve.value = {power(u.lo, f.power), power(u.hi, f.power)};
    b.curve.slope = Interval{t.lo * power(u.lo, f.power - 1), t.hi * power(u.hi, f.power - 1)}.scaled(-2.0 * n / reach);
    b.slope_by_distance = 2.0 * n * power(u.hi, f.power - 1) / (reach * reach);
    const Interval bend{-2.0 * n * power(u.hi, f.power - 1) + 4.0 * n * (n - 1.0) * t.lo * t.lo * power(u.lo, f.power - 2),
                        -2.0 * n * power(u.lo, f.power - 1) + 4.0 * n * (n - 1.0) * t.hi * t.hi * power(u.hi, f.power - 2)};
    b.curve.curvature = bend.magnitude() / (reach * reach);
    return b;
}

// -- Sections ----------------------------------------------------------------------------------------------------------

SectionCurve::SectionCurve(const Section& section)
{
    const std::vector<Vec2d>& k = section.knots;
    if (k.empty()) return;
    first_ = k.front().y;
    last_ = k.back().y;
    std::vector<double> chord, slope(k.size(), 0.0);
    for (std::size_t i = 0; i + 1 < k.size(); ++i) chord.push_back((k[i + 1].y - k[i].y) / (k[i + 1].x - k[i].x));
    for (std::size_t i = 1; i + 1 < k.size(); ++i) {
        if (chord[i - 1] * chord[i] <= 0.0) continue;
        // The mean that never exceeds three times the flatter chord (Fritsch1984, their third formula, weighted by lengths).
        const double h0 = k[i].x - k[i - 1].x, h1 = k[i + 1].x - k[i].x, a = (h0 + 2.0 * h1) / (3.0 * (h0 + h1));
        slope[i] = chord[i - 1] * chord[i] / (a * chord[i] + (1.0 - a) * chord[i - 1]);
    }
    if (section.sharp && k.size() > 1 && k[0].x == 0.0) slope[0] = chord[0];
    for (std::size_t i = 0; i + 1 < k.size(); ++i) {
        const double h = k[i + 1].x - k[i].x;
        pieces_.push_back({k[i].x, k[i + 1].x, k[i].y, slope[i], (3.0 * chord[i] - 2.0 * slope[i] - slope[i + 1]) / h,
                           (slope[i] + slope[i + 1] - 2.0 * chord[i]) / (h * h)});
    }
}

std::pair<double, double> SectionCurve::at(double distance) const
{
    if (pieces_.empty() || distance < pieces_.front().from) return {first_, 0.0};
    if (distance >= pieces_.back().to) return {last_, 0.0};
    const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), distance, [](double d, const Piece& p) { return d < p.to; });
    const Piece& p = *after;
    const double x = distance - p.from;
    return {p.a0 + x * (p.a1 + x * (p.a2 + x * p.a3)), p.a1 + x * (2.0 * p.a2 + x * 3.0 * p.a3)};
}

RadialBounds SectionCurve::over(const Interval& distance) const
{
    RadialBounds b;
    const double low = at(distance.lo).first, high = at(distance.hi).first;
    b.curve.value = Interval::hull({low, low}, {high, high});
    double bend_to_here = 0.0;  // sup |f''| from the skeleton on
    for (const Piece& p : pieces_) {
        if (p.from > distance.hi) break;
        const double from = std::max(distance.lo, p.from), to = std::min(distance.hi, p.to);
        bend_to_here = std::max({bend_to_here, std::abs(2.0 * p.a2), std::abs(2.0 * p.a2 + 6.0 * p.a3 * (std::min(p.to, distance.hi) - p.from))});
        if (to < from) continue;
        // Monotone between knots: extremes of the value lie at ends; those of the slope there, or where f'' = 0.
        const double turn = p.a3 == 0.0 ? from : std::clamp(p.from - p.a2 / (3.0 * p.a3), from, to);
        for (const double d : {from, turn, to}) {
            const double x = d - p.from, slope = p.a1 + x * (2.0 * p.a2 + x * 3.0 * p.a3), value = p.a0 + x * (p.a1 + x * (p.a2 + x * p.a3));
            b.curve.value = Interval::hull(b.curve.value, {value, value});
            b.curve.slope = Interval::hull(b.curve.slope, {slope, slope});
            b.curve.curvature = std::max(b.curve.curvature, std::abs(2.0 * p.a2 + 6.0 * p.a3 * x));
        }
    }
    const bool crest = !pieces_.empty() && pieces_.front().from == 0.0 && pieces_.front().a1 != 0.0;
    b.slope_by_distance = crest ? kInfinity : bend_to_here;
    if (distance.lo > 0.0) b.slope_by_distance = std::min(b.slope_by_distance, b.curve.slope.magnitude() / distance.lo);
    return b;
}

AreaJet radial(const std::pair<double, double>& at, const RadialBounds& bounds, const DistanceOver& distance)
{
    AreaJet jet = compose(at.first, at.second, bounds.curve, distance.jet);
    jet.curvature = distance.convex ? std::max(bounds.curve.curvature, bounds.slope_by_distance) : kInfinity;
    if (bounds.curve.slope.magnitude() == 0.0 && bounds.curve.curvature == 0.0) jet.curvature = 0.0;
    return jet.narrow();
}

}  // namespace hoodoo
