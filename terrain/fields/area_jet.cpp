// Bounds of f, |f'| and |f''| over an area follow from those of what f is made of, by the rules of differentiation (Moore's interval arithmetic with
// derivatives carried along):
//   (a b)'  = a' b + a b',        |(a b)''|  <= |a''| |b| + 2 |a'| |b'| + |a| |b''|
//   (a / b)' = (a' - r b') / b,   |(a / b)''| <= (|a''| + 2 |r'| |b'| + |r| |b''|) / b,   r = a / b
//   f(a)'   = f' a',              |f(a)''|   <= |f''| |a'|^2 + |f'| |a''|.
// What is known at one point narrows all of it: |f(p) - f(at)| <= |f'(at)| r + K r^2 / 2, f'(p) within K r of f'(at). So bounds of small areas shrink
// to the function itself. A factor that is 0 everywhere makes 0 of any bound, an infinite one too.
#include "terrain/fields/area_jet.h"

namespace hoodoo
{

namespace
{

constexpr double kRounding = 0x1p-44;  // of all that adds up to a landform: some hundred operations

/// A product of magnitudes where 0 wins.
double times(double a, double b)
{
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

Interval times(const Interval& a, const Interval& b)
{
    const double p = times(a.lo, b.lo), q = times(a.lo, b.hi), r = times(a.hi, b.lo), s = times(a.hi, b.hi);
    return {std::min({p, q, r, s}), std::max({p, q, r, s})};
}

Interval minus(const Interval& a, const Interval& b)
{
    return {a.lo - b.hi, a.hi - b.lo};
}

}  // namespace

// -- At a point --------------------------------------------------------------------------------------------------------

Jet2 operator+(const Jet2& a, const Jet2& b)
{
    return {a.value + b.value, a.gradient + b.gradient};
}

Jet2 operator-(const Jet2& a, const Jet2& b)
{
    return {a.value - b.value, a.gradient - b.gradient};
}

Jet2 operator*(const Jet2& a, const Jet2& b)
{
    return {a.value * b.value, a.gradient * b.value + b.gradient * a.value};
}

Jet2 scaled(const Jet2& a, double k)
{
    return {a.value * k, a.gradient * k};
}

Jet2 shifted(const Jet2& a, double k)
{
    return {a.value + k, a.gradient};
}

Jet2 quotient(const Jet2& a, const Jet2& b)
{
    const double r = a.value / b.value;
    return {r, (a.gradient - b.gradient * r) * (1.0 / b.value)};
}

Jet2 positive_part(const Jet2& a)
{
    return a.value > 0.0 ? a : Jet2{};
}

// -- Over an area ------------------------------------------------------------------------------------------------------

Area Area::of(const Box2d& box)
{
    Area area{box, Vec2d(0.0), 0.5 * (box.max - box.min).length()};
    for (int k = 0; k < 2; ++k) {
        const double middle = 0.5 * (box.min[k] + box.max[k]);
        area.at[k] = std::isfinite(middle) ? middle : std::clamp(0.0, box.min[k], box.max[k]);
    }
    if (!std::isfinite(area.radius)) area.radius = kInfinity;
    return area;
}

AreaJet AreaJet::constant(double value, double radius)
{
    AreaJet a;
    a.value = {value, value};
    a.at.value = value;
    a.radius = radius;
    a.size = std::abs(value);
    return a;
}

AreaJet& AreaJet::narrow()
{
    if (!std::isfinite(radius)) return *this;
    if (std::isfinite(curvature)) {
        const double turn = curvature * radius;
        for (std::size_t k = 0; k < 2; ++k) {
            const double g = at.gradient[static_cast<int>(k)];
            gradient[k] = Interval::common(gradient[k], {g - turn, g + turn});
        }
        slope = std::min(slope, at.gradient.length() + turn);
        const double reach = at.gradient.length() * radius + 0.5 * turn * radius;
        value = Interval::common(value, {at.value - reach, at.value + reach});
    }
    slope = std::min(slope, std::hypot(gradient[0].magnitude(), gradient[1].magnitude()));
    for (Interval& g : gradient) g = Interval::common(g, {-slope, slope});
    value = Interval::common(value, {at.value - slope * radius, at.value + slope * radius});
    // Rounding may cross ends that should meet; the point itself is always there.
    value = Interval::hull(value, {at.value, at.value});
    for (std::size_t k = 0; k < 2; ++k) {
        const double g = at.gradient[static_cast<int>(k)];
        gradient[k] = Interval::hull(gradient[k], {g, g});
    }
    return *this;
}

AreaJet& AreaJet::within(const Interval& values)
{
    value = Interval::common(value, values);
    return narrow();
}

AreaJet AreaJet::widened() const
{
    AreaJet a = *this;
    const double room = kRounding * size, steep = kRounding * slope;
    a.value = {value.lo - room, value.hi + room};
    for (Interval& g : a.gradient) g = {g.lo - steep, g.hi + steep};
    a.slope += steep;
    a.curvature *= 1.0 + kRounding;
    return a;
}

AreaJet operator+(const AreaJet& a, const AreaJet& b)
{
    AreaJet c;
    c.value = a.value + b.value;
    for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = a.gradient[k] + b.gradient[k];
    c.slope = a.slope + b.slope;
    c.curvature = a.curvature + b.curvature;
    c.at = a.at + b.at;
    c.radius = a.radius;
    c.size = a.size + b.size;
    return c.narrow();
}

AreaJet operator-(const AreaJet& a, const AreaJet& b)
{
    return a + scaled(b, -1.0);
}

AreaJet operator*(const AreaJet& a, const AreaJet& b)
{
    AreaJet c;
    c.value = times(a.value, b.value);
    for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = times(a.gradient[k], b.value) + times(b.gradient[k], a.value);
    const double ma = a.value.magnitude(), mb = b.value.magnitude();
    c.slope = times(a.slope, mb) + times(b.slope, ma);
    c.curvature = times(a.curvature, mb) + 2.0 * times(a.slope, b.slope) + times(b.curvature, ma);
    c.at = a.at * b.at;
    c.radius = a.radius;
    c.size = times(a.size, mb) + times(b.size, ma);
    return c.narrow();
}

AreaJet scaled(const AreaJet& a, double k)
{
    AreaJet c = a;
    c.value = a.value.scaled(k);
    for (Interval& g : c.gradient) g = g.scaled(k);
    c.slope = a.slope * std::abs(k);
    c.curvature = times(a.curvature, std::abs(k));
    c.at = scaled(a.at, k);
    c.size = a.size * std::abs(k);
    return c;
}

AreaJet shifted(const AreaJet& a, double k)
{
    AreaJet c = a;
    c.value = {a.value.lo + k, a.value.hi + k};
    c.at.value += k;
    c.size += std::abs(k);
    return c;
}

AreaJet quotient(const AreaJet& a, const AreaJet& b)
{
    AreaJet c;
    const Interval one_by_b{1.0 / b.value.hi, 1.0 / b.value.lo};
    c.value = times(a.value, one_by_b);
    const double r = c.value.magnitude();
    for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = times(minus(a.gradient[k], times(b.gradient[k], c.value)), one_by_b);
    c.slope = (a.slope + times(r, b.slope)) * one_by_b.hi;
    c.curvature = (a.curvature + 2.0 * times(c.slope, b.slope) + times(r, b.curvature)) * one_by_b.hi;
    c.at = quotient(a.at, b.at);
    c.radius = a.radius;
    c.size = (a.size + times(r, b.size)) * one_by_b.hi;
    return c.narrow();
}

AreaJet positive_part(const AreaJet& a)
{
    if (a.value.lo >= 0.0) return a;
    AreaJet c = AreaJet::constant(0.0, a.radius);
    c.size = a.size;
    if (a.value.hi <= 0.0) return c;
    c.value.hi = a.value.hi;
    for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = Interval::hull(a.gradient[k], {0.0, 0.0});
    c.slope = a.slope;
    c.curvature = kInfinity;
    c.at = positive_part(a.at);
    return c;
}

AreaJet compose(double value, double slope, const CurveBounds& bounds, const AreaJet& a)
{
    AreaJet c;
    c.value = bounds.value;
    for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = times(bounds.slope, a.gradient[k]);
    const double steepest = bounds.slope.magnitude();
    c.slope = times(steepest, a.slope);
    c.curvature = times(times(bounds.curvature, a.slope), a.slope) + times(steepest, a.curvature);
    c.at = {value, a.at.gradient * slope};
    c.radius = a.radius;
    c.size = bounds.value.magnitude() + times(steepest, a.size);
    return c.narrow();
}

}  // namespace hoodoo
