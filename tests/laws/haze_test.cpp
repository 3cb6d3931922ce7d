// Haze in closed form against quadrature, its inverse, and even flights against what they must come to in the mean.
#include "renderer/media/haze.h"
#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::Numbers;

constexpr double kBase = 2.0, kHeight = 40.0;

/// Midpoints over the density itself, in pieces on either side of the base.
double quadrature(const Vec3d& o, const Vec3d& d, double t)
{
    constexpr int n = 200000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += std::exp(-std::max(0.0, o.z + d.z * t * (i + 0.5) / n - kBase) / kHeight);
    return sum * t / n;
}

TEST(Haze, columns_equal_their_quadrature)
{
    const Haze haze({}, kBase, kHeight);
    Numbers random(6);
    for (int k = 0; k < testing::count(60, 1000); ++k) {
        const Vec3d o(0, 0, random.between(-50.0, 150.0)), d = random.direction();
        const double t = random.between(0.1, 300.0);
        const double exact = quadrature(o, d, t);
        EXPECT_NEAR(haze.column(o, d, t) / exact, 1.0, 1e-6) << "from " << o.z << " along " << d.z << " for " << t;
        EXPECT_NEAR(haze.distance(o, d, haze.column(o, d, t)) / t, 1.0, 1e-9);
        // The mutant: a density without a floor at the base.
        if (o.z < kBase - 10.0 && d.z < 0.0) {
            EXPECT_GT(std::exp((kBase - o.z) / kHeight) * t / exact, 1.1) << "the mutant passed";
        }
    }
}

TEST(Haze, level_rays_keep_their_digits)
{
    // exp(-x) cancels for a rise of 1e-14: the column is that of a level ray, t e^(-h / H), to the last digits.
    const Haze haze({}, kBase, kHeight);
    const Vec3d o(0, 0, kBase + 10.0);
    const double level = 1000.0 * std::exp(-10.0 / kHeight);
    for (const double rise : {0.0, 1e-14, -1e-14, 1e-11}) EXPECT_NEAR(haze.column(o, Vec3d(1, 0, rise), 1000.0) / level, 1.0, 1e-9) << rise;
}

TEST(Haze, an_endless_ray_leaves_it_upwards_alone)
{
    const Haze haze({}, kBase, kHeight);
    const Vec3d o(0, 0, kBase);
    EXPECT_NEAR(haze.column(o, Vec3d(0, 0.6, 0.8), kInfinity), kHeight / 0.8, 1e-12);
    EXPECT_EQ(haze.column(o, Vec3d(0, 1, 0), kInfinity), kInfinity);
    EXPECT_EQ(haze.distance(o, Vec3d(0, 0.6, 0.8), kHeight / 0.8 + 1.0), kInfinity);
}

TEST(Flight, weights_come_to_transmittance_and_to_what_is_scattered)
{
    // Through: exp(-(a + b) c). Scattered on the way: b / (a + b) (1 - exp(-(a + b) c)). Weights are under 3: the error of n is under 3 / sqrt(n).
    const Coefficients medium{Vec3d(0.3, 0.1, 0.0), Vec3d(0.2, 0.5, 1.1), 0.0};
    const double column = 1.7;
    Numbers random(9);
    Vec3d through(0.0), scattered(0.0);
    const int n = testing::count(1000000, 20000000);
    for (int k = 0; k < n; ++k) {
        const double u = random(), v = random();
        const Flight flight = fly(medium, column, {u, v});
        (flight.scattered ? scattered : through) += Vec3d(flight.weight) / n;
    }
    for (int c = 0; c < 3; ++c) {
        const double all = medium.absorption[c] + medium.scattering[c], passing = std::exp(-all * column);
        EXPECT_NEAR(through[c], passing, 0.004);
        EXPECT_NEAR(scattered[c], medium.scattering[c] / all * (1.0 - passing), 0.004);
        EXPECT_NEAR(transmittance(medium, column)[c], passing, 1e-6);
    }
}

}  // namespace
}  // namespace hoodoo
