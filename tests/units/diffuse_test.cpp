// The matte models against quadrature: energy, reciprocity, and the closed form of what a tilted lobe gives back.
#include "renderer/shading/bsdf.h"
#include "tests/counts.h"

#include <gtest/gtest.h>

#include <random>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

Vec3d spherical(double cosine, double azimuth)
{
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
}

/// Integral over the hemisphere around z, midpoints.
template <class F>
double over_hemisphere(F&& f, int n = 400)
{
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += f(spherical((i + 0.5) / n, 2.0 * kPi * (j + 0.5) / n));
    return sum * 2.0 * kPi / n / n;
}

TEST(Diffuse, lambert_is_albedo_over_pi_times_cosine)
{
    const Bsdf bsdf = make_diffuse(Vec3d(0, 0, 1), Vec3d(0, 0, 1), Vec3f(0.2f, 0.5f, 0.9f), 0.0f);
    const BsdfValue f = evaluate(bsdf, spherical(0.3, 1.0), spherical(0.6, 2.0));
    EXPECT_NEAR(f.value.x, 0.2 * 0.6 / kPi, 1e-7);
    EXPECT_NEAR(f.value.z, 0.9 * 0.6 / kPi, 1e-7);
    EXPECT_NEAR(f.pdf, 0.6 / kPi, 1e-12);
    EXPECT_EQ(evaluate(bsdf, spherical(0.3, 1.0), spherical(-0.6, 2.0)).value, Vec3f(0.0f));
}

TEST(Diffuse, the_rough_model_loses_nothing_at_albedo_one)
{
    for (const float roughness : {0.2f, 0.6f, 1.0f}) {
        const Bsdf bsdf = make_diffuse(Vec3d(0, 0, 1), Vec3d(0, 0, 1), Vec3f(1.0f), roughness);
        for (const double mu : {0.05, 0.3, 0.7, 1.0}) {
            const Vec3d wo = spherical(mu, 0.4);
            EXPECT_NEAR(over_hemisphere([&](const Vec3d& wi) { return evaluate(bsdf, wo, wi).value.y; }), 1.0, 2e-3)
                << "roughness " << roughness << ", cosine " << mu;
        }
    }
}

TEST(Diffuse, the_rough_model_never_gains)
{
    for (const float albedo : {0.1f, 0.5f, 0.9f}) {
        const Bsdf bsdf = make_diffuse(Vec3d(0, 0, 1), Vec3d(0, 0, 1), Vec3f(albedo), 0.8f);
        const Vec3d wo = spherical(0.4, 0.4);
        const double energy = over_hemisphere([&](const Vec3d& wi) { return evaluate(bsdf, wo, wi).value.y; });
        EXPECT_LT(energy, 1.0);
        EXPECT_GT(energy, 0.6 * albedo);
    }
}

TEST(Diffuse, models_are_reciprocal_where_the_normals_agree)
{
    std::mt19937_64 random(1);
    const auto u = [&] { return std::uniform_real_distribution<double>()(random); };
    const Vec3d n = spherical(0.2, 2.0);
    Vec3d t, b;
    orthonormal_frame(n, t, b);
    const auto direction = [&] {
        const Vec3d w = spherical(0.001 + 0.999 * u(), 2.0 * kPi * u());
        return t * w.x + b * w.y + n * w.z;
    };
    for (int i = 0; i < testing::count(10000, 1000000); ++i) {
        const Bsdf bsdf = make_diffuse(n, n, Vec3f(0.3f, 0.6f, 1.0f), static_cast<float>(u()));
        const Vec3d wo = direction(), wi = direction();
        const Vec3f f = evaluate(bsdf, wo, wi).value / static_cast<float>(wi.dot(n)),
                    g = evaluate(bsdf, wi, wo).value / static_cast<float>(wo.dot(n));
        ASSERT_NEAR(f.x, g.x, 1e-5 * g.x + 1e-7);
        ASSERT_NEAR(f.z, g.z, 1e-5 * g.z + 1e-7);
    }
}

TEST(Diffuse, a_tilted_lobe_has_mass_one_above_the_geometry_and_none_below)
{
    for (const double tilt : {0.0, 0.1, 0.5, 1.0, 1.5}) {
        const CosineLobe lobe(Vec3d(std::sin(tilt), 0.0, std::cos(tilt)), Vec3d(0, 0, 1));
        EXPECT_NEAR(over_hemisphere([&](const Vec3d& w) { return lobe.density(w); }), 1.0, 1e-4) << "tilt " << tilt;
        EXPECT_EQ(lobe.density(spherical(-0.01, 0.0)), 0.0);
        // Continuous at the horizon of the geometry, on the side to which the normal leans.
        EXPECT_LT(lobe.density(spherical(1e-6, 0.0)), 1e-5);
    }
}

TEST(Diffuse, a_sample_weighs_what_value_over_density_says)
{
    std::mt19937_64 random(2);
    const auto u = [&] { return std::uniform_real_distribution<double>()(random); };
    for (int i = 0; i < 10000; ++i) {
        const Bsdf bsdf = make_diffuse(spherical(0.7, 3.0), Vec3d(0, 0, 1), Vec3f(0.3f, 0.6f, 1.0f), static_cast<float>(i % 2) * 0.6f);
        const Vec3d wo = spherical(0.5, 1.0);
        const BsdfSample s = sample(bsdf, wo, {u(), u(), u()});
        ASSERT_GT(s.direction.z, 0.0);
        ASSERT_NEAR(s.direction.length(), 1.0, 1e-12);
        const BsdfValue f = evaluate(bsdf, wo, s.direction);
        ASSERT_EQ(f.pdf, s.pdf);
        ASSERT_NEAR(f.value.y, s.weight.y * s.pdf, 1e-5 * f.value.y);
    }
}

}  // namespace
}  // namespace hoodoo
