// One breaking wave: its shape, its way over the sea, and where in its life it is at each place of its crest.
#pragma once

#include "terrain/fields/wave_profile.h"

#include <algorithm>

namespace hoodoo
{

/// One wave and its life. Lengths in metres, times in seconds of the scene.
struct Breaker {
    WaveShape shape;
    Vec2d centre{0.0};         ///< of the crest at time 0
    Vec2d heading{-1.0, 0.0};  ///< unit, the way it runs
    double speed = 4.0;        ///< of the crest
    double intensity = 4.3;    ///< T at the height of its life, metres that the core's rim has turned
    double start = 0.0;        ///< when the crest's middle begins to steepen
    double steepening = 4.0;   ///< from there to full intensity
    double peel = 6.0;         ///< how fast the break runs along the crest from its middle
    double peel_width = 4.0;   ///< of the middle that breaks at once
    double collapse = 1.5;     ///< how long the fallen wave takes to become white water
    double decay = 6.0;        ///< of the white water
    double bore = 0.9;         ///< height of the white water

    double bore_width() const { return 0.35 * shape.outer; }  ///< about half of the white water's
    /// Section of the white water: (1 - (x / R1)^2)^8, about a bell of that width, and nothing where nothing turns.
    double bump(double x) const
    {
        const double s = x / shape.outer, a = std::max(0.0, 1.0 - s * s), b = a * a, c = b * b;
        return c * c;
    }
    double bump_slope(double x) const
    {
        const double s = x / shape.outer, a = std::max(0.0, 1.0 - s * s), b = a * a;
        return -16.0 * s / shape.outer * b * b * b * a;
    }
    Vec2d centre_at(double t) const { return centre + heading * (speed * t); }
    Vec2d across() const { return -heading; }                     ///< local x: against the way it runs
    Vec2d along() const { return Vec2d(heading.y, -heading.x); }  ///< local y: along the crest
};

/// At one place of the crest, with derivatives by y and t.
struct BreakerLife {
    double duration = 0.0, duration_y = 0.0, duration_t = 0.0;  ///< T
    double fallen = 0.0, fallen_y = 0.0, fallen_t = 0.0;        ///< c: 0 a wave, 1 white water
    double white = 0.0, white_y = 0.0, white_t = 0.0;           ///< height of the white water once it is there, metres
    double since_fall = 0.0;                                    ///< seconds since the collapse began; negative before
};

/// Over a stretch of the crest and a span of times. Proved; derivatives by y as magnitudes.
struct BreakerBound {
    Interval duration, fallen, white, since_fall;
    double duration_y = 0.0, duration_yy = 0.0, fallen_y = 0.0, fallen_yy = 0.0, white_y = 0.0, white_yy = 0.0;
};

/// `y` along the crest from its middle, `t` in seconds.
BreakerLife life(const Breaker& b, double y, double t);
BreakerBound life_bound(const Breaker& b, const Interval& y, const Interval& times);

}  // namespace hoodoo
