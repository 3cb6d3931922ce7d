// F is a cubic along a ray inside a slab: its extremes split it into monotone pieces, and the first piece with a change of sign holds the crossing.
//
// Neighbouring slabs share their faces to the bit, since both compute the ray's t at the face from the same numbers. Their values of F there
// agree up to rounding, so a ray may pass from one to the next exactly when F does: the slab that is entered reports such a crossing at its
// face, unless F says that the ray is clearly past it.

#include "terrain/march/slab_root.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

/// Cuts [t0, t1] to where the ray lies between two planes across axis k.
bool cut(double origin, double direction, double inverse, double lo, double hi, double& t0, double& t1, bool& through_face)
{
    if (direction == 0.0) return lo <= origin && origin <= hi;
    double a = (lo - origin) * inverse, b = (hi - origin) * inverse;
    if (a > b) std::swap(a, b);
    if (a >= t0) t0 = a, through_face = true;
    t1 = std::min(t1, b);
    return t0 <= t1;
}

struct Cubic {
    double c0, c1, c2, c3;
    double at(double x) const { return c0 + x * (c1 + x * (c2 + x * c3)); }
    double slope(double x) const { return c1 + x * (2.0 * c2 + x * 3.0 * c3); }
};

/// F along the ray, in x = (t - t0) / (t1 - t0).
Cubic along(const Slab& s, const SlabRay& ray, double t0, double length)
{
    const Vec3d p = ray.origin + ray.direction * t0;
    const double u = p.x - s.x, v = p.y - s.y, inverse = 1.0 / (s.z1 - s.z0), w = (p.z - s.z0) * inverse;
    const double du = ray.direction.x * length, dv = ray.direction.y * length, dw = ray.direction.z * length * inverse;
    // The lower bilinear patch and its difference to the upper one are quadratics in x.
    double q[2][3];
    for (int k = 0; k < 2; ++k) {
        double v0 = s.value[0], v1 = s.value[1], v2 = s.value[2], v3 = s.value[3];
        if (k == 1) v0 = s.value[4] - v0, v1 = s.value[5] - v1, v2 = s.value[6] - v2, v3 = s.value[7] - v3;
        const double b = v1 - v0, c = v2 - v0, e = v3 - v2 - b;
        q[k][0] = v0 + b * u + c * v + e * u * v;
        q[k][1] = b * du + c * dv + e * (u * dv + v * du);
        q[k][2] = e * du * dv;
    }
    return {q[0][0] + w * q[1][0], q[0][1] + w * q[1][1] + dw * q[1][0], q[0][2] + w * q[1][2] + dw * q[1][1], dw * q[1][2]};
}

/// Ends of the monotone pieces of g on [0, 1]; returns their count (2 to 4).
int monotone_ends(const Cubic& g, double ends[4])
{
    int n = 0;
    // Most pieces are monotone as a whole: the slope's Bernstein coefficients have one sign, and no root is asked for.
    const double first = g.c1, middle = g.c1 + g.c2, last = g.c1 + 2.0 * g.c2 + 3.0 * g.c3;
    if ((first < 0.0 && middle < 0.0 && last < 0.0) || (first > 0.0 && middle > 0.0 && last > 0.0)) {
        ends[0] = 0.0, ends[1] = 1.0;
        return 2;
    }
    ends[n++] = 0.0;
    // 3 c3 x^2 + 2 c2 x + c1 = 0, by the formula that does not cancel.
    const double a = 3.0 * g.c3, b = g.c2, c = g.c1, discriminant = b * b - a * c;
    if (discriminant > 0.0) {
        const double q = -(b + std::copysign(std::sqrt(discriminant), b));
        double r0 = q != 0.0 ? c / q : 2.0, r1 = a != 0.0 ? q / a : 2.0;
        if (r0 > r1) std::swap(r0, r1);
        for (const double r : {r0, r1})
            if (r > 0.0 && r < 1.0) ends[n++] = r;
    }
    ends[n++] = 1.0;
    return n;
}

/// The root of g between x0 and x1, where it has opposite signs and is monotone: Newton, kept inside a shrinking bracket. After a step h what is left
/// of g is at most h^2 (|c2| + 3 |c3|), so a step of 1e-8 is the last: 1e-15 of the corner values, which is their rounding.
double root(const Cubic& g, double x0, double y0, double x1, double y1)
{
    double x = x0 + (x1 - x0) * (y0 / (y0 - y1));
    for (int i = 0; i < 64; ++i) {
        const double y = g.at(x);
        if (y == 0.0) return x;
        ((y < 0.0) == (y0 < 0.0) ? x0 : x1) = x;
        const double slope = g.slope(x);
        double next = x - y / slope;
        const bool newton = next > std::min(x0, x1) && next < std::max(x0, x1);
        if (!newton) next = 0.5 * (x0 + x1);
        if (std::abs(next - x) <= (newton ? 1e-8 : 4e-16)) return next;
        x = next;
    }
    return x;
}

}  // namespace

bool first_crossing(const Slab& slab, const SlabRay& ray, double t_lo, double t_hi, bool exists, double& t)
{
    double t0 = t_lo, t1 = t_hi;
    bool through_face = false;
    const double x0 = std::max<double>(slab.x, ray.domain_lo.x), x1 = std::min<double>(slab.x + 1.0, ray.domain_hi.x);
    const double y0 = std::max<double>(slab.y, ray.domain_lo.y), y1 = std::min<double>(slab.y + 1.0, ray.domain_hi.y);
    if (!cut(ray.origin.x, ray.direction.x, ray.inverse.x, x0, x1, t0, t1, through_face)) return false;
    if (!cut(ray.origin.y, ray.direction.y, ray.inverse.y, y0, y1, t0, t1, through_face)) return false;
    if (!cut(ray.origin.z, ray.direction.z, ray.inverse.z, slab.z0, slab.z1, t0, t1, through_face)) return false;

    const Cubic g = along(slab, ray, t0, t1 - t0);
    double scale = 0.0;
    for (const double v : slab.value) scale = std::max(scale, std::abs(v));
    const bool entering_only = ray.crossing == Crossing::entering;

    // Just past the crossing at the face through which the ray comes in.
    if (through_face && t0 > t_lo && std::abs(g.c0) <= 1e-9 * scale &&
        ((g.c0 <= 0.0 && g.c1 < 0.0) || (!entering_only && g.c0 >= 0.0 && g.c1 > 0.0))) {
        t = t0;
        return t < t_hi;
    }
    double ends[4];
    const int n = monotone_ends(g, ends);
    double before = g.c0;
    for (int i = 1; i < n; ++i) {
        const double after = g.at(ends[i]);
        const bool enters = before > 0.0 && after <= 0.0, leaves = before < 0.0 && after >= 0.0;
        if (enters || (leaves && !entering_only)) {
            if (exists) return true;
            t = t0 + (t1 - t0) * root(g, ends[i - 1], before, ends[i], after);
            return t > t_lo && t < t_hi;
        }
        before = after;
    }
    return false;
}

}  // namespace hoodoo
