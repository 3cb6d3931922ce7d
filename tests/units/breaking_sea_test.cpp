// The sea with breaking waves: golden profiles, derivatives by differences, bounds over boxes of space and time with mutants, a life without jumps.
#include "terrain/fields/breaking_sea.h"
#include "terrain/math/hash.h"
#include "tests/counts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using Json = nlohmann::json;

double u(std::uint64_t i, int k)
{
    return static_cast<double>(hash_combine(i, static_cast<std::uint64_t>(k)) >> 11) * 0x1p-53;
}

Breaker hero()
{
    Breaker b;
    b.shape = {6.0, 0.75, 2.0, 0.8};
    return b;
}

std::vector<Swell> three_swells()
{
    return {{0.12, {-0.5, 0.1}, 2.2, 0.3}, {0.05, {-1.1, -0.6}, 3.5, 1.0}, {0.02, {0.4, 2.0}, 4.5, 2.0}};
}

/// Two waves that run apart, one of them askew.
BreakingSea lively()
{
    Breaker a = hero(), b = hero();
    b.centre = {25.0, 10.0};
    b.heading = Vec2d(-0.8, 0.6);
    b.start = 1.5;
    b.intensity = 4.7;
    return {{a, b}, Swells(three_swells(), {60.0, 80.0, {0.0, 0.0}}), 1.25};
}

TEST(BreakingSea, a_wave_of_full_intensity_is_the_golden_profile)
{
    std::ifstream file(HOODOO_SOURCE_DIR "/tests/golden/d_wave.json");
    const Json golden = Json::parse(file);
    int seen = 0;
    for (const Json& f : golden["F"]) {
        const Json& shape = golden["params"][f["p"].get<std::string>()];
        Breaker b;
        b.shape = {shape["R1"], shape["R2"], shape["alpha"], shape["d"]};
        b.heading = {-1.0, 0.0};
        b.speed = 0.0;
        b.intensity = f["T"];
        if (b.intensity == 0.0) continue;
        // Long after the steepening and long before the collapse: the golden T exactly.
        b.steepening = 1.0;
        b.collapse = 1e9;
        const BreakingSea sea({b}, Swells(), -b.shape.depth);
        const Vec3d p(f["x"], 0.0, f["z"]);
        EXPECT_NEAR(sea.value(p, 1.0), f["F"].get<double>(), 1e-9) << f;
        const Vec3d g = sea.gradient(p, 1.0);
        EXPECT_NEAR(g.x, f["grad"][0].get<double>(), 1e-8) << f;
        EXPECT_NEAR(g.z, f["grad"][1].get<double>(), 1e-8) << f;
        ++seen;
    }
    EXPECT_GE(seen, 20);
}

TEST(BreakingSea, derivatives_are_those_of_differences)
{
    const BreakingSea sea = lively();
    int seen = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3d p(-12.0 + 45.0 * u(i, 0), -15.0 + 30.0 * u(i, 1), -2.0 + 6.0 * u(i, 2));
        const double t = 9.0 * u(i, 3), h = 1e-5;
        double by_time = 0.0;
        const Vec3d g = sea.gradient(p, t, &by_time);
        const auto slope = [&](const Vec3d& step, double dt) {
            return (sea.value(p + step * h, t + dt * h) - sea.value(p - step * h, t - dt * h)) / (2.0 * h);
        };
        const auto bend = [&](const Vec3d& step, double dt) {
            return std::abs(sea.value(p + step * h, t + dt * h) + sea.value(p - step * h, t - dt * h) - 2.0 * sea.value(p, t)) / h;
        };
        const Vec3d axes[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
        for (int k = 0; k < 4; ++k) {
            const double dt = k == 3 ? 1.0 : 0.0;
            if (bend(axes[k], dt) > 1e-3) continue;  // a kink: the edge of the union or of the core
            EXPECT_NEAR(slope(axes[k], dt), k < 3 ? g[k] : by_time, 2e-3)
                << "component " << k << " at " << p.x << ", " << p.y << ", " << p.z << ", t = " << t;
            ++seen;
        }
        if (HasFailure()) return;
    }
    EXPECT_GT(seen, 70000);
}

