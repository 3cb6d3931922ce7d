// The phase function of Henyey1941,  p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^(3/2)),  c the cosine of the deflection, and its inversion
//     c = (1 + g^2 - s^2) / (2 g),  s = (1 - g^2) / (1 - g + 2 g u);   near g = 0, where that cancels, the expansion  c = 1 - 2 u', to first order
// in g (below |g| = 1e-4 the second order is under the rounding of a float). With u = 0 the light goes back, with u = 1 on: s falls as u grows.
// Missing: the narrow forward peak of real droplets and the glory behind it, which a single mean cosine cannot hold.
#include "renderer/media/phase.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kEven = 1e-4;

}  // namespace

double HenyeyGreenstein::value(const Vec3d& wo, const Vec3d& wi) const
{
    const double c = -wo.dot(wi), q = 1.0 + g_ * g_ - 2.0 * g_ * c;
    return (1.0 - g_ * g_) / (4.0 * kPi * q * std::sqrt(q));
}

Vec3d HenyeyGreenstein::sample(const Vec3d& wo, const Vec2d& u) const
{
    double c = 2.0 * u.x - 1.0;
    if (std::abs(g_) < kEven) {
        c += 1.5 * g_ * (1.0 - c * c);  // the root of u = (1 + c)/2 - 3/4 g (1 - c^2) to first order
    } else {
        const double s = (1.0 - g_ * g_) / (1.0 - g_ + 2.0 * g_ * u.x);
        c = (1.0 + g_ * g_ - s * s) / (2.0 * g_);
    }
    c = std::clamp(c, -1.0, 1.0);
    const double sine = std::sqrt(1.0 - c * c), angle = 2.0 * kPi * u.y;
    Vec3d tangent, bitangent;
    orthonormal_frame(-wo, tangent, bitangent);
    return tangent * (sine * std::cos(angle)) + bitangent * (sine * std::sin(angle)) - wo * c;
}

}  // namespace hoodoo
