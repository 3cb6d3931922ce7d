// Media: even and tracked ones are the same light, none loses any, and foam shines through.
#include "renderer/media/mist.h"
#include "renderer/media/phase.h"
#include "tests/counts.h"
#include "tests/support/bodies.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

constexpr double kPi = 3.14159265358979323846;

/// Sees the unit ball and a rim of what is beyond it.
Camera at_ball()
{
    return Camera(Vec3d(0, -4, 0), Vec3d(0.0), Vec3d(0, 0, 1), 2.0 * std::atan(0.3), true);
}

struct World {
    std::vector<Light> lights;
    std::optional<Interior> body;  ///< of a ball of radius 1; without: no ball
    bool ground = false;           ///< white, at z = 0
    Media media;
};

Scene build(const Camera& camera, World world)
{
    SceneParts parts{camera, std::move(world.lights), {}, {}, {}, {}, std::move(world.media)};
    if (world.body) {
        parts.objects.push_back({"ball", "test", {}, {}});
        parts.shapes.push_back(std::make_unique<Ball>());
        parts.looks["wall"] = std::make_unique<PlainLook>(0.5f);
        parts.interiors["wall"] = *world.body;
    }
    if (world.ground) {
        parts.objects.push_back({"ground", "test", {}, {}});
        parts.shapes.push_back(std::make_unique<SineSea>(0.0, 1.0, 1e5));
        parts.looks["sea"] = std::make_unique<PlainLook>(1.0f);
    }
    return Scene(std::move(parts), {});
}

double radiance(const Scene& scene, int samples, int pixels = 16)
{
    Shot shot;
    shot.width = shot.height = pixels;
    shot.data = {0, pixels, 0, pixels};
    shot.samples = samples;
    shot.path.max_depth = 0;
    return mean(shoot(scene, shot), "G");
}

Region ball_region(double extinction, float albedo, double asymmetry, double density = 1.0)
{
    return Region(std::make_shared<BallDensity>(1.0, density), {extinction, Vec3f(albedo), asymmetry}, 4096);
}

std::vector<Light> sun_and_sky()
{
    return {DeltaSun(Vec3d(0.6, -0.5, 0.62449979983984), Vec3f(2.0f)), ConstantSky(Vec3f(0.3f))};
}

/// A ball of an even medium, its boundary without refraction, against the same ball as a density: absorbing, scattering forward, sun and sky.
double even_ball(double extinction, double albedo, double asymmetry, int samples)
{
    World world{sun_and_sky(), Interior{1.0, true, {}}, false, {}};
    world.body->medium = {Vec3d(extinction * (1.0 - albedo)), Vec3d(extinction * albedo), asymmetry};
    return radiance(build(at_ball(), std::move(world)), samples);
}

double tracked_ball(double extinction, double albedo, double asymmetry, double density, int samples)
{
    World world{sun_and_sky(), {}, false, {}};
    world.media.regions.push_back(ball_region(extinction, static_cast<float>(albedo), asymmetry, density));
    const Scene scene = build(at_ball(), std::move(world));
    const double mean = radiance(scene, samples);
    EXPECT_EQ(scene.media().samples_above_bound(), 0u);
    return mean;
}

TEST(Media, homogeneous_and_heterogeneous_media_of_equal_density_agree)
{
    const int samples = count(400, 4000);
    const double tolerance = 0.006;
    for (const double asymmetry : {0.0, 0.7}) {
        const double even = even_ball(3.0, 0.8, asymmetry, samples);
        EXPECT_NEAR(tracked_ball(3.0, 0.8, asymmetry, 1.0, samples) / even, 1.0, tolerance) << "asymmetry " << asymmetry;
        // Half the density at twice the extinction is the same medium with more tentative collisions.
        EXPECT_NEAR(tracked_ball(6.0, 0.8, asymmetry, 0.5, samples) / even, 1.0, tolerance) << "asymmetry " << asymmetry;
        // The mutant: a density that is a tenth too high, which is worth 1.2% (0.0116 at 4000 samples).
        EXPECT_GT(std::abs(tracked_ball(3.3, 0.8, asymmetry, 1.0, samples) / even - 1.0), tolerance) << "the mutant passed";
    }
}

/// Even light from everywhere shows no medium that loses nothing.
struct White {
    double even, tracked, hazy;
};
White white(double albedo, int samples)
{
    const std::vector<Light> sky = {ConstantSky(Vec3f(1.0f))};
    White out{};
    World even{sky, Interior{1.333, true, {Vec3d(5.0 * (1.0 - albedo)), Vec3d(5.0 * albedo), 0.8}}, false, {}};
    out.even = radiance(build(at_ball(), std::move(even)), samples);
    World tracked{sky, {}, false, {}};
    tracked.media.regions.push_back(ball_region(8.0, static_cast<float>(albedo), 0.5));
    tracked.media.regions.push_back(ball_region(4.0, static_cast<float>(albedo), -0.3));
    out.tracked = radiance(build(at_ball(), std::move(tracked)), samples);
    // Over white ground: in haze without a floor a path may wander for ever.
    World hazy{sky, {}, true, {}};
    hazy.media.haze.emplace(Coefficients{Vec3d(0.1 * (1.0 - albedo)), Vec3d(0.08, 0.1, 0.13) * albedo, 0.7}, 1.0, 9.0);
    out.hazy = radiance(build(Camera(Vec3d(0, 0, 2), Vec3d(0, 9, 1.5), Vec3d(0, 0, 1), 1.2, true), std::move(hazy)), samples);
    return out;
}

