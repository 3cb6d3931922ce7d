// Swell: trains of small waves on the water at rest, as a height over the plane and time.
#pragma once

#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

#include <vector>

namespace hoodoo
{

/// A train of small waves on the water at rest: amplitude cos(k . p - omega t + phase), omega by the dispersion of deep water.
struct Swell {
    double amplitude = 0.1;       ///< metres
    Vec2d wave_number{0.1, 0.0};  ///< radians a metre, along the way it runs
    double frequency = 1.0;       ///< radians a second
    double phase = 0.0;
};

/// The swell fades to nothing between these distances, in x and in y, from `centre`; metres.
struct SwellFade {
    double inner = 1e30, outer = 2e30;
    Vec2d centre{0.0};
};

/// The trains together, faded out far away. Immutable.
class Swells
{
public:
    /// Metres, and metres a metre or second.
    struct Height {
        double height = 0.0;
        Vec2d slope{0.0};
        double by_time = 0.0;
    };
    /// Proved; `second` bounds the norm of the second derivatives by x and y, 1/m.
    struct Bound {
        Interval height, slope[2];
        double second = 0.0;
    };

    Swells() = default;
    explicit Swells(std::vector<Swell> trains, const SwellFade& fade = {});

    bool empty() const { return trains_.empty(); }
    Height at(const Vec2d& p, double t) const;
    double height(const Vec2d& p, double t) const;  ///< of at()
    /// For all points of a rectangle and all of these times.
    Bound bound(const Interval& x, const Interval& y, const Interval& times) const;
    /// No point is higher or lower, metres.
    double amplitude() const { return amplitude_; }
    const std::vector<Swell>& trains() const { return trains_; }
    const SwellFade& fade() const { return fade_; }

private:
    std::vector<Swell> trains_;
    SwellFade fade_;
    double amplitude_ = 0.0;
};

}  // namespace hoodoo
