// Noise against golden values, its derivatives against differences, its bounds against samples.
#include "terrain/math/noise.h"

#include "terrain/math/noise_hessian.h"
#include "tests/counts.h"
#include "terrain/math/hash.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

nlohmann::json golden()
{
    return nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/d_canyon.json"));
}

double random(std::uint64_t i, double scale)
{
    return (unit_real(mix64(i)) - 0.5) * scale;
}

TEST(Noise, lattice_hash_equals_the_golden_values)
{
    nlohmann::json values = golden();  // kept: the loop refers into it
    ASSERT_FALSE(values["hash"].empty());
    for (const auto& row : values["hash"]) {
        EXPECT_EQ(lattice_hash(static_cast<std::uint32_t>(row["ix"].get<int>()), static_cast<std::uint32_t>(row["iy"].get<int>()),
                               row["seed"].get<std::uint32_t>()),
                  row["h"].get<std::uint32_t>());
    }
}

TEST(Noise, value_and_gradient_equal_the_golden_values)
{
    nlohmann::json values = golden();  // kept: the loop refers into it
    ASSERT_FALSE(values["noise"].empty());
    for (const auto& row : values["noise"]) {
        const Noise2 n = gradient_noise(Vec2d(row["p"][0].get<double>(), row["p"][1].get<double>()), 7);
        EXPECT_NEAR(n.value, row["n"].get<double>(), 1e-14);
        EXPECT_NEAR(n.gradient.x, row["grad"][0].get<double>(), 1e-13);
        EXPECT_NEAR(n.gradient.y, row["grad"][1].get<double>(), 1e-13);
    }
}

template <class Point, class F>
void expect_derivative(F&& f, const Point& p)
{
    const double h = 1e-5;
    for (unsigned axis = 0; axis < Point::dimensions(); ++axis) {
        Point step(0.0);
        step[static_cast<int>(axis)] = h;
        // Central differences: h^2 |f'''|/6, and at 4 octaves |f'''| is below 1e4 here.
        EXPECT_NEAR(f(p).gradient[static_cast<int>(axis)], (f(p + step).value - f(p - step).value) / (2 * h), 2e-6);
    }
}

TEST(Noise, gradients_of_the_sums_are_their_derivatives)
{
    const Fractal fractal{3.5, 2.1, 0.45};
    for (std::uint64_t i = 0; i < 50; ++i) {
        const Vec2d p(random(4 * i, 20), random(4 * i + 1, 20));
        const Vec3d q(p.x, p.y, random(4 * i + 2, 20));
        expect_derivative([&](const Vec2d& x) { return fbm(x, 5, fractal); }, p);
        expect_derivative([&](const Vec3d& x) { return fbm(x, 5, fractal); }, q);
        const double h = 1e-5;
        EXPECT_NEAR(gradient_noise(p.x, 3).slope, (gradient_noise(p.x + h, 3).value - gradient_noise(p.x - h, 3).value) / (2 * h), 1e-7);
    }
    // Away from the crests, where |n| has its kink.
    expect_derivative([&](const Vec2d& x) { return ridged(x, 5, {1.0}); }, Vec2d(0.31, 0.72));
    expect_derivative([&](const Vec3d& x) { return ridged(x, 5, {1.0}); }, Vec3d(0.31, 0.72, 0.2));
}

/// Largest value and slope over samples, as shares of the bound.
template <class F>
NoiseBound seen(F&& f, const NoiseBound& bound)
{
    NoiseBound most{0, 0};
    for (int i = 0; i < testing::count(200000, 5000000); ++i) {
        const auto n = f(Vec3d(random(3u * i, 1e4), random(3u * i + 1u, 1e4), random(3u * i + 2u, 1e4)));
        most.value = std::max(most.value, std::abs(n.value) / bound.value);
        most.slope = std::max(most.slope, n.gradient.length() / bound.slope);
    }
    return most;
}

TEST(Noise, no_sample_passes_the_bounds_and_the_bounds_are_not_idle)
{
    const auto planar = [](const Vec3d& p) { return gradient_noise(Vec2d(p.x, p.y), 11); };
    const auto solid = [](const Vec3d& p) { return gradient_noise(p, 11); };
    for (const NoiseBound& share : {seen(planar, kNoise2Bound), seen(solid, kNoise3Bound)}) {
        EXPECT_LE(share.value, 1.0);
        EXPECT_LE(share.slope, 1.0);
        EXPECT_GT(share.value, 0.7);
        EXPECT_GT(share.slope, 0.6);
    }
    const Fractal fractal{4.0, 2.0, 0.5};
    const NoiseBound bound = ridged_bound(kNoise2Bound, fractal);
    const NoiseBound ridge = seen([&](const Vec3d& p) { return ridged(Vec2d(p.x, p.y), 3, fractal); }, bound);
    EXPECT_LE(ridge.value, 1.0);
    EXPECT_LE(ridge.slope, 1.0);
}

