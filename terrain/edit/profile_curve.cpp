// A closed cubic through the control points, flattened once: everything after that works on corners.
//
// Peytavie2009, section 4.2: profile curves are piecewise cubic and may be non-convex. CHOICE of cubic: uniform Catmull-Rom (Catmull1974), for i the
// control point and u in [0, 1):
//   p(u) = 1/2 (2 p_i + (p_i+1 - p_i-1) u + (2 p_i-1 - 5 p_i + 4 p_i+1 - p_i+2) u^2 + (3 p_i - p_i-1 - 3 p_i+1 + p_i+2) u^3).
// Missing: corners that stay sharp (repeat a control point for that).
#include "terrain/edit/profile_curve.h"

#include <numbers>

namespace hoodoo
{

Profile2 closed_spline(std::span<const Vec2d> control, int corners)
{
    const std::size_t n = control.size();
    Profile2 out;
    for (int k = 0; k < corners; ++k) {
        const double at = static_cast<double>(k) * static_cast<double>(n) / corners;
        const auto i = static_cast<std::size_t>(at);
        const double u = at - static_cast<double>(i);
        const Vec2d &a = control[(i + n - 1) % n], &b = control[i % n], &c = control[(i + 1) % n], &d = control[(i + 2) % n];
        out.push_back((b * 2.0 + (c - a) * u + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (u * u) + (b * 3.0 - a - c * 3.0 + d) * (u * u * u)) * 0.5);
    }
    return out;
}

Profile2 ellipse(double width, double height, int corners)
{
    // A polygon of n corners on a circle has n/2 sin(2 pi / n) of its r^2, not pi: widen it by the root of that.
    const double angle = 2.0 * std::numbers::pi / corners, wider = 0.5 * std::sqrt(angle / std::sin(angle));
    Profile2 out;
    for (int k = 0; k < corners; ++k) {
        const double turn = angle * k;
        out.emplace_back(wider * width * std::cos(turn), wider * height * std::sin(turn));
    }
    return out;
}

double mean_radius(std::span<const Vec2d> profile)
{
    double sum = 0.0;
    for (const Vec2d& p : profile) sum += p.length();
    return profile.empty() ? 0.0 : sum / static_cast<double>(profile.size());
}

}  // namespace hoodoo
