// The cross-section of a breaking wave: where a point of the water was before the flow curled it over (Gamito2001, section 4.2).
#pragma once

#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

namespace hoodoo
{

/// Metres, in the frame of the wave: x right, z up from the rotation's centre; the wave runs to -x; water at rest lies below z = -depth.
struct WaveShape {
    double outer = 20.0;  ///< R1: beyond it nothing moves
    double core = 0.75;   ///< R2 < R1: inside it everything turns as one
    double alpha = 4.0;   ///< >= 1: how fast the motion fades between the two
    double depth = 0.75;  ///< of the water at rest below the centre
};

/// Where a point came from, with the derivatives of that by x, z and by the intensity T.
struct WaveOrigin {
    Vec2d at{0.0};               ///< (x0, z0); clamped ones lie in air, `depth` or more above the rest level
    Vec2d by_x{0.0}, by_z{0.0};  ///< of (x0, z0)
    Vec2d by_duration{0.0};      ///< of (x0, z0)
    double falling = 0.0;        ///< time since the water left the circle, in units of T; 0 on it
};

/// Bounds of one of the two maps over a box and a range of T. Each number bounds a magnitude unless it is an interval.
struct WaveBound {
    Interval x0, z0;
    Interval by_x[2], by_z[2];  ///< of (x0, z0)
    Interval by_duration[2];
    double second = 0.0;           ///< norm of the second derivative of either coordinate by (x, z); infinite across a kink of z0
    bool x0_bends = false;         ///< the gradient of x0 jumps inside: at the edge of a clamp, in air
    double duration_slope = 0.0;   ///< norm of the gradient by (x, z) of the derivative by T
    double duration_second = 0.0;  ///< second derivative by T
};

/// The two inverse maps. The water is the union of both images: circular for x >= 0; for x < 0 whichever holds water (the union rule: taking the
/// parabola wherever it is defined, as printed, tears the trough). Pure values.
class WaveProfile
{
public:
    explicit WaveProfile(const WaveShape& shape) : shape_(shape) {}
    const WaveShape& shape() const { return shape_; }

    double speed(double r) const;        ///< v: 1 at the core's rim, 0 from the outer radius on
    double speed_slope(double r) const;  ///< v'
    double turn(double r) const;         ///< omega = v / r

    /// Equation 9 backwards: rotation about the centre by omega(rho) T. `duration` = T >= 0.
    WaveOrigin circular(const Vec2d& p, double duration) const;
    /// Equation 10 backwards, for x < 0: along its parabola to x = 0, from there along the circle.
    WaveOrigin parabolic(const Vec2d& p, double duration) const;
    /// The places alone.
    Vec2d circular_place(const Vec2d& p, double duration) const;
    Vec2d parabolic_place(const Vec2d& p, double duration) const;

    /// For boxes on one side of x = 0 (touching it allowed), T in `duration`. The parabolic one for x <= 0.
    WaveBound circular_bound(const Interval& x, const Interval& z, const Interval& duration) const;
    WaveBound parabolic_bound(const Interval& x, const Interval& z, const Interval& duration) const;

private:
    double shear(double r) const;        ///< r omega'(r); 0 in the core
    double shear_slope(double r) const;  ///< its derivative
    WaveShape shape_;
};

}  // namespace hoodoo
