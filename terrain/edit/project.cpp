// A target is projected by casting rays from it, and then back along the surface's own normal until that shortens the way no more.
// Peytavie2009, section 4.1, projects a target vertex onto the bedrock surface and does not say how; following the gradient alone would stop where
// the field saturates at +-1. A ray steps |f| / slope at a time, so it skips no crossing but a graze (project.h). Missing: a proof of nearness.
#include "terrain/edit/project.h"

#include <algorithm>

namespace hoodoo
{

std::optional<Vec3d> first_crossing(const Field& field, const Vec3d& from, const Vec3d& direction, double slope, double reach)
{
    const bool inside = field.value(from) < 0.0;
    const double least = 0.02 / slope;
    double near = 0.0, value = field.value(from);
    while (near < reach) {
        const double far = std::min(reach, near + std::max(least, std::abs(value) / slope));
        value = field.value(from + direction * far);
        if ((value < 0.0) != inside) {
            double a = near, b = far;
            for (double m = 0.5 * (a + b); m > a && m < b && b - a > 1e-12 / slope; m = 0.5 * (a + b)) {
                ((field.value(from + direction * m) < 0.0) == inside ? a : b) = m;
            }
            return from + direction * b;
        }
        near = far;
    }
    return std::nullopt;
}

std::optional<Vec3d> project(const Field& field, const Vec3d& from, double slope, double first_reach, double reach)
{
    std::optional<Vec3d> best;
    double distance = 0.0;
    const auto cast = [&](const Vec3d& direction, double most) {
        const auto found = first_crossing(field, from, direction, slope, most);
        if (!found || (best && !((*found - from).length() < distance))) return;
        best = found;
        distance = (*found - from).length();
    };
    for (double most = std::min(first_reach, reach);; most = std::min(2.0 * most, reach)) {
        for (int k = 0; k < 27; ++k) {
            const Vec3d direction(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            if (k != 13) cast(direction.normalized(), best ? distance : most);
        }
        if (best || most >= reach) break;
    }
    if (!best) return best;
    for (int step = 0; step < 16; ++step) {
        const double before = distance;
        const Vec3d normal = field.gradient(*best);
        if (!(normal.length() > 0.0)) break;
        // From air the surface lies against the normal, from matter along it.
        const double side = field.value(from) < 0.0 ? 1.0 : -1.0;
        cast(normal.normalized() * side, distance);
        if (!(distance < 0.999 * before)) break;
    }
    return best;
}

}  // namespace hoodoo
