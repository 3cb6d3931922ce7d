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

}  // namespace hoodoo
