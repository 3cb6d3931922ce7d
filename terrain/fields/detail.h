// Level of detail by distance: what a pixel does not resolve fades out, as a smooth function of the place alone.
#pragma once

#include "terrain/math/smoothstep.h"
#include "terrain/math/vec.h"

#include <cmath>

namespace hoodoo
{

/// Where a scene is seen from, and how wide a pixel's cone is at a place.
struct DetailView {
    Vec3d eye{0.0};
    double spread = 0.0;  ///< width of a pixel a metre of distance
    double slack = 0.0;   ///< metres taken off every distance: what is moved by less is never coarser than the pixel that sees it

    double footprint(double distance) const { return spread * std::max(0.0, distance - slack); }
};

/// Nearest and farthest distance of a box's points from `p`, over the first `axes` axes; infinite boxes are allowed.
inline Interval distances(const Box3d& box, const Vec3d& p, int axes = 3)
{
    double near = 0.0, far = 0.0;
    for (int k = 0; k < axes; ++k) {
        const double d = std::max({0.0, box.min[k] - p[k], p[k] - box.max[k]});
        const double e = std::max(std::abs(box.min[k] - p[k]), std::abs(box.max[k] - p[k]));
        near += d * d;
        far += e * e;
    }
    return {std::sqrt(near), std::sqrt(far)};
}

/// A weight that falls from 1 where the footprint is `from` metres to 0 where it is twice that: w = 1 - smoothstep(footprint / from - 1). With s =
/// spread / from, |grad w| <= 3/2 s and |grad w(p) - grad w(q)| <= 6 s^2 |p - q|: the fade begins at a distance of 1 / s or more, so that across the
/// ray w' / r <= 3/2 s^2 is the smaller one.
class DetailFade
{
public:
    DetailFade(const DetailView& view, double from) : view_(view), from_(from) {}

    struct Weight {
        double value = 1.0;
        Vec3d gradient{0.0};
    };
    /// `axes` 2: by the horizontal distance.
    Weight at(const Vec3d& p, int axes = 3) const
    {
        Vec3d away = p - view_.eye;
        if (axes == 2) away.z = 0.0;
        const double r = away.length(), a = view_.footprint(r) / from_ - 1.0;
        if (!(a > 0.0)) return {};
        return {1.0 - smoothstep(a), away * (-smoothstep_slope(a) * view_.spread / (from_ * r))};
    }

    struct Bound {
        Interval value{1.0, 1.0};
        double slope = 0.0, curve = 0.0;
    };
    Bound over(const Box3d& box, int axes = 3) const
    {
        const Interval r = distances(box, view_.eye, axes);
        const Interval a{view_.footprint(r.lo * (1.0 - 1e-14)) / from_ - 1.0, view_.footprint(r.hi * (1.0 + 1e-14)) / from_ - 1.0};
        Bound bound;
        bound.value = {1.0 - smoothstep(a.hi), 1.0 - smoothstep(a.lo)};
        const double s = view_.spread / from_;
        bound.slope = smoothstep_steepest(a) * s;
        if (a.hi > 0.0 && a.lo < 1.0) bound.curve = 6.0 * s * s;
        return bound;
    }

private:
    DetailView view_;
    double from_;
};

}  // namespace hoodoo