TEST(Media, albedo_one_conserves_energy)
{
    const int samples = count(16, 1000);
    const White all = white(1.0, samples);
    EXPECT_NEAR(all.even, 1.0, 1e-3);
    EXPECT_NEAR(all.tracked, 1.0, 1e-3);
    EXPECT_NEAR(all.hazy, 1.0, 0.02);  // weights of channels that scatter differently are one in the mean alone
    const White grey = white(0.99, samples);
    EXPECT_LT(grey.even, 1.0 - 5e-3) << "the mutant passed";
    EXPECT_LT(grey.tracked, 1.0 - 5e-3) << "the mutant passed";
    EXPECT_LT(grey.hazy, 0.98) << "the mutant passed";
}

TEST(Media, haze_of_albedo_one_conserves_energy_in_the_mean)
{
    EXPECT_NEAR(white(1.0, count(400, 20000)).hazy, 1.0, 0.004);
}

TEST(Media, no_sample_is_above_its_bound_and_a_bound_too_low_is_counted)
{
    const Puffs puffs{0.4, 5.0, 0.6, 0.3, 7};
    const auto mist = std::make_shared<Mist>(Box3d(Vec3d(-1.0), Vec3d(1.0)), 0.3, puffs);
    const auto shoot_through = [&](std::shared_ptr<const Density> density) {
        const Region region(std::move(density), {20.0, Vec3f(1.0f), 0.0}, 32768);
        NumberStream random(3);
        Numbers rays(5);
        for (int k = 0; k < count(20000, 1000000); ++k) {
            Ray ray;
            ray.origin = rays.in(Box3d(Vec3d(-2.0), Vec3d(2.0)));
            ray.direction = rays.direction();
            region.transmittance(ray, kInfinity, random);
            region.collide(ray, kInfinity, random);
        }
        return region.samples_above_bound();
    };
    EXPECT_EQ(shoot_through(mist), 0u);
    EXPECT_GT(shoot_through(std::make_shared<UnderstatedDensity>(mist, 0.5)), 0u) << "the mutant passed";
}

/// A plane-parallel slab, photon by photon: nothing of the renderer but its random numbers' hash. Sun straight down on the top; what leaves at the
/// bottom and at the top in a belt of cosines around `mu`, as radiance for a unit of irradiance.
struct Slab {
    double below = 0.0, above = 0.0;
};
Slab plane_parallel(double depth, double albedo, double g, double mu, int photons)
{
    constexpr double belt = 0.05;
    Slab leaving;
    Numbers random(11);
    for (int k = 0; k < photons; ++k) {
        double z = 0.0, c = 1.0, weight = 1.0;  // optical depth from the top, cosine with downwards
        while (true) {
            z -= std::log(1.0 - random()) * c;
            if (z < 0.0 || z > depth) {
                double& side = z < 0.0 ? leaving.above : leaving.below;
                if (std::abs(std::abs(c) - mu) < belt) side += weight;
                break;
            }
            weight *= albedo;
            if (weight < 0.01 && random() >= 0.1) break;
            if (weight < 0.01) weight *= 10.0;
            // Henyey and Greenstein's cosine from the cumulative distribution, then the cosine with the vertical by spherical trigonometry.
            const double xi = random(), root = (1.0 - g * g) / (1.0 + g * (2.0 * xi - 1.0));
            const double t = (1.0 + g * g - root * root) / (2.0 * g), azimuth = 2.0 * kPi * random();
            c = std::clamp(c * t + std::sqrt((1.0 - c * c) * (1.0 - t * t)) * std::cos(azimuth), -1.0, 1.0);
        }
    }
    const double scale = 1.0 / (photons * 2.0 * kPi * mu * 2.0 * belt);
    leaving.above *= scale;
    leaving.below *= scale;
    return leaving;
}

TEST(Media, a_backlit_slab_of_foam_is_as_bright_as_plane_parallel_transport_says)
{
    constexpr double depth = 20.0, albedo = 0.999, g = 0.85, mu = 0.8;
    const Slab exact = plane_parallel(depth, albedo, g, mu, count(400000, 10000000));

    const auto seen = [&](double from) {
        World world{{DeltaSun(Vec3d(0, 0, 1), Vec3f(1.0f))}, {}, false, {}};
        const Box3d slab(Vec3d(-500, -500, -0.5), Vec3d(500, 500, 0.5));
        world.media.regions.emplace_back(std::make_shared<Mist>(slab, 0.0, Puffs{}), RegionMaterial{depth, Vec3f(static_cast<float>(albedo)), g},
                                         4096);
        const Vec3d eye(0.0, 0.0, from);
        const Vec3d towards(std::sqrt(1.0 - mu * mu), 0.0, from > 0.0 ? -mu : mu);
        const Camera camera(eye, eye + towards, Vec3d(0, 1, 0), 0.1, true);  // 0.1 radian: cosines within 0.03 of mu
        // Twice as many samples differ by about 0.01 of the radiance: a third of the tolerance.
        return radiance(build(camera, std::move(world)), count(800, 6400));
    };
    const double backlit = seen(-2.0), frontlit = seen(2.0);
    EXPECT_NEAR(backlit / exact.below, 1.0, 0.03);
    EXPECT_NEAR(frontlit / exact.above, 1.0, 0.03);
    EXPECT_GT(backlit, 0.5 * frontlit);
    EXPECT_LT(backlit, 2.0 * frontlit);

    // Mutants of the comparison: what peers drop. Scattered once, and an albedo of 0.98, are far off.
    EXPECT_LT(plane_parallel(depth, 0.98, g, mu, 100000).below, 0.8 * exact.below);
}

}  // namespace
}  // namespace hoodoo
