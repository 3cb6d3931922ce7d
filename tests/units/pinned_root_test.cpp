// Roots of functions that only rise or fall: found to the accuracy asked, with few evaluations, and not found where there are none.
#include "terrain/march/pinned_root.h"

#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// steepness (s - root + bend (s - root)^2 / 2) over (from, to): it rises or falls all the way where |bend| times the way to the root is below 1.
struct Case {
    double from, to, root, steepness, bend;

    double value(double s) const { return steepness * (s - root + 0.5 * bend * (s - root) * (s - root)); }
    Interval rise() const
    {
        const double a = steepness * (1.0 + bend * (from - root)), b = steepness * (1.0 + bend * (to - root));
        return {std::min(a, b), std::max(a, b)};
    }
};

template <int Batch>
bool solve(const Case& c, const Interval& rise, double guess, bool any, double accuracy, double& t, std::uint32_t& evaluations)
{
    const auto f = [&](const double* s, double* out) {
        for (int k = 0; k < Batch; ++k) out[k] = c.value(s[k]);
    };
    return pinned_root<Batch>(f, {c.from, c.to, rise, std::abs(c.steepness * c.bend), guess, 0.5 * (rise.lo + rise.hi)}, any, accuracy, t,
                              evaluations);
}

Case random_case(Numbers& random)
{
    Case c{};
    const double length = std::pow(10.0, -3.0 * random());
    c.from = random.between(0.0, 100.0), c.to = c.from + length;
    // Some roots lie outside.
    c.root = c.from + length * random.between(-0.3, 1.3);
    c.steepness = (random() < 0.5 ? -1.0 : 1.0) * std::pow(10.0, random.between(-2.0, 2.0));
    c.bend = random.between(-0.7, 0.7) / length;
    return c;
}

template <int Batch>
void expect_roots(double accuracy)
{
    Numbers random(12);
    double spent = 0.0;
    int found = 0, cases = count(5000, 500000);
    for (int i = 0; i < cases; ++i) {
        const Case c = random_case(random);
        const double inside = std::min(c.root - c.from, c.to - c.root);
        double t = 0.0;
        std::uint32_t evaluations = 0;
        const bool met = solve<Batch>(c, c.rise(), random.between(c.from, c.to), false, accuracy, t, evaluations);
        if (inside > accuracy) {
            ASSERT_TRUE(met) << i;
            ASSERT_NEAR(t, c.root, accuracy + 1e-13) << i;
            ++found, spent += evaluations;
        } else if (inside < -2.0 * accuracy) {
            ASSERT_FALSE(met) << i;
        }
        // Whether there is one is said alike.
        double anywhere = 0.0;
        ASSERT_EQ(solve<Batch>(c, c.rise(), 0.5 * (c.from + c.to), true, accuracy, anywhere, evaluations), met || (inside > 0.0 && inside < accuracy))
            << i;
    }
    EXPECT_GT(found, cases / 2);
    // From a guess anywhere in the stretch, at bends that double the slope: a few rounds.
    EXPECT_LT(spent / found, Batch == 1 ? 12.0 : 4.0 * Batch);
}

TEST(PinnedRoot, finds_the_root_one_value_at_a_time)
{
    expect_roots<1>(1e-9);
}

TEST(PinnedRoot, finds_the_root_eight_values_at_a_time)
{
    expect_roots<8>(1e-9);
}

TEST(PinnedRoot, needs_one_batch_where_the_guess_is_good)
{
    // A slope of 1 and a second derivative of 1 over a millimetre: the chord between points of the inner pairs is off by less than 1e-8.
    const Case c{5.0, 5.001, 5.00052, -1.0, 1.0};
    double t = 0.0;
    std::uint32_t evaluations = 0;
    ASSERT_TRUE(solve<8>(c, c.rise(), 5.0005, false, 1e-7, t, evaluations));
    EXPECT_NEAR(t, c.root, 1e-7);
    EXPECT_EQ(evaluations, 8u);
}

TEST(PinnedRoot, is_lost_where_slopes_are_said_to_be_less_than_they_are)
{
    Numbers random(13);
    int wrong = 0;
    for (int i = 0; i < 1000; ++i) {
        Case c = random_case(random);
        c.bend = 0.0;
        if (std::min(c.root - c.from, c.to - c.root) < 1e-6) continue;
        double t = 0.0;
        std::uint32_t evaluations = 0;
        const Interval mutant{0.9 * c.steepness, 0.9 * c.steepness};
        wrong += !solve<1>(c, mutant, c.from, false, 1e-9, t, evaluations) || std::abs(t - c.root) > 1e-9;
    }
    EXPECT_GT(wrong, 300);
}

}  // namespace
}  // namespace hoodoo