/// Samples in random boxes that lie outside of the bounds, which are scaled by `scale` about their middles.
int violations(double scale, int boxes)
{
    const BreakingSea sea = lively();
    int wrong = 0;
    const auto outside = [&](double x, const Interval& i) {
        const double middle = 0.5 * (i.lo + i.hi), half = 0.5 * (i.hi - i.lo) * scale;
        return x < middle - half - 1e-9 || x > middle + half + 1e-9;
    };
    for (int n = 0; n < boxes; ++n) {
        const auto id = static_cast<std::uint64_t>(n);
        const double size = std::pow(10.0, -2.5 + 2.5 * u(id, 0)), t0 = 10.0 * u(id, 1);
        const Interval times{t0, u(id, 2) < 0.6 ? t0 : t0 + 0.2 * u(id, 3)};
        const Vec3d lo(-14.0 + 50.0 * u(id, 4), -18.0 + 36.0 * u(id, 5), -2.0 + 6.0 * u(id, 6));
        const Box3d box(lo, lo + Vec3d(size, size * (0.2 + u(id, 7)), size * (0.2 + u(id, 8))));
        const LocalField known = sea.local(box, times);
        Vec3d last(0.0), last_p(0.0);
        double last_t = -1.0;
        for (int k = 0; k < 20; ++k) {
            const auto at = [&](int axis) {
                return k < 8 ? ((k >> axis) & 1 ? box.max[axis] : box.min[axis]) : box.min[axis] + box.size()[axis] * u(id * 32 + k, 20 + axis);
            };
            const Vec3d p(at(0), at(1), at(2));
            const double t = k % 3 ? times.lo : times.lo + (times.hi - times.lo) * u(id * 32 + k, 30);
            wrong += outside(sea.value(p, t), known.value);
            const Vec3d g = sea.gradient(p, t);
            for (int c = 0; c < 3; ++c) wrong += outside(g[c], known.gradient[static_cast<std::size_t>(c)]);
            if (std::isfinite(known.curvature) && t == last_t) wrong += (g - last).length() > known.curvature * scale * (p - last_p).length() + 1e-9;
            last = g, last_p = p, last_t = t;
        }
    }
    return wrong;
}

TEST(BreakingSea, bounds_hold_over_boxes_of_space_and_time)
{
    EXPECT_EQ(violations(1.0, testing::count(20000, 500000)), 0);
}

TEST(BreakingSea, bounds_that_are_too_small_are_seen)
{
    EXPECT_GT(violations(0.9, 20000), 100);
}

TEST(BreakingSea, its_life_has_no_jumps)
{
    // A jump stays as high however short the step; what is continuous shrinks with it.
    const BreakingSea sea = lively();
    const auto largest = [&](double step) {
        double most = 0.0;
        for (std::uint64_t i = 0; i < 400000; ++i) {
            const Vec3d p(-12.0 + 30.0 * u(i, 0), -8.0 + 16.0 * u(i, 1), 4.0 * u(i, 2));
            const double t = 15.0 * u(i, 3);
            most = std::max(most, std::abs(sea.value(p, t + step) - sea.value(p, t)));
        }
        return most;
    };
    const double coarse = largest(1e-2), fine = largest(1e-4);
    EXPECT_GT(coarse, 0.1);
    EXPECT_LT(fine, 0.02 * coarse);
}

TEST(BreakingSea, far_from_its_waves_it_is_the_swell_and_then_flat)
{
    const BreakingSea sea = lively();
    EXPECT_NE(sea.value({0.0, -40.0, 1.25}, 3.0), 0.0);
    EXPECT_EQ(sea.value({0.0, -85.0, 1.25}, 3.0), 0.0);
    EXPECT_EQ(sea.value({95.0, 0.0, 1.5}, 3.0), 0.25);
}

}  // namespace
}  // namespace hoodoo
