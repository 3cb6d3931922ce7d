// Every sampler of light and scattering follows its own density; a density that is one percent off somewhere fails.
#include "renderer/light/light.h"
#include "renderer/media/phase.h"
#include "renderer/shading/bsdf.h"
#include "tests/counts.h"
#include "tests/support/chi_square.h"

#include <gtest/gtest.h>

#include <functional>

namespace hoodoo
{
namespace
{

using testing::Chart;
using testing::SphereChart;
using testing::uniform;

using Sample = std::function<Vec3d(std::mt19937_64&)>;
using Density = std::function<double(const Vec3d&)>;

/// The upper half of a sky table in the table's own coordinates, so that cells of the test are made of whole cells of the table.
class SkyChart final : public Chart
{
public:
    explicit SkyChart(const Vec3d& sun) : north_(Vec3d(sun.x, sun.y, 0.0).normalized()), east_(north_.y, -north_.x, 0.0) {}
    Vec3d direction(double a, double b) const override
    {
        const double e = 0.5 * pi * a * a, azimuth = pi * (2.0 * b - 1.0);
        return north_ * (std::cos(e) * std::cos(azimuth)) + east_ * (std::cos(e) * std::sin(azimuth)) + Vec3d(0, 0, std::sin(e));
    }
    Vec2d place(const Vec3d& w) const override
    {
        return Vec2d(std::sqrt(std::asin(std::clamp(w.z, 0.0, 1.0)) * 2.0 / pi), 0.5 + std::atan2(w.dot(east_), w.dot(north_)) / (2.0 * pi));
    }
    double solid_angle(double a, double) const override { return std::cos(0.5 * pi * a * a) * pi * a * 2.0 * pi; }

private:
    static constexpr double pi = 3.14159265358979323846;
    Vec3d north_, east_;
};

/// The law, and its mutant: the same density with a ripple of one percent, which the test must see.
void expect_law_and_mutant(const Chart& chart, const Sample& sample, const Density& density, int rows, int columns, int fine,
                           int samples = testing::count(5000000, 20000000))
{
    const testing::DirectionCounts counts(chart, sample, rows, columns, samples, 1);
    const auto good = counts.against(density, fine);
    EXPECT_TRUE(good.holds()) << "p " << good.p_value << ", integral " << good.integral << ", outside " << good.outside;

    // 200 cells, n samples, amplitude 1%: the statistic grows by n 0.01^2 / 2 = 250 against a deviation of 20.
    const Density rippled = [&](const Vec3d& w) {
        const Vec2d at = chart.place(w);
        return density(w) * (1.0 + 0.01 * std::cos(2.0 * 3.14159265358979323846 * (2.0 * at.y + at.x)));
    };
    EXPECT_LT(counts.against(rippled, fine).p_value, 1e-8) << "the mutant passed";
}

Vec3d tilted(double angle, double azimuth)
{
    return Vec3d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle));
}

void expect_bsdf(const Vec3d& shading, const Vec3d& geometric, const Vec3d& wo, float roughness)
{
    const Bsdf bsdf = make_diffuse(shading, geometric, Vec3f(0.8f), roughness);
    expect_law_and_mutant(
        SphereChart(geometric),
        [&](std::mt19937_64& r) {
            return sample(bsdf, wo, {uniform(r), uniform(r), uniform(r)}).direction;
        },
        [&](const Vec3d& w) { return evaluate(bsdf, wo, w).pdf; }, 12, 12, 40);
}

TEST(Sampling, lambert_follows_its_density)
{
    expect_bsdf(Vec3d(0, 0, 1), Vec3d(0, 0, 1), tilted(0.7, 1.0), 0.0f);
}
TEST(Sampling, rough_diffuse_follows_its_density)
{
    expect_bsdf(tilted(1.1, 2.0), tilted(1.1, 2.0), tilted(0.9, 2.5), 0.7f);
}
TEST(Sampling, a_slightly_tilted_lobe_follows_its_density)
{
    expect_bsdf(tilted(0.2, 0.3), Vec3d(0, 0, 1), tilted(0.7, 1.0), 0.0f);
}
TEST(Sampling, a_strongly_tilted_lobe_follows_its_density)
{
    expect_bsdf(tilted(1.2, 0.3), Vec3d(0, 0, 1), tilted(0.7, 1.0), 0.3f);
}

TEST(Sampling, the_phase_function_follows_its_density)
{
    const Vec3d wo = tilted(0.9, 2.0);
    for (const double g : {0.85, 0.3, 5e-5, -0.4}) {
        const HenyeyGreenstein phase(g);
        expect_law_and_mutant(
            SphereChart(wo), [&](std::mt19937_64& r) { return phase.sample(wo, Vec2d(uniform(r), uniform(r))); },
            [&](const Vec3d& w) { return phase.value(wo, w); }, 12, 12, 240);
    }
}

