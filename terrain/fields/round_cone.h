// The hull of two balls: what a ball sweeps that changes its size evenly. The piece that curves are made of.
#pragma once

#include "terrain/math/vec.h"

#include <algorithm>

namespace hoodoo
{

/// F(p) = min over t in [0, 1] of |p - (a + t (b - a))| - (ra + t (rb - ra)): negative inside, metres. 1-Lipschitz, as a minimum of such; with both
/// radii at least 0 its gradient turns by at most 1 / (F + least radius) a metre, where that is above 0.
struct RoundCone {
    Vec3d a, b;
    double ra, rb;

    struct Sample {
        double value;
        Vec3d towards;  ///< unit: the gradient; 0 on the skeleton
        double t;       ///< place of the nearest ball
    };

    Sample sample(const Vec3d& p) const
    {
        const Vec3d axis = b - a, q = p - a;
        const double length2 = axis.length2(), grow = rb - ra;
        double t = 0.0;
        if (length2 <= grow * grow) {
            // One ball holds the other.
            t = ra >= rb ? 0.0 : 1.0;
        } else {
            // d/dt [ |q - t axis| - t grow ] = 0: the foot of p slides along the axis by h grow / sqrt(length^2 - grow^2), h the distance from the
            // axis.
            const double foot = q.dot(axis) / length2, away = (q - axis * foot).length();
            t = std::clamp(foot + away * grow / std::sqrt(length2 * (length2 - grow * grow)), 0.0, 1.0);
        }
        const Vec3d from = q - axis * t;
        const double distance = from.length();
        return {distance - (ra + t * grow), distance > 0.0 ? from / distance : Vec3d(0.0), t};
    }
    double distance(const Vec3d& p) const { return sample(p).value; }
    double least_radius() const { return std::min(ra, rb); }
    Box3d bounds() const
    {
        Box3d box(a - Vec3d(ra), a + Vec3d(ra));
        box.extendBy(b - Vec3d(rb));
        box.extendBy(b + Vec3d(rb));
        return box;
    }
};

}  // namespace hoodoo
