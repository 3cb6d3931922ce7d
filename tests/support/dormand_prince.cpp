// Dormand1980's embedded pair with the usual control of the step.

#include "tests/support/dormand_prince.h"

#include <algorithm>
#include <array>

namespace hoodoo::testing
{

Vec3d follow(const Flow& flow, const Vec3d& p, double t0, double t1, double tolerance)
{
    static constexpr double a[7][6] = {{},
                                       {1.0 / 5},
                                       {3.0 / 40, 9.0 / 40},
                                       {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                       {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                       {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                       {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static constexpr double c[7] = {0.0, 0.2, 0.3, 0.8, 8.0 / 9, 1.0, 1.0};
    static constexpr double e[7] = {71.0 / 57600, 0.0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    Vec3d x = p;
    double t = t0, h = (t1 - t0) / 64.0;
    while (t != t1) {
        if (std::abs(h) >= std::abs(t1 - t)) h = t1 - t;
        std::array<Vec3d, 7> k;
        Vec3d y;
        for (std::size_t s = 0; s < 7; ++s) {
            y = x;
            for (std::size_t r = 0; r < s; ++r) y += k[r] * (a[s][r] * h);
            k[s] = flow.velocity(y, t + c[s] * h);
        }
        Vec3d error(0.0);
        for (std::size_t s = 0; s < 7; ++s) error += k[s] * (e[s] * h);
        const double ratio = error.length() / tolerance;
        if (ratio <= 1.0 || std::abs(h) < 1e-9) {
            x = y;
            t = h == t1 - t ? t1 : t + h;
        }
        h *= std::clamp(0.9 * std::pow(std::max(ratio, 1e-10), -0.2), 0.2, 5.0);
    }
    return x;
}

}  // namespace hoodoo::testing
