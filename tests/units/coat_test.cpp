// The film of water: Fresnel against the textbook, and the energy of mirror and base together.
#include "renderer/shading/bsdf.h"

#include "renderer/shading/look.h"
#include "renderer/shading/procedural.h"
#include "terrain/math/hash.h"
#include "tests/counts.h"
#include "tests/support/lit_scenes.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::Cave;
using testing::lit_parts;
using testing::shoot;
using testing::Shot;

TEST(Fresnel, is_what_the_textbook_says)
{
    EXPECT_NEAR(fresnel_dielectric(1.0, 1.333), std::pow(0.333 / 2.333, 2), 1e-12);  // ((n - 1) / (n + 1))^2
    EXPECT_NEAR(fresnel_dielectric(0.0, 1.333), 1.0, 1e-12);
    // Snell's law spelled out at 60 degrees: sin t = sin 60 / n, rs = sin(i - t) / sin(i + t), rp = tan(i - t) / tan(i + t).
    const double i = M_PI / 3, t = std::asin(std::sin(i) / 1.333);
    EXPECT_NEAR(fresnel_dielectric(std::cos(i), 1.333),
                0.5 * (std::pow(std::sin(i - t) / std::sin(i + t), 2) + std::pow(std::tan(i - t) / std::tan(i + t), 2)), 1e-12);
    // Brewster's angle: all that is reflected is polarised across, so half of rs^2.
    const double b = std::atan(1.333), c = M_PI / 2 - b;
    EXPECT_NEAR(fresnel_dielectric(std::cos(b), 1.333), 0.5 * std::pow(std::sin(b - c) / std::sin(b + c), 2), 1e-12);
}

Vec3d direction(double elevation, double azimuth)
{
    return Vec3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
}

TEST(Coat, mirror_and_base_share_the_light_and_lose_none)
{
    const Vec3d g(0, 0, 1);
    for (const double tilt : {0.0, 0.05, 0.4}) {
        for (const double elevation : {0.02, 0.3, 1.2}) {
            for (const float coat : {1.0f, 0.4f}) {
                const Bsdf bsdf = make_diffuse(direction(M_PI / 2 - tilt, 2.0), g, Vec3f(0.6f), 0.5f, coat);
                const Vec3d wo = direction(elevation, 0.3);
                const double mirror = coat * fresnel_dielectric(wo.dot(direction(M_PI / 2 - tilt, 2.0)), kWaterIndex);
                double mirrored = 0.0, matte = 0.0;
                const int n = 20000;
                for (int k = 0; k < n; ++k) {
                    const auto u = [&](int d) { return unit_real(hash_cell(1, k, d)); };
                    const BsdfSample s = sample(bsdf, wo, {u(0), u(1), (k + 0.5) / n});
                    ASSERT_GE(s.direction.dot(g), 0.0);
                    ASSERT_NEAR(s.direction.length(), 1.0, 1e-9);
                    (std::isinf(s.pdf) ? mirrored : matte) += s.weight.x / n;
                    if (std::isinf(s.pdf)) continue;
                    const BsdfValue v = evaluate(bsdf, wo, s.direction);
                    ASSERT_NEAR(v.pdf, s.pdf, 1e-9 * s.pdf);
                    ASSERT_NEAR(v.value.x, s.weight.x * s.pdf, 1e-5 * v.value.x);
                }
                EXPECT_NEAR(mirrored, mirror, 1e-4);
                EXPECT_NEAR(matte, (1.0 - mirror) * 0.6, 1e-4);
            }
        }
    }
}

