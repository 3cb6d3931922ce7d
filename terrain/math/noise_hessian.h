// Gradient noise with its second derivatives: what flows along a noise's gradient, or around its curl, need for their own derivatives.
#pragma once

#include "terrain/math/noise.h"

namespace hoodoo
{

/// One octave of noise; second derivatives by rows, symmetric. The value and the gradient are those of gradient_noise up to rounding.
struct NoiseJet2 {
    double value = 0.0;
    Vec2d gradient{0.0};
    double xx = 0.0, xy = 0.0, yy = 0.0;
};
struct NoiseJet3 {
    double value = 0.0;
    Vec3d gradient{0.0};
    double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
};

NoiseJet2 noise_jet(const Vec2d& p, std::uint32_t seed);
NoiseJet3 noise_jet(const Vec3d& p, std::uint32_t seed);

/// Suprema over all gradients of the norms of the first, second and third derivative, as symmetric forms: |D^k n (u, ..., u)| over unit vectors u.
struct NoiseDerivativeBound {
    double slope, hessian, third;
};
constexpr NoiseDerivativeBound kNoise2Derivatives{2.0692, 9.2355, 97.083};
constexpr NoiseDerivativeBound kNoise3Derivatives{2.7923, 10.640, 115.912};

/// The same of the noise that this seed makes, over a box of the plane: proved, and close where the box is small beside a cell.
NoiseDerivativeBound noise_bound(const Imath::Box2d& box, std::uint32_t seed);

/// A bound of the second derivative of 1-D gradient noise over a span, proved; never more than kNoise1Curve, the supremum for all slopes.
constexpr double kNoise1Curve = 7.5;
double noise_curve_bound(double lo, double hi, std::uint32_t seed);

}  // namespace hoodoo
