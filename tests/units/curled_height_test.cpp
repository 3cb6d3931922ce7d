// Curled plates: the formula at places that can be worked out, and every bound against what is sampled.
#include "terrain/fields/curled_height.h"
#include "tests/support/numbers.h"
#include "tests/support/wavy_ground.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::Numbers;
using testing::WavyHeight;

const Box2d kUnit(Vec2d(0.0), Vec2d(1.0));

std::vector<Vec2d> sites(int n)
{
    return crack_sites(5, n, kUnit, SiteKind::random);
}

CurledHeight curled(double rise = 0.08, double reach = 0.05, int n = 60)
{
    return CurledHeight(std::make_shared<WavyHeight>(), VoronoiDiagram(sites(n), crack_box(n, kUnit)), Vec2d(0.0), rise, reach);
}

/// s by its definition, with distances to bisectors from the sites' places.
double smooth_by_hand(const VoronoiDiagram& diagram, const Vec2d& p)
{
    const std::uint32_t own = diagram.nearest(p);
    double sum = 0.0;
    for (const VoronoiDiagram::Border& border : diagram.borders(own)) {
        const Vec2d a = diagram.sites()[own], b = diagram.sites()[border.neighbour];
        const double d = ((b - p).length2() - (a - p).length2()) / (2.0 * (b - a).length());
        sum += std::pow(d, -4.0);
    }
    return std::pow(sum, -0.25);
}

TEST(CurledHeight, rims_rise_and_middles_stay)
{
    // Two sites, one border at x = 0.5 and nothing else: s is the distance to it.
    const std::vector<Vec2d> two{{0.25, 0.5}, {0.75, 0.5}};
    const CurledHeight height(std::make_shared<WavyHeight>(), VoronoiDiagram(two, kUnit), Vec2d(0.0), 0.08, 0.1);
    const WavyHeight ground;
    const auto rise = [&](double x) { return height.height({x, 0.3}) - ground.height({x, 0.3}); };
    EXPECT_NEAR(rise(0.5), 0.08, 1e-12);
    EXPECT_NEAR(rise(0.45), 0.02, 1e-12) << "(1 - 0.05 / 0.1)^2 of it";
    EXPECT_NEAR(rise(0.575), 0.005, 1e-12) << "(1 - 0.075 / 0.1)^2 of it";
    EXPECT_EQ(rise(0.39), 0.0);
    EXPECT_EQ(rise(0.61), 0.0);
}

TEST(CurledHeight, a_single_plate_has_no_rim)
{
    const CurledHeight height(std::make_shared<WavyHeight>(), VoronoiDiagram(std::vector<Vec2d>{{0.5, 0.5}}, kUnit), Vec2d(0.0), 0.08, 0.1);
    EXPECT_EQ(height.height({0.2, 0.2}), WavyHeight().height({0.2, 0.2}));
    EXPECT_EQ(height.gradient({0.2, 0.2}), WavyHeight().gradient({0.2, 0.2}));
    EXPECT_EQ(height.smooth_distance({0.2, 0.2}), kInfinity);
}

TEST(CurledHeight, the_smooth_distance_is_its_sum_and_at_most_the_nearest)
{
    const CurledHeight height = curled();
    const VoronoiDiagram diagram(sites(60), crack_box(60, kUnit));
    Numbers random(4);
    double most = 0.0;
    for (int k = 0; k < 3000; ++k) {
        const Vec2d p(random(), random());
        const double s = height.smooth_distance(p), least = diagram.border_distance(p);
        EXPECT_LE(s, least);
        EXPECT_NEAR(s, smooth_by_hand(diagram, p), 1e-9 + 1e-6 * s);
        most = std::max(most, s / least);
        const Vec2d q = p + Vec2d(random.between(-0.1, 0.1), random.between(-0.1, 0.1));
        const Vec2d inside(std::clamp(q.x, 0.0, 1.0), std::clamp(q.y, 0.0, 1.0));
        EXPECT_LE(std::abs(height.smooth_distance(inside) - s), (inside - p).length() * (1.0 + 1e-9)) << "1-Lipschitz, across borders too";
    }
    EXPECT_GT(most, 0.99) << "near the middle of an edge it is the distance";
}

TEST(CurledHeight, the_gradient_is_what_differences_say)
{
    const CurledHeight height = curled();
    Numbers random(5);
    int curls = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec2d p(random.between(0.01, 0.99), random.between(0.01, 0.99));
        const double s = height.smooth_distance(p), h = 1e-6;
        if (s < 10.0 * h || std::abs(s - 0.05) < 10.0 * h) continue;  // a border, the end of the curl
        const Vec2d by_differences((height.height(p + Vec2d(h, 0)) - height.height(p - Vec2d(h, 0))) / (2.0 * h),
                                   (height.height(p + Vec2d(0, h)) - height.height(p - Vec2d(0, h))) / (2.0 * h));
        // The third derivative of the curl is of the order of rise / (reach s^2).
        EXPECT_NEAR((height.gradient(p) - by_differences).length(), 0.0, 1e-8 + 200.0 * h * h * 0.08 / (0.05 * s * s)) << p << " s " << s;
        curls += s < 0.05;
    }
    EXPECT_GT(curls, 1000);
}

TEST(CurledHeight, bounds_hold_and_are_not_idle)
{
    for (const double rise : {0.08, -0.05}) {
        const CurledHeight height = curled(rise);
        Numbers random(6);
        double range = 0.0, slope = 0.0, curvature = 0.0;
        for (int k = 0; k < 1500; ++k) {
            const Vec2d low(random.between(0.0, 0.97), random.between(0.0, 0.97));
            const double side = std::pow(10.0, random.between(-3.0, -1.6));
            const Box2d area(low, low + Vec2d(side));
            const Interval heights = height.range(area);
            const double steepest = height.slope_bound(area), bend = height.curvature_bound(area);
            double lowest = kInfinity, highest = -kInfinity;
            for (int n = 0; n < 40; ++n) {
                const Vec2d p = low + Vec2d(random(), random()) * side, q = low + Vec2d(random(), random()) * side;
                const double a = height.height(p), b = height.height(q), apart = (p - q).length();
                ASSERT_TRUE(heights.lo <= a && a <= heights.hi) << area.min << side;
                lowest = std::min(lowest, a), highest = std::max(highest, a);
                if (!(apart > 1e-6 * side)) continue;
                ASSERT_LE(std::abs(a - b), steepest * apart + 1e-14);
                slope = std::max(slope, std::abs(a - b) / (steepest * apart));
                if (!std::isfinite(bend)) continue;
                const double turn = (height.gradient(p) - height.gradient(q)).length();
                ASSERT_LE(turn, bend * apart + 1e-9);
                curvature = std::max(curvature, turn / (bend * apart));
            }
            range = std::max(range, (highest - lowest) / (heights.hi - heights.lo));
        }
        // The ground's own bounds (1.25 and 11.25 everywhere) are part of them, so they are met only in part.
        EXPECT_GT(range, 0.5);
        EXPECT_GT(slope, 0.6);
        EXPECT_GT(curvature, 0.2);
    }
}

}  // namespace
}  // namespace hoodoo
