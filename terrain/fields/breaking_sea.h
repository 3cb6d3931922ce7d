// A sea with breaking waves as one implicit function of space and time: swell, and waves that curl, throw, fall and collapse along their crests.
#pragma once

#include "terrain/fields/swell.h"
#include "terrain/fields/warped_field.h"
#include "terrain/fields/wave_profile.h"

#include <array>
#include <vector>

namespace hoodoo
{

/// One wave and its life. Lengths in metres, times in seconds of the scene.
struct Breaker {
    WaveShape shape;
    Vec2d centre{0.0};         ///< of the crest at time 0
    Vec2d heading{-1.0, 0.0};  ///< unit, the way it runs
    double speed = 4.0;        ///< of the crest
    double intensity = 4.3;    ///< T at the height of its life
    double start = 0.0;        ///< when the crest's middle begins to steepen
    double steepening = 4.0;   ///< from there to full intensity
    double peel = 6.0;         ///< how fast the break runs along the crest from its middle
    double peel_width = 4.0;   ///< of the middle that breaks at once
    double collapse = 1.5;     ///< how long the fallen wave takes to become white water
    double decay = 6.0;        ///< of the white water
    double bore = 0.9;         ///< height of the white water
};

/// F(x, y, z, t), metres, negative in water. Each breaker alone is (1 - c) F_wave + c F_bore, with F_wave the union of the two images of
/// WaveProfile at the intensity T(y, t), and c from 0 to 1 while the fallen wave collapses: a blend of level functions, so that nothing jumps. The
/// sea is the swell plus what each breaker differs from it; far from their crests that is nothing. Immutable.
class BreakingSea
{
public:
    BreakingSea(std::vector<Breaker> breakers, Swells swell, double level);

    double value(const Vec3d& p, double t) const;
    /// Gradient by (x, y, z), and by time.
    Vec3d gradient(const Vec3d& p, double t, double* by_time = nullptr) const;
    /// Proved, for all t of `times`.
    LocalField local(const Box3d& box, const Interval& times) const;
    /// Where the water of a point was before the nearest breaker curled it over: the place where textures are looked up, with how long it has been
    /// falling (in units of T; 0 on the circle).
    Vec3d rest(const Vec3d& p, double t, double* falling = nullptr) const;

    /// Heights between which the surface lies, at all times.
    Interval heights() const;

private:
    /// What one breaker differs from the calm sea.
    struct Deviation {
        double value = 0.0;
        Vec3d gradient{0.0};
        double by_time = 0.0;
        Vec3d rest{0.0};
        double falling = 0.0;
        double strength = 0.0;  ///< how much of a wave there is: 0 far away
    };
    struct Life;
    struct LifeBound;

    Deviation deviation(const Breaker& b, const Vec3d& p, double t) const;
    LocalField deviation_bound(const Breaker& b, const Box3d& box, const Interval& times) const;
    static Life life(const Breaker& b, double y, double t);
    static LifeBound life_bound(const Breaker& b, const Interval& y, const Interval& times);

    std::vector<Breaker> breakers_;
    Swells swell_;
    double level_;
};

}  // namespace hoodoo
