// A sea with breaking waves as one implicit function of space and time: swell, and waves that curl, throw, fall and collapse along their crests.
#pragma once

#include "terrain/fields/breaker.h"
#include "terrain/fields/swell.h"
#include "terrain/fields/warped_field.h"

#include <vector>

namespace hoodoo
{

/// Where the water of a point was before the waves curled it over, with the derivatives of that.
struct SeaRest {
    Vec3d point{0.0};                                       ///< where textures are looked up; the water at rest lies at the sea's level
    Vec3d gradient[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< of its x, y and z
};

/// What one breaker makes of a point.
struct BreakerPoint {
    Vec3d local{0.0};  ///< x against the heading, y along the crest from its middle, z up, from the rotation's centre
    BreakerLife life;
    WaveOrigin flying;         ///< along the parabola; all zero for x >= 0
    WaveOrigin origin;         ///< of the branch that holds water
    double turned = 0.0;       ///< F_wave on the circular branch
    double flown = kInfinity;  ///< and on the parabolic one
};

/// The same over a box and a span of times, proved.
struct BreakerPointBound {
    Interval x, y, z;
    BreakerBound life;
    Interval turned;
    Interval flown{kInfinity, kInfinity}, flown_x0;  ///< of the part of the box with x < 0
};

/// F(x, y, z, t), metres, negative in water. Each breaker alone is (1 - c) F_wave + c F_bore, with F_wave the union of the two images of
/// WaveProfile at the intensity T(y, t), and c from 0 to 1 while the fallen wave collapses: a blend of level functions, so that nothing jumps. The
/// sea is the swell plus what each breaker differs from it; far from their crests that is nothing. Immutable.
class BreakingSea
{
public:
    BreakingSea(std::vector<Breaker> breakers, Swells swell, double level);

    double value(const Vec3d& p, double t) const;
    /// Of eight points at once, equal up to rounding (sea_kernel.h).
    void values(const Vec3d (&p)[8], double t, double* out) const;
    /// Gradient by (x, y, z), and by time.
    Vec3d gradient(const Vec3d& p, double t, double* by_time = nullptr) const;
    /// Proved, for all t of `times`.
    LocalField local(const Box3d& box, const Interval& times) const;
    /// A blend over the waves that is continuous in space and time: white water forgets where it came from.
    SeaRest rest(const Vec3d& p, double t) const;
    BreakerPoint point(const Breaker& b, const Vec3d& p, double t) const;
    BreakerPointBound point_bound(const Breaker& b, const Box3d& box, const Interval& times) const;

    /// Heights between which the surface lies, at all times.
    Interval heights() const;
    double level() const { return level_; }
    const std::vector<Breaker>& breakers() const { return breakers_; }
    const Swells& swell() const { return swell_; }

private:
    /// What one breaker differs from the calm sea.
    struct Deviation {
        double value = 0.0;
        Vec3d gradient{0.0};
        double by_time = 0.0;
    };

    double deviation_value(const Breaker& b, const Vec3d& p, double t, double calm) const;
    Deviation deviation(const Breaker& b, const Vec3d& p, double t) const;
    LocalField deviation_bound(const Breaker& b, const Box3d& box, const Interval& times) const;
    LocalField sum_of_bounds(const Box3d& box, const Interval& times) const;

    std::vector<Breaker> breakers_;
    Swells swell_;
    double level_;
};

}  // namespace hoodoo