TEST(Sampling, the_phase_functions_mean_cosine_is_its_asymmetry)
{
    // The mean of n cosines has a standard error of at most 1 / sqrt(n).
    std::mt19937_64 random(8);
    const Vec3d wo(0, 0, -1);
    for (const double g : {0.85, 0.3, 0.0, -0.4}) {
        const HenyeyGreenstein phase(g);
        double sum = 0.0;
        const int n = 1000000;
        for (int k = 0; k < n; ++k) sum += phase.sample(wo, Vec2d(uniform(random), uniform(random))).z;
        EXPECT_NEAR(sum / n, g, 5e-3);
    }
}

/// Samples that took one facet; the share of the others is counted apart and must be what the density leaves. More samples see how finely the density
/// was integrated: at 60 midpoints a cell the edge of its support shows with 2e7 of them, at 240 no longer.
void expect_facets(double eta, double roughness, double angle, int samples = testing::count(5000000, 20000000))
{
    const Vec3d n(0, 0, 1), wo = tilted(angle, 1.0);
    const Dielectric boundary(n, n, eta, roughness);
    const auto draw = [&](std::mt19937_64& r) { return boundary.sample(wo, {uniform(r), uniform(r), uniform(r)}); };
    std::mt19937_64 random(2);
    const int n_counted = 4000000;
    int kept = 0;
    for (int k = 0; k < n_counted; ++k) kept += !draw(random).stray;
    const double share = static_cast<double>(kept) / n_counted;
    ASSERT_GT(share, 0.3);
    expect_law_and_mutant(
        SphereChart(n),
        [&](std::mt19937_64& r) {
            BsdfSample one = draw(r);
            while (one.stray) one = draw(r);
            return one.direction;
        },
        [&](const Vec3d& w) { return boundary.evaluate(wo, w).pdf / share; }, 16, 10, testing::count(60, 240), samples);
}

TEST(Sampling, facets_follow_their_density)
{
    expect_facets(1.333, 0.5, 0.6);
}
TEST(Sampling, facets_at_a_grazing_angle_follow_their_density)
{
    // More samples than elsewhere: they crowd in few cells, where the ripple of the mutant partly cancels.
    expect_facets(1.333, 0.3, 1.35, testing::count(10000000, 20000000));
}
TEST(Sampling, facets_from_within_follow_their_density)
{
    expect_facets(1.0 / 1.333, 0.4, 0.7);
}

TEST(Sampling, the_sun_disc_follows_its_density)
{
    // The chart is exactly the disc: 1 - cos(half) in the form that keeps its digits.
    const Vec3d direction = compass_direction(0.5, 2.0);
    const double diameter = 0.00925, quarter = std::sin(0.25 * diameter);
    const DiscSun sun(direction, Vec3f(1.0f), diameter);
    // Rounding of directions near the rim is 1e-16 against a radius of 5e-3, so a sample may fall outside by less than one in 10^13.
    expect_law_and_mutant(
        SphereChart(direction, 2.0 * quarter * quarter * (1.0 + 1e-12)),
        [&](std::mt19937_64& r) { return sun.sample(Vec2d(uniform(r), uniform(r))).direction; }, [&](const Vec3d& w) { return sun.pdf(w); }, 10, 20,
        4);
}

TEST(Sampling, the_clear_sky_follows_its_density)
{
    const Vec3d direction = compass_direction(0.35, 2.0);
    const SkyTable table(AtmosphereParameters{}, direction, [](const Vec3d& c) { return Vec3f(c); });
    expect_law_and_mutant(
        SkyChart(direction), [&](std::mt19937_64& r) { return table.sample(Vec2d(uniform(r), uniform(r))); },
        [&](const Vec3d& w) { return table.pdf(w); }, 16, 16, 16);
}

TEST(Sampling, a_light_sample_says_what_radiance_and_density_say)
{
    const Vec3d direction = compass_direction(0.35, 2.0);
    const ClearSky sky(std::make_shared<const SkyTable>(AtmosphereParameters{}, direction, [](const Vec3d& c) { return Vec3f(c); }));
    const DiscSun sun(direction, Vec3f(3.0f), 0.00925);
    std::mt19937_64 random(5);
    for (int i = 0; i < 1000; ++i) {
        const Vec2d u(uniform(random), uniform(random));
        const LightSample from_sky = sky.sample(u), from_sun = sun.sample(u);
        EXPECT_EQ(from_sky.value, sky.radiance(from_sky.direction));
        EXPECT_EQ(from_sky.pdf, sky.pdf(from_sky.direction));
        EXPECT_EQ(from_sun.value, sun.radiance(from_sun.direction));
        EXPECT_EQ(from_sun.pdf, sun.pdf(from_sun.direction));
        EXPECT_NEAR(from_sky.direction.length(), 1.0, 1e-12);
    }
}

}  // namespace
}  // namespace hoodoo
