// Random numbers: the points are Boost's, the scrambling is nested, the sets are nets and independent of each other.
#include "renderer/transport/sampler.h"

#include <boost/random/sobol.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace hoodoo
{
namespace
{

TEST(Sampler, points_are_those_of_boosts_engine)
{
    // Boost walks the sequence in the order of Gray codes and skips the origin: point i of it is point i ^ (i >> 1) of ours.
    constexpr unsigned dimensions = 60;
    boost::random::sobol_engine<std::uint32_t, 32> engine(dimensions);
    for (std::uint32_t i = 1; i < 600; ++i)
        for (unsigned d = 0; d < dimensions; ++d) ASSERT_EQ(engine(), sobol_bits(i ^ (i >> 1), d)) << "point " << i << ", dimension " << d;
}

TEST(Sampler, scrambling_flips_a_bit_by_the_bits_above_it_only)
{
    for (std::uint32_t seed : {0u, 1u, 0x12345678u, 0xffffffffu}) {
        std::set<std::uint32_t> images;
        for (std::uint32_t prefix = 0; prefix < 256; ++prefix) {
            const std::uint32_t high = owen_scramble(prefix << 24, seed) >> 24;
            images.insert(high);
            // Whatever the lower bits are, the upper eight stay.
            for (const std::uint32_t low : {1u, 0xabcdefu, 0xffffffu}) EXPECT_EQ(owen_scramble(prefix << 24 | low, seed) >> 24, high);
        }
        EXPECT_EQ(images.size(), 256u) << "a bijection on the upper bits";
    }
}

/// Whether the first 2^m samples of dimensions a and b of a set have exactly one point in each elementary box of area 2^-m.
bool is_net(const Sampler& at, std::uint32_t set, unsigned a, unsigned b, unsigned m)
{
    const std::uint32_t n = 1u << m;
    std::vector<std::array<double, 2>> points(n);
    Sampler sampler = at;
    for (std::uint32_t i = 0; i < n; ++i) {
        sampler.start(i);
        const auto u = sampler.get(set);
        points[i] = {u[a], u[b]};
    }
    for (unsigned k = 0; k <= m; ++k) {
        std::vector<int> boxes(n);
        for (const auto& p : points)
            ++boxes[static_cast<std::size_t>(p[0] * (1u << k)) * (1u << (m - k)) + static_cast<std::size_t>(p[1] * (1u << (m - k)))];
        if (std::any_of(boxes.begin(), boxes.end(), [](int c) { return c != 1; })) return false;
    }
    return true;
}

TEST(Sampler, every_set_is_a_net_over_every_power_of_two)
{
    for (std::uint32_t set : {0u, 1u, 7u, 100u})
        for (unsigned m = 0; m <= 10; ++m)
            EXPECT_TRUE(is_net(Sampler(3, 0, Vec2i(5, 9), 0), set, 0, 1, m)) << "set " << set << ", 2^" << m << " samples";
}

TEST(Sampler, the_third_and_fourth_dimension_are_a_worse_net_so_the_test_can_fail)
{
    bool all = true;
    for (unsigned m = 1; m <= 10; ++m) all = all && is_net(Sampler(3, 0, Vec2i(5, 9), 0), 1, 2, 3, m);
    EXPECT_FALSE(all);
}

/// Mean over pixels of the squared mean over samples of (u - 1/2)(v - 1/2): the variance of a pixel's estimate of a product of two sets.
double pairing_variance(unsigned set_a, unsigned set_b, std::uint32_t samples)
{
    double sum = 0.0;
    constexpr int pixels = 1024;
    for (int p = 0; p < pixels; ++p) {
        Sampler sampler(1, 0, Vec2i(p % 32, p / 32), 0);
        double mean = 0.0;
        for (std::uint32_t s = 0; s < samples; ++s) {
            sampler.start(s);
            mean += (sampler.get(set_a)[0] - 0.5) * (sampler.get(set_b)[0] - 0.5) / samples;
        }
        sum += mean * mean / pixels;
    }
    return sum;
}

TEST(Sampler, sets_of_one_pixel_pair_up_at_random)
{
    // Randomly paired sets: variance (1/12)^2 / n, times 5/3 since neighbours in the sequence repel each other in both. Sets whose leading bits agree
    // would keep (1/16)^2 = 4e-3 however many samples are taken.
    for (const std::uint32_t n : {64u, 1024u}) EXPECT_LT(pairing_variance(1, 2, n), 2.0 / 144.0 / n);
}

TEST(Sampler, pixels_frames_replicates_and_seeds_have_their_own_points)
{
    const auto first = [](std::uint64_t seed, std::uint32_t frame, Vec2i pixel, std::uint32_t replicate) {
        Sampler s(seed, frame, pixel, replicate);
        s.start(0);
        return s.get(0);
    };
    const auto base = first(1, 0, Vec2i(0, 0), 0);
    EXPECT_EQ(base, first(1, 0, Vec2i(0, 0), 0));
    EXPECT_NE(base, first(2, 0, Vec2i(0, 0), 0));
    EXPECT_NE(base, first(1, 1, Vec2i(0, 0), 0));
    EXPECT_NE(base, first(1, 0, Vec2i(1, 0), 0));
    EXPECT_NE(base, first(1, 0, Vec2i(0, 1), 0));
    EXPECT_NE(base, first(1, 0, Vec2i(0, 0), 1));
    EXPECT_NE(first(1, 0, Vec2i(1, 0), 0), first(1, 0, Vec2i(0, 1), 0));
}

TEST(Sampler, numbers_stay_in_the_half_open_unit_interval_and_are_even)
{
    std::array<double, 4> sum{};
    constexpr int pixels = 4096;
    for (int p = 0; p < pixels; ++p) {
        Sampler s(9, 2, Vec2i(p, 3 * p), 1);
        s.start(static_cast<std::uint32_t>(p));
        const auto u = s.get(5);
        for (unsigned d = 0; d < 4; ++d) {
            ASSERT_GE(u[d], 0.0);
            ASSERT_LT(u[d], 1.0);
            sum[d] += u[d] / pixels;
        }
    }
    // Standard error 1 / sqrt(12 * 4096) = 0.0045: six of them.
    for (const double mean : sum) EXPECT_NEAR(mean, 0.5, 0.027);
}

}  // namespace
}  // namespace hoodoo