TEST(Coat, mirrors_about_the_shading_normal_and_never_into_the_ground)
{
    const Vec3d wo = direction(0.5, 0.0);
    const Coated flat(CosineLobe(Vec3d(0, 0, 1), Vec3d(0, 0, 1)), Vec3f(0.1f), 1.0f);
    EXPECT_LT((flat.sample(wo, {0.3, 0.3, 0.0}).direction - Vec3d(-wo.x, 0.0, wo.z)).length(), 1e-12);
    // A wave that leans away from a flat view: its mirror image would lie at -0.1 rad, under the water.
    const Vec3d low = direction(0.1, 0.0);
    const Coated wave(CosineLobe(direction(M_PI / 2 - 0.1, M_PI), Vec3d(0, 0, 1)), Vec3f(0.1f), 1.0f);
    const Vec3d out = wave.sample(low, {0.3, 0.3, 0.0}).direction;
    EXPECT_NEAR(out.z, std::sin(0.1), 1e-9);
    EXPECT_LT(out.x, 0.0);
}

class CoatedLook final : public Look
{
public:
    CoatedLook(float albedo, float coat) : albedo_(albedo), coat_(coat) {}
    Appearance appearance(const Interaction& at, double) const override { return {Vec3f(albedo_), 0.3f, at.shading_normal, coat_}; }

private:
    float albedo_, coat_;
};

double wet_cave(float albedo, float coat)
{
    const Camera camera(Vec3d(0.0), Vec3d(0, 0, -1), Vec3d(0, 1, 0), 1.0, true);
    const Scene scene(lit_parts(camera, std::make_unique<Cave>(0.8), {ConstantSky(Vec3f(1.0f))}, std::make_unique<CoatedLook>(albedo, coat)), {});
    Shot shot;
    shot.path.max_depth = 0;
    return testing::mean(shoot(scene, shot), "R");
}

TEST(Coat, a_wet_white_cave_is_as_bright_as_its_sky)
{
    EXPECT_NEAR(wet_cave(1.0f, 1.0f), 1.0, 1e-3);
    EXPECT_NEAR(wet_cave(1.0f, 0.5f), 1.0, 1e-3);
    EXPECT_LT(wet_cave(0.99f, 1.0f), 0.99);  // the mutant: one percent of absorption
}

/// Flat ground of albedo 0 under a film, seen under 60 degrees: the sky times Fresnel, in every pixel of an orthographic camera.
TEST(Coat, a_black_mirror_shows_the_sky_times_fresnel)
{
    const Vec3d eye(10 * std::sin(M_PI / 3), 0, 10 * std::cos(M_PI / 3));
    const Camera camera(eye, Vec3d(0.0), Vec3d(0, 0, 1), 1e-4, true);
    const Scene scene(lit_parts(camera, testing::ground(), {ConstantSky(Vec3f(2.0f))}, std::make_unique<CoatedLook>(0.0f, 1.0f)), {});
    Shot shot;
    shot.samples = testing::count(1024, 8192);
    // A sample is 2 with the probability F = 0.06: the standard error over 16 x 16 pixels is under 0.5 / sqrt(262144) = 1e-3.
    EXPECT_NEAR(testing::mean(shoot(scene, shot), "G"), 2.0 * fresnel_dielectric(0.5, kWaterIndex), 3e-3);
}

TEST(Coat, belongs_to_water_by_name_and_to_others_by_word)
{
    const auto look = [](const char* name) { return default_look(name, [](const ColorValue& c) { return Vec3f(c.rgb); }); };
    Interaction at;
    at.texture_point = Vec3d(3.1, 2.7, 9.0);
    EXPECT_EQ(look("water")->appearance(at, 0.01).coat, 1.0f);
    EXPECT_EQ(look("sand")->appearance(at, 0.01).coat, 0.0f);
    EXPECT_NE(look("water")->appearance(at, 0.01).normal, at.geometric_normal);   // waves
    EXPECT_EQ(look("water")->appearance(at, 100.0).normal, at.geometric_normal);  // too far away to be seen
    EXPECT_LT(look("water")->appearance(at, 0.01).normal.dot(Vec3d(0, 0, 1)), 1.0);
    EXPECT_GT(look("water")->appearance(at, 0.01).normal.dot(Vec3d(0, 0, 1)), 0.98);
}

}  // namespace
}  // namespace hoodoo
