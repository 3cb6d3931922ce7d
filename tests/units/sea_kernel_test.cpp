// Eight points at once against one at a time, where the two could part: either side of the seam and the cut, the core, the rim, white water, far
// out.
#include "terrain/fields/breaking_sea.h"
#include "terrain/fields/sea_kernel.h"
#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::Numbers;

/// A wave of the hero's shape turned by an angle, with an exponent.
Breaker wave(double heading, double alpha)
{
    Breaker b;
    b.shape = {6.0, 0.75, alpha, 0.8};
    b.heading = Vec2d(std::cos(heading), std::sin(heading));
    b.intensity = 5.0;
    return b;
}

std::vector<Swell> swells()
{
    return {{0.12, {-0.5, 0.1}, 2.2, 0.3}, {0.05, {-1.1, -0.6}, 3.5, 1.0}};
}

/// The largest difference over eights of points from `place`, relative to 1 m and what the point's size costs in rounding.
template <class Place>
double largest_difference(const BreakingSea& sea, int sets, const Place& place)
{
    double most = 0.0;
    for (int i = 0; i < sets; ++i) {
        Numbers random(401, static_cast<std::uint64_t>(i));
        const double t = random.between(0.0, 14.0);
        Vec3d p[8];
        for (Vec3d& q : p) q = place(random, t);
        double out[8];
        sea.values(p, t, out);
        for (int k = 0; k < 8; ++k) most = std::max(most, std::abs(out[k] - sea.value(p[k], t)) / (1.0 + 1e-2 * p[k].length()));
    }
    return most;
}

TEST(SeaKernel, equals_the_sea_one_point_at_a_time)
{
    for (const double alpha : {2.0, 3.0, 4.0, 2.6}) {
        const Breaker a = wave(std::numbers::pi, alpha);
        Breaker b = wave(2.2, alpha);
        b.centre = {14.0, 5.0};
        b.start = 1.5;
        const BreakingSea sea({a, b}, Swells(swells(), {60.0, 80.0, {0.0, 0.0}}), 1.25);
        const auto anywhere = [](Numbers& random, double) { return random.in(Box3d(Vec3d(-70.0, -25.0, -6.0), Vec3d(30.0, 25.0, 9.0))); };
        EXPECT_LT(largest_difference(sea, testing::count(4000, 100000), anywhere), 1e-11) << "alpha " << alpha;
        const auto far = [](Numbers& random, double) { return random.in(Box3d(Vec3d(-2e4, -2e4, -3.0), Vec3d(2e4, 2e4, 3.0))); };
        EXPECT_LT(largest_difference(sea, 500, far), 1e-11) << "alpha " << alpha;
    }
}

TEST(SeaKernel, a_point_beside_the_seam_takes_the_union)
{
    // The turned image alone jumps across x = 0, z > 0: points within rounding of it, on both sides and on it.
    const Breaker b = wave(std::numbers::pi, 2.0);
    const BreakingSea sea({b}, Swells(), 0.0);
    const auto beside = [&](Numbers& random, double t) {
        const double sizes[] = {0.0, 0x1p-1022, 1e-300, 1e-18, 1e-12, 1e-6};
        const double x = sizes[static_cast<int>(random() * 6.0)] * (random() < 0.5 ? -1.0 : 1.0), z = random.between(-6.0, 8.0);
        // Not where the frame's own rounding would decide the side: the crest is at x = -4 t.
        return Vec3d(b.centre_at(t).x + x, random.between(-20.0, 20.0), b.shape.depth + z);
    };
    EXPECT_LT(largest_difference(sea, testing::count(4000, 100000), beside), 1e-9);

    // The mutant: the turned image alone, left of the seam. Where the parabola holds water (T = 4.2, one metre above the centre) it says air.
    const WaveProfile profile(b.shape);
    const Vec2d left(-1e-9, 1.0), right(1e-9, 1.0);
    const double air = profile.circular_place(left, 4.2).y + b.shape.depth, water = profile.circular_place(right, 4.2).y + b.shape.depth;
    EXPECT_GT(std::abs(air - water), 0.5) << "the mutant passed";
    EXPECT_NEAR(std::min(air, profile.parabolic_place(left, 4.2).y + b.shape.depth), water, 1e-6);
}

}  // namespace
}  // namespace hoodoo