TEST(Noise, is_zero_on_the_lattice_and_where_there_is_no_number)
{
    EXPECT_EQ(gradient_noise(Vec3d(3, -4, 5), 1).value, 0.0);
    EXPECT_EQ(gradient_noise(Vec2d(1e300, -1e18), 1).value, 0.0);
    EXPECT_EQ(gradient_noise(std::numeric_limits<double>::quiet_NaN(), 1).value, 0.0);
}

TEST(Noise, a_fraction_of_an_octave_joins_its_neighbours_without_a_jump)
{
    const Vec3d p(0.3, 1.7, -2.2);
    EXPECT_DOUBLE_EQ(fbm(p, 2, {3.0 + 1e-15}).value, fbm(p, 2, {3.0}).value);
    const double mean = 0.5 * (fbm(p, 2, {3.0}).value + fbm(p, 2, {4.0}).value);
    EXPECT_NEAR(fbm(p, 2, {3.5}).value, mean, 1e-15);
}

/// Whether the bounds over random boxes, times `factor`, hold of the noise's derivatives at points of them; third ones as differences of second ones.
bool box_bounds_hold(double factor, int boxes)
{
    std::uint64_t n = 0;
    const auto next = [&] { return unit_real(mix64(++n)); };
    for (int i = 0; i < boxes; ++i) {
        const Vec2d corner(next() * 8.0 - 4.0, next() * 8.0 - 4.0);
        const double size = std::pow(10.0, -3.0 * next());
        const Imath::Box2d box(corner, corner + Vec2d(next(), next()) * size);
        const NoiseDerivativeBound bound = noise_bound(box, 7);
        for (int k = 0; k < 8; ++k) {
            const Vec2d p(box.min + (box.max - box.min) * Vec2d(next(), next())), q(box.min + (box.max - box.min) * Vec2d(next(), next()));
            const NoiseJet2 a = noise_jet(p, 7), b = noise_jet(q, 7);
            if (a.gradient.length() > factor * bound.slope + 1e-12) return false;
            if (0.5 * std::abs(a.xx + a.yy) + std::hypot(0.5 * (a.xx - a.yy), a.xy) > factor * bound.hessian + 1e-12) return false;
            const double x = b.xx - a.xx, y = b.xy - a.xy, z = b.yy - a.yy;
            if (0.5 * std::abs(x + z) + std::hypot(0.5 * (x - z), y) > factor * bound.third * (q - p).length() + 1e-10) return false;
        }
    }
    return true;
}

TEST(Noise, bounds_over_boxes_hold_and_nine_tenths_of_them_do_not)
{
    EXPECT_TRUE(box_bounds_hold(1.0, testing::count(20000, 1000000)));
    EXPECT_FALSE(box_bounds_hold(0.9, 20000));
}

TEST(Noise, bounds_over_small_boxes_are_near_the_derivatives_there)
{
    // A box a thousandth of a cell wide: what derivatives change by in it is 97 / 1000 of a second, about 1 of a third (the fourth is below 1e3).
    for (std::uint64_t i = 0; i < 200; ++i) {
        const Vec2d p(random(2 * i + 1, 8.0), random(2 * i + 2, 8.0));
        if (std::abs(p.x - std::round(p.x)) < 1e-3 || std::abs(p.y - std::round(p.y)) < 1e-3) continue;
        const NoiseDerivativeBound bound = noise_bound(Imath::Box2d(p, p + Vec2d(1e-3)), 7);
        const NoiseJet2 n = noise_jet(p, 7);
        EXPECT_NEAR(bound.hessian, 0.5 * std::abs(n.xx + n.yy) + std::hypot(0.5 * (n.xx - n.yy), n.xy), 0.2);
    }
}

bool span_bounds_hold(double factor, int spans)
{
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(spans); ++i) {
        const double lo = random(3 * i + 1, 40.0), hi = lo + std::pow(10.0, -3.0 * unit_real(mix64(3 * i + 2)));
        const double bound = noise_curve_bound(lo, hi, 5);
        for (int k = 0; k < 8; ++k) {
            const double a = lo + (hi - lo) * k / 8.0, b = lo + (hi - lo) * (k + 1) / 8.0;
            if (std::abs(gradient_noise(b, 5).slope - gradient_noise(a, 5).slope) > factor * bound * (b - a) + 1e-12) return false;
        }
    }
    return true;
}

TEST(Noise, curvature_bounds_over_spans_hold_and_nine_tenths_of_them_do_not)
{
    EXPECT_TRUE(span_bounds_hold(1.0, testing::count(20000, 1000000)));
    EXPECT_FALSE(span_bounds_hold(0.9, 20000));
}

}  // namespace
}  // namespace hoodoo
