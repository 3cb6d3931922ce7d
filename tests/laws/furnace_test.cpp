// Energy: a white world under a white sky is invisible, and a cave of any albedo is as bright as its series says.
//
// In a hollow sphere every wall element sees every other with the same form factor, so a Lambertian wall of albedo a, whose opening takes the share f
// of the sphere and shows a sky of radiance 1, has the radiance L = a (f + (1 - f) L): the geometric series sum over n >= 1 of a^n (1 - f)^(n - 1) f,
// in which n counts scattering events. A lid at height z = h leaves f = (1 - h) / 2.
#include "renderer/render.h"
#include "tests/counts.h"
#include "tests/support/lit_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace hoodoo
{
namespace
{

using testing::Cave;
using testing::lit_parts;
using testing::mean;
using testing::PlainLook;
using testing::shoot;
using testing::Shot;

constexpr double kPi = 3.14159265358979323846;

/// A camera in the middle that looks down, away from the opening.
Scene cave(double opening, float albedo, double tilt, float roughness = 0.0f)
{
    const Camera camera(Vec3d(0.0), Vec3d(0, 0, -1), Vec3d(0, 1, 0), 1.0, true);
    return Scene(lit_parts(camera, std::make_unique<Cave>(1.0 - 2.0 * opening), {ConstantSky(Vec3f(1.0f))},
                           std::make_unique<PlainLook>(albedo, tilt, roughness)),
                 {});
}

double cave_radiance(const Scene& scene, int depth, int samples)
{
    Shot shot;
    shot.samples = samples;
    shot.path.max_depth = depth;
    return mean(shoot(scene, shot), "R");
}

TEST(Furnace, a_white_cave_of_unlimited_depth_is_as_bright_as_its_sky)
{
    EXPECT_NEAR(cave_radiance(cave(0.05, 1.0f, 0.0), 0, 16), 1.0, 1e-3);
}

TEST(Furnace, bent_normals_lose_nothing)
{
    EXPECT_NEAR(cave_radiance(cave(0.1, 1.0f, 0.3), 0, 16), 1.0, 1e-3);
    EXPECT_NEAR(cave_radiance(cave(0.1, 1.0f, 1.2), 0, 16), 1.0, 1e-3);
}

TEST(Furnace, a_missing_cosine_or_a_truncated_path_is_seen)
{
    // The mutants of this law: an albedo of 0.99, and a limit of 20 events, take more than the tolerance.
    EXPECT_LT(cave_radiance(cave(0.05, 0.99f, 0.0), 0, 16), 1.0 - 1e-2);
    EXPECT_LT(cave_radiance(cave(0.05, 1.0f, 0.0), 20, 16), 1.0 - 1e-2);
}

TEST(Furnace, a_rough_white_cave_loses_nothing)
{
    // Rough weights are one only in the mean. Pictures of 400 samples deviate by 0.0031 (over 40 seeds, whose mean is 1.0001 +- 0.0005), so these by
    // 0.0008 and 0.0001: the tolerances are six and eight times that.
    EXPECT_NEAR(cave_radiance(cave(0.3, 1.0f, 0.0, 1.0f), 0, testing::count(6400, 250000)), 1.0, testing::count(50, 10) * 1e-4);
}

TEST(Furnace, a_grey_cave_obeys_its_series)
{
    const double a = 0.5, f = 0.1;
    const Scene scene = cave(f, 0.5f, 0.0);
    const int samples = testing::count(1000, 20000);
    double partial = 0.0;
    for (int n = 1; n <= 4; ++n) {
        partial += std::pow(a, n) * std::pow(1.0 - f, n - 1) * f;
        // A sample is at most a^n: its deviation is under a^n and the standard error under 0.5 / sqrt(256000) = 1e-3; Sobol' points do better.
        EXPECT_NEAR(cave_radiance(scene, n, samples), partial, 0.01 * partial) << n << " events";
    }
    EXPECT_NEAR(cave_radiance(scene, 0, samples), a * f / (1.0 - a * (1.0 - f)), 0.01 * partial);
}

TEST(Furnace, roulette_keeps_the_mean)
{
    const double a = 0.5, f = 0.3, exact = a * f / (1.0 - a * (1.0 - f));
    const Scene scene = cave(f, 0.5f, 0.0);
    for (const int depth : {0, 2, 8}) {
        Shot shot;
        shot.samples = testing::count(1000, 20000);
        shot.path.max_depth = 0;
        shot.path.roulette_depth = depth;
        EXPECT_NEAR(mean(shoot(scene, shot), "R"), exact, 0.01 * exact) << "roulette from event " << depth;
    }
}

/// Darkest and brightest pixel of scenes/furnace.toml: a canyon with a cave, traced as a convolution surface with smoothed normals.
std::pair<float, float> furnace_scene(const SceneOverrides& overrides)
{
    const LoadedScene loaded = load_scene(std::string(HOODOO_SOURCE_DIR) + "/scenes/furnace.toml", false, overrides);
    RenderOptions options;
    options.quick = testing::count(1, 0) == 1;
    const Image image = render(loaded, options);
    const std::vector<float>& pixels = image.find("G")->pixels;
    const auto [low, high] = std::minmax_element(pixels.begin(), pixels.end());
    return {*low, *high};
}

TEST(Furnace, the_scene_of_that_name_is_invisible)
{
    const auto [low, high] = furnace_scene({});
    EXPECT_NEAR(low, 1.0, 1e-3);
    EXPECT_NEAR(high, 1.0, 1e-3);
}

TEST(Furnace, the_scene_of_that_name_shows_one_percent_of_absorption)
{
    SceneOverrides overrides;
    overrides.sets = {{"material.bedrock.albedo", "{ grey = 0.99 }"}};
    EXPECT_LT(furnace_scene(overrides).first, 0.99);
}

/// Radiance of flat ground of albedo 0.5 seen from above.
double ground_radiance(std::vector<Light> lights, int samples, double tilt = 0.0)
{
    const Camera camera(Vec3d(0, 0, 10), Vec3d(0, 0, 0), Vec3d(0, 1, 0), 0.5, true);
    const Scene scene(lit_parts(camera, testing::ground(), std::move(lights), std::make_unique<PlainLook>(0.5f, tilt)), {});
    Shot shot;
    shot.samples = samples;
    return mean(shoot(scene, shot), "G");
}

TEST(Irradiance, the_delta_sun_lights_flat_ground_by_the_cosine)
{
    const Vec3d sun = compass_direction(0.4, 1.0);
    EXPECT_NEAR(ground_radiance({DeltaSun(sun, Vec3f(3.0f))}, 4), 0.5 / kPi * 3.0 * std::sin(0.4), 1e-6);
}

TEST(Irradiance, the_sun_disc_lights_like_the_delta_sun_however_wide)
{
    // The irradiance of a disc that lies wholly above the horizon on a plane that faces it at an angle is E cos(angle), exactly.
    for (const double diameter : {0.00925, 0.3}) {
        const Vec3d sun = compass_direction(0.4, 1.0);
        EXPECT_NEAR(ground_radiance({DiscSun(sun, Vec3f(3.0f), diameter)}, 64), 0.5 / kPi * 3.0 * std::sin(0.4), diameter < 0.1 ? 1e-4 : 1e-3);
    }
}

TEST(Irradiance, a_constant_sky_lights_flat_ground_by_its_albedo)
{
    EXPECT_NEAR(ground_radiance({ConstantSky(Vec3f(2.0f))}, 4), 0.5 * 2.0, 1e-6);
}

TEST(Irradiance, the_clear_sky_lights_flat_ground_as_quadrature_says)
{
    const Vec3d sun = compass_direction(0.5, 1.0);
    const auto table = std::make_shared<const SkyTable>(AtmosphereParameters{}, sun, [](const Vec3d& c) { return Vec3f(c); });
    double irradiance = 0.0;
    constexpr int rows = 2000, columns = 500;
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double sine = (i + 0.5) / rows, azimuth = 2.0 * kPi * (j + 0.5) / columns, cosine = std::sqrt(1.0 - sine * sine);
            irradiance += table->radiance(Vec3d(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine)).y * sine * 2.0 * kPi / rows / columns;
        }
    }
    const double expected = 0.5 / kPi * irradiance;
    // About 0.3 of the mean is the deviation of one sample: a standard error of 6e-4 at 1024 x 256 samples, if they were independent.
    EXPECT_NEAR(ground_radiance({ClearSky(table)}, testing::count(1024, 8192)), expected, testing::count(25, 10) * 1e-4 * expected);
}

}  // namespace
}  // namespace hoodoo
