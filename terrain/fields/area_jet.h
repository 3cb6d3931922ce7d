// A function of the plane: its jet at a point, or that and what is proved of it over an area; and sums, products and quotients of either.
#pragma once

#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

#include <array>

namespace hoodoo
{

using Box2d = Imath::Box2d;

/// A value and its gradient.
struct Jet2 {
    double value = 0.0;
    Vec2d gradient{0.0};
};

Jet2 operator+(const Jet2& a, const Jet2& b);
Jet2 operator-(const Jet2& a, const Jet2& b);
Jet2 operator*(const Jet2& a, const Jet2& b);
Jet2 scaled(const Jet2& a, double k);
Jet2 shifted(const Jet2& a, double k);  ///< a + k
/// a / b, b not 0.
Jet2 quotient(const Jet2& a, const Jet2& b);
/// The part of it above 0: max(a, 0).
Jet2 positive_part(const Jet2& a);

/// A piece of the plane: points of the box within `radius` of the point `at`.
struct Area {
    Box2d box;
    Vec2d at{0.0};
    double radius = kInfinity;

    static Area of(const Box2d& box);  ///< all of it, seen from its middle
};

/// What is known of a function over an area. Enclosures are rounded outwards by widened(), once, at the end: `size` adds up the numbers that went in.
struct AreaJet {
    Interval value;
    std::array<Interval, 2> gradient;  ///< one-sided gradients included
    double slope = 0.0;                ///< |f(p) - f(q)| <= slope |p - q|
    double curvature = 0.0;            ///< the same of gradients; infinite where they jump
    Jet2 at;                           ///< the function itself at Area::at
    double radius = kInfinity;         ///< of the area
    double size = 0.0;                 ///< magnitude of what its rounding follows

    static AreaJet constant(double value, double radius);
    /// Narrows each enclosure by the others: the value at the point, its gradient there, and how fast that can turn.
    AreaJet& narrow();
    /// The same, when its values are known to lie in an interval too.
    AreaJet& within(const Interval& values);
    /// With room for the rounding of all that it was computed from.
    AreaJet widened() const;
};

AreaJet operator+(const AreaJet& a, const AreaJet& b);
AreaJet operator-(const AreaJet& a, const AreaJet& b);
AreaJet operator*(const AreaJet& a, const AreaJet& b);
AreaJet scaled(const AreaJet& a, double k);
AreaJet shifted(const AreaJet& a, double k);
/// a / b; b.value.lo above 0.
AreaJet quotient(const AreaJet& a, const AreaJet& b);
AreaJet positive_part(const AreaJet& a);

/// What is known of a function of one variable over an interval: values, first derivative, second derivative by magnitude.
struct CurveBounds {
    Interval value, slope;
    double curvature = 0.0;
};
/// f(a), from f's value and derivative at a.at.value and its bounds over a.value.
AreaJet compose(double value, double slope, const CurveBounds& bounds, const AreaJet& a);

}  // namespace hoodoo
