// Pixel filters: the density integrates to one, samples follow it, and moments are those of the closed forms.
#include "renderer/transport/filter.h"
#include "terrain/error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hoodoo
{
namespace
{

/// Mean and deviation of one coordinate of the samples on an even grid of numbers.
double deviation(const Filter& filter)
{
    constexpr int n = 100000;
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < n; ++i) {
        const double x = filter.sample(Vec2d((i + 0.5) / n, 0.5)).x;
        mean += x / n, square += x * x / n;
    }
    EXPECT_NEAR(mean, 0.0, 1e-9);
    return std::sqrt(square);
}

TEST(Filter, deviations_are_those_of_the_closed_forms)
{
    // Box: 1 / sqrt(12). Gaussian of sigma 0.5 cut at 3 sigma: 0.5 sqrt(1 - 6 phi(3) / (2 Phi(3) - 1)) = 0.49329.
    // Blackman-Harris of width W: W sqrt(a0/12 - a1/(2 pi^2) + a2/(8 pi^2) - a3/(18 pi^2)) / sqrt(a0) = 0.138507 W.
    EXPECT_NEAR(deviation(Filter("box")), 0.288675, 1e-5);
    EXPECT_NEAR(deviation(Filter("gaussian")), 0.49329, 1e-4);
    EXPECT_NEAR(deviation(Filter("blackman-harris", 2.0)), 0.27701, 5e-4);  // its last cells are wide: a long, thin tail
}

TEST(Filter, samples_follow_the_density)
{
    for (const char* kind : {"box", "gaussian", "blackman-harris"}) {
        const Filter filter(kind);
        // The share of samples under x is the integral of the density up to x.
        constexpr int n = 20000;
        double integral = 0.0;
        for (int i = 0; i < n; ++i) {
            const double x = filter.width() * ((i + 0.5) / n - 0.5);
            integral += filter.density(x) * filter.width() / n;
            if (integral > 0.01 && integral < 0.99) {
                EXPECT_NEAR(filter.sample(Vec2d(integral, 0.5)).x, x + 0.5 * filter.width() / n, 2e-3) << kind;
            }
        }
        EXPECT_NEAR(integral, 1.0, 1e-3) << kind;
        EXPECT_EQ(filter.density(0.51 * filter.width()), 0.0);
    }
}

TEST(Filter, the_ends_of_the_unit_interval_stay_inside)
{
    const Filter filter;
    EXPECT_GE(filter.sample(Vec2d(0.0)).x, -0.5 * filter.width());
    EXPECT_LE(filter.sample(Vec2d(std::nextafter(1.0, 0.0))).x, 0.5 * filter.width());
}

TEST(Filter, an_unknown_kind_is_named)
{
    try {
        Filter("gausian");
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "unknown pixel filter, expected blackman-harris, gaussian or box, got \"gausian\" (did you mean \"gaussian\")");
    }
}

}  // namespace
}  // namespace hoodoo
