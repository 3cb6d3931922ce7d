// What the tables of a scene file mean: where the sun stands, what a disc is worth, what a sky brings with it.
#include "renderer/light/light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

Node number(double x)
{
    return Node{x, {}, {}};
}
Node text(const std::string& s)
{
    return Node{s, {}, {}};
}
Node grey(double x)
{
    return Node{Node::Table{{"grey", number(x)}}, {}, {}};
}

/// The lights of a table of kind `type`.
std::vector<Light> lights(const std::string& type, Node::Table table)
{
    const auto schemas = light_schemas();
    const auto schema = std::find_if(schemas.begin(), schemas.end(), [&](const Schema& s) { return s.name == type; });
    std::vector<Problem> problems;
    const Values values = check(*schema, Node{std::move(table), {}, {}}, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    return make_lights(type, values, {});
}

TEST(Light, azimuths_run_from_north_over_east)
{
    EXPECT_NEAR((compass_direction(0.0, 0.0) - Vec3d(0, 1, 0)).length(), 0.0, 1e-15);
    EXPECT_NEAR((compass_direction(0.0, kPi / 2) - Vec3d(1, 0, 0)).length(), 0.0, 1e-15);
    EXPECT_NEAR((compass_direction(kPi / 2, 1.0) - Vec3d(0, 0, 1)).length(), 0.0, 1e-15);
}

TEST(Light, a_disc_is_worth_its_irradiance)
{
    // Radiance times the projected solid angle pi sin^2(a); the density is one over the solid angle 2 pi (1 - cos a).
    const double a = 0.1;
    const Vec3d axis = compass_direction(0.5, 1.0);
    const DiscSun sun(axis, Vec3f(7.0f), 2.0 * a);
    EXPECT_NEAR(sun.radiance(axis).x * kPi * std::sin(a) * std::sin(a), 7.0, 1e-5);
    EXPECT_NEAR(sun.pdf(axis) * 2.0 * kPi * (1.0 - std::cos(a)), 1.0, 1e-12);
    EXPECT_EQ(sun.radiance(compass_direction(0.5 + 1.01 * a, 1.0)), Vec3f(0.0f));
    EXPECT_GT(sun.radiance(compass_direction(0.5 + 0.99 * a, 1.0)).x, 0.0f);
}

TEST(Light, tables_become_lights)
{
    const auto constant = lights("constant", {{"radiance", grey(0.25)}});
    ASSERT_EQ(constant.size(), 1u);
    EXPECT_EQ(std::get<ConstantSky>(constant[0]).radiance(Vec3d(0, 0, -1)), Vec3f(0.25f));

    const auto delta =
        lights("sun", {{"elevation_deg", number(30)}, {"azimuth_deg", number(90)}, {"irradiance", grey(3.0)}, {"shape", text("delta")}});
    ASSERT_EQ(delta.size(), 1u);
    const LightSample sample = std::get<DeltaSun>(delta[0]).sample({});
    EXPECT_TRUE(sample.delta);
    EXPECT_EQ(sample.value, Vec3f(3.0f));
    EXPECT_NEAR((sample.direction - Vec3d(std::sqrt(0.75), 0, 0.5)).length(), 0.0, 1e-12);
}

TEST(Light, a_sky_brings_its_sun_unless_told_not_to_or_the_sun_has_set)
{
    const auto with = lights("sky", {{"elevation_deg", number(40)}}), without = lights("sky", {{"elevation_deg", number(40)}, {"sun", text("none")}});
    const auto after = lights("sky", {{"elevation_deg", number(-4)}});
    ASSERT_EQ(with.size(), 2u);
    EXPECT_TRUE(std::holds_alternative<DiscSun>(with[0]));
    EXPECT_TRUE(std::holds_alternative<ClearSky>(with[1]));
    EXPECT_EQ(without.size(), 1u);
    ASSERT_EQ(after.size(), 1u);
    const Vec3f twilight = std::get<ClearSky>(after[0]).radiance(compass_direction(0.05, 0.785));
    EXPECT_TRUE(std::isfinite(twilight.x) && twilight.z >= 0.0f);
}

TEST(Light, a_sun_without_irradiance_shines_like_the_one_of_the_sky)
{
    const auto alone = lights("sun", {{"elevation_deg", number(40)}}), sky = lights("sky", {{"elevation_deg", number(40)}});
    const Vec3f a = std::get<DiscSun>(alone[0]).sample(Vec2d(0.0)).value, b = std::get<DiscSun>(sky[0]).sample(Vec2d(0.0)).value;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-5f * b[k]);
}

TEST(Light, what_is_out_of_range_is_named)
{
    try {
        lights("sun", {{"elevation_deg", number(100)}});
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("elevation"), std::string::npos);
    }
}

}  // namespace
}  // namespace hoodoo
