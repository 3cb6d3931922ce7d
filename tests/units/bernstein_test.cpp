// First sign changes of cubics whose roots are known by construction.

#include "terrain/march/bernstein.h"

#include "terrain/math/hash.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

/// a (u - r0)(u - r1)(u - r2) in Bernstein form: by blossoming, coefficient k is a times the mean over all orders of the product with k arguments 1
/// and 3 - k arguments 0.
Cubic with_roots(double a, double r0, double r1, double r2)
{
    const double m0 = -r0, m1 = -r1, m2 = -r2, p0 = 1.0 - r0, p1 = 1.0 - r1, p2 = 1.0 - r2;
    return {a * m0 * m1 * m2, a * (p0 * m1 * m2 + m0 * p1 * m2 + m0 * m1 * p2) / 3.0, a * (p0 * p1 * m2 + p0 * m1 * p2 + m0 * p1 * p2) / 3.0,
            a * p0 * p1 * p2};
}

TEST(Bernstein, the_first_of_three_roots_is_found_from_either_side)
{
    double u = -1.0;
    // -(u - 1/4)(u - 1/2)(u - 3/4) is positive at 0.
    ASSERT_TRUE(first_change(with_roots(-1.0, 0.25, 0.5, 0.75), false, u));
    EXPECT_NEAR(u, 0.25, 1e-15);
    ASSERT_TRUE(first_change(with_roots(1.0, 0.25, 0.5, 0.75), true, u));
    EXPECT_NEAR(u, 0.25, 1e-15);
}

TEST(Bernstein, roots_agree_with_their_construction_at_random)
{
    for (int n = 0; n < 20000; ++n) {
        const auto random = [&](int k) { return unit_real(hash_cell(3, n, k)); };
        std::array<double, 3> r{3.0 * random(0) - 1.0, 3.0 * random(1) - 1.0, 3.0 * random(2) - 1.0};
        std::sort(r.begin(), r.end());
        const Cubic c = with_roots(random(3) < 0.5 ? 1.0 : -1.0, r[0], r[1], r[2]);
        const auto expected = std::find_if(r.begin(), r.end(), [](double x) { return x > 0.0; });
        const bool inside = c[0] < 0.0;
        double u = -1.0;
        const bool found = first_change(c, inside, u);
        if (expected == r.end() || *expected > 1.0 + 1e-9) {
            EXPECT_FALSE(found) << n;
            continue;
        }
        if (*expected > 1.0 - 1e-9) continue;
        // Two roots close together may round into none.
        if (expected + 1 != r.end() && expected[1] - expected[0] < 1e-6) continue;
        ASSERT_TRUE(found) << n;
        // The error of a root is the rounding of the coefficients over the slope there, at least the product of the gaps.
        EXPECT_NEAR(u, *expected, 1e-8) << n;
    }
}

TEST(Bernstein, a_touch_is_no_change_and_a_dip_below_it_is)
{
    // (u - 1/2)^2 raised to degree 3: (1/4, -1/12, -1/12, 1/4). A twelfth is rounded, so the exact touch may be either, but only at 1/2.
    double u = 0.5;
    first_change({0.25, -1.0 / 12.0, -1.0 / 12.0, 0.25}, false, u);
    EXPECT_NEAR(u, 0.5, 1e-7);
    Cubic dip{0.25, -1.0 / 12.0, -1.0 / 12.0, 0.25};
    for (double& c : dip) c -= 1e-12;
    ASSERT_TRUE(first_change(dip, false, u));
    EXPECT_NEAR(u, 0.5 - 1e-6, 1e-8);  // (u - 1/2)^2 = 1e-12
    for (double& c : dip) c += 2e-12;
    EXPECT_FALSE(first_change(dip, false, u));
}

TEST(Bernstein, zero_everywhere_is_air)
{
    double u = -1.0;
    EXPECT_FALSE(first_change({0.0, 0.0, 0.0, 0.0}, false, u));
}

TEST(Bernstein, a_wrong_side_at_the_start_is_a_change_there)
{
    double u = -1.0;
    ASSERT_TRUE(first_change({-1e-17, 1.0, 1.0, 1.0}, false, u));
    EXPECT_EQ(u, 0.0);
}

}  // namespace
}  // namespace hoodoo
