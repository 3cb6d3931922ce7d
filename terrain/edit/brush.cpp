// Along an axis f is linear between knots and the potential of a point is a quartic, so each piece of f~ is a quartic whose extremes are roots of a
// cubic.
//
// Peytavie2009, section 4.1: f~ = f + f* (in the paper's sign), g(r) = (1 - (r/R)^2)^2, roots of f~ along the axis of each column. With u = z - z_c,
// rho the axis's distance, k = 1 - rho^2/R^2 and the piece f = f_0 + B u:
//   f~(u) = f_0 + B u -+ (k - u^2/R^2)^2,   f~'(u) = B +- (4/R^2) u (k - u^2/R^2)   -> u^3 - k R^2 u -+ B R^4/4 = 0, solved in closed form.
// Between neighbouring extremes f~ is monotone: a change of sign there is one root, halved down to neighbouring numbers.
//
// Missing: nothing of the point primitive; other skeletal elements are not offered.
#include "terrain/edit/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hoodoo
{

namespace
{

/// Real roots of u^3 + p u + q, in any order; returns how many.
int depressed_cubic(double p, double q, std::array<double, 3>& u)
{
    const double discriminant = q * q / 4.0 + p * p * p / 27.0;
    if (discriminant > 0.0 || p >= 0.0) {
        // One real root: the cube root that does not cancel, and its partner.
        const double a = -std::copysign(std::cbrt(std::abs(q) / 2.0 + std::sqrt(std::max(0.0, discriminant))), q);
        u[0] = a == 0.0 ? 0.0 : a - p / (3.0 * a);
        return 1;
    }
    const double m = 2.0 * std::sqrt(-p / 3.0), angle = std::acos(std::clamp(3.0 * q / (p * m), -1.0, 1.0)) / 3.0;
    for (int k = 0; k < 3; ++k) u[static_cast<std::size_t>(k)] = m * std::cos(angle - 2.0 * std::numbers::pi * k / 3.0);
    return 3;
}

/// The one change of sign of a monotone function between a and b, which lie on different sides.
template <class F>
double halved(const F& f, double a, double b)
{
    const bool inside = f(a) < 0.0;
    for (;;) {
        const double m = 0.5 * (a + b);
        if (!(m > a && m < b)) return m;
        ((f(m) < 0.0) == inside ? a : b) = m;
    }
}

struct Span {
    double lower, upper;
};

/// The heights of the ball on this axis; empty (lower >= upper) if it misses.
Span reach(const Brush& brush)
{
    const double h2 = brush.radius * brush.radius - brush.distance * brush.distance;
    if (!(h2 > 0.0)) return {0.0, 0.0};
    return {brush.centre - std::sqrt(h2), brush.centre + std::sqrt(h2)};
}

}  // namespace

double Brush::potential(double z) const
{
    const double r2 = (distance * distance + (z - centre) * (z - centre)) / (radius * radius);
    return r2 < 1.0 ? (1.0 - r2) * (1.0 - r2) : 0.0;
}

std::vector<double> brushed_roots(const AxisProfile& f, const Brush& brush)
{
    std::vector<double> roots;
    const Span ball = reach(brush);
    if (!(ball.lower < ball.upper)) return roots;
    const double sign = brush.adds ? -1.0 : 1.0, r2 = brush.radius * brush.radius, k = 1.0 - brush.distance * brush.distance / r2;
    const auto brushed = [&](double z) { return f.at(z) + sign * brush.potential(z); };

    // Cuts: the ball's ends, the knots of f between them, the extremes of f~ on each piece.
    std::vector<double> cuts = {ball.lower};
    for (const AxisProfile::Knot& knot : f.knots()) {
        if (knot.z > ball.lower && knot.z < ball.upper) cuts.push_back(knot.z);
    }
    cuts.push_back(ball.upper);
    for (std::size_t c = 0, pieces = cuts.size() - 1; c < pieces; ++c) {
        const double a = cuts[c], b = cuts[c + 1], slope = (f.at(b) - f.at(a)) / (b - a);
        std::array<double, 3> u{};
        const int n = depressed_cubic(-k * r2, sign * slope * r2 * r2 / 4.0, u);
        for (int i = 0; i < n; ++i) {
            const double z = brush.centre + u[static_cast<std::size_t>(i)];
            if (z > a && z < b) cuts.push_back(z);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
        if (cuts[c] < cuts[c + 1] && (brushed(cuts[c]) < 0.0) != (brushed(cuts[c + 1]) < 0.0)) {
            roots.push_back(halved(brushed, cuts[c], cuts[c + 1]));
        }
    }
    return roots;
}

std::vector<BrushedPiece> brushed_pieces(const AxisProfile& f, const Brush& brush)
{
    std::vector<BrushedPiece> pieces;
    const Span ball = reach(brush);
    if (!(ball.lower < ball.upper)) return pieces;
    struct Cut {
        double z;
        bool old;
    };
    std::vector<Cut> cuts = {{ball.lower, false}, {ball.upper, false}};
    for (const double z : f.roots()) {
        if (z > ball.lower && z < ball.upper) cuts.push_back({z, true});
    }
    for (const double z : brushed_roots(f, brush)) cuts.push_back({z, false});
    std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.z < b.z; });

    // Between neighbouring cuts neither function changes its side: the middle tells for all.
    const double sign = brush.adds ? -1.0 : 1.0;
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
        if (!(cuts[c].z < cuts[c + 1].z)) continue;
        const double z = 0.5 * (cuts[c].z + cuts[c + 1].z), before = f.at(z), after = before + sign * brush.potential(z);
        if ((before < 0.0) != (after < 0.0)) pieces.push_back({cuts[c].z, cuts[c + 1].z, cuts[c].old, cuts[c + 1].old});
    }
    return pieces;
}

}  // namespace hoodoo
