// The paper's own search: a warped ray halved until each piece is straight enough by the area of its triangle, then met as a chord.
#pragma once

#include "terrain/math/vec.h"

#include <algorithm>
#include <cstdint>

namespace hoodoo
{

struct AreaSettings {
    double epsilon = 1e-3;  ///< square metres, at the surface of the base
    double distance = 1.0;  ///< metres: where |base| says that the nearer end is as far as this, the tolerance has doubled
    int most_depth = 20;    ///< of the recursion
};

/// Gamito2001, section 3.1, CheckIntersection: `place(t)` is the inverse warp of the ray at t, `base(q)` the undeformed surface (about a distance).
/// Kept to compare with: it misses what maths says it must (arcs that are odd about their middle, two crossings of one chord). The midpoint is the
/// warp of the ray's own middle, not the mean of the ends. True if a chord changes its side; t by the share of the chord.
template <class Place, class Base>
bool area_march(const Place& place, const Base& base, double a, double b, bool entering, const AreaSettings& settings, double& t,
                std::uint32_t& evaluations)
{
    struct Piece {
        double a, b;
        Vec3d pa, pb;
        double fa, fb;
        int depth;
    };
    Piece stack[64];
    int top = 0;
    const Vec3d pa = place(a), pb = place(b);
    evaluations += 2;
    stack[top++] = {a, b, pa, pb, base(pa), base(pb), 0};
    while (top > 0) {
        const Piece s = stack[--top];
        const double m = 0.5 * (s.a + s.b);
        const Vec3d pm = place(m);
        ++evaluations;
        const double area = 0.5 * (pm - s.pa).cross(s.pb - s.pa).length();
        const double tolerance = settings.epsilon * (1.0 + std::min(std::abs(s.fa), std::abs(s.fb)) / settings.distance);
        if (area < tolerance || s.depth >= settings.most_depth) {
            if ((s.fa < 0.0) == (s.fb < 0.0) || (entering && s.fa < 0.0)) continue;
            // The chord's own crossing, by halving: a straight piece against the undeformed surface.
            double lo = 0.0, hi = 1.0;
            for (int k = 0; k < 50; ++k) {
                const double u = 0.5 * (lo + hi);
                ((base(s.pa + (s.pb - s.pa) * u) < 0.0) == (s.fa < 0.0) ? lo : hi) = u;
            }
            t = s.a + (s.b - s.a) * 0.5 * (lo + hi);
            return true;
        }
        const double fm = base(pm);
        stack[top++] = {m, s.b, pm, s.pb, fm, s.fb, s.depth + 1};
        stack[top++] = {s.a, m, s.pa, pm, s.fa, fm, s.depth + 1};
    }
    return false;
}

}  // namespace hoodoo
