// Boundaries that light passes: invisible in even light, reciprocal, and the way through them takes what Beer and Fresnel say. What lies under water
// is lit by as much as gets in.
#include "renderer/shading/dielectric.h"
#include "renderer/shading/coat.h"
#include "tests/counts.h"
#include "tests/support/bodies.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

constexpr double kPi = 3.14159265358979323846, kIor = 1.333;

Shot all_events(int samples, int depth = 0)
{
    Shot shot;
    shot.samples = samples;
    shot.path.max_depth = depth;
    return shot;
}

/// A ball of glass or water in even light, seen from outside or from its middle.
double ball_in_white(double roughness, double tilt, double absorption, const Vec3d& eye)
{
    SceneParts parts = lit_parts(Camera(eye, eye + Vec3d(0, 1, 0.2), Vec3d(0, 0, 1), 1.0, true), std::make_unique<Ball>(), {ConstantSky(Vec3f(1.0f))},
                                 std::make_unique<PlainLook>(0.5f, tilt, static_cast<float>(roughness)));
    parts.interiors["wall"] = Interior{kIor, roughness == 0.0, {Vec3d(absorption), Vec3d(0.0), 0.0}};
    return mean(shoot(Scene(std::move(parts), {}), all_events(count(16, 1000))), "R");
}

TEST(Boundary, a_dielectric_is_invisible_in_white_light)
{
    for (const Vec3d& eye : {Vec3d(0, -1.6, 0), Vec3d(0.0)}) {
        for (const double roughness : {0.0, 0.02, 0.1, 0.5}) {
            EXPECT_NEAR(ball_in_white(roughness, 0.0, 0.0, eye), 1.0, 1e-3) << roughness;
            EXPECT_NEAR(ball_in_white(roughness, 0.3, 0.0, eye), 1.0, 1e-3) << roughness << " and bent normals";
        }
        EXPECT_LT(ball_in_white(0.0, 0.0, 0.01, eye), 1.0 - 2e-3) << "the mutant passed";
    }
}

/// Largest relative difference between f(wo, wi) and f(wi, wo), with the index squared on the side light comes from. `flawed`: without it.
double asymmetry(double roughness, bool flawed)
{
    const Vec3d n(0, 0, 1);
    const Dielectric outside(n, n, kIor, roughness), inside(-n, -n, 1.0 / kIor, roughness);
    Numbers random(4);
    double worst = 0.0;
    int compared = 0;
    for (int k = 0; k < 20000; ++k) {
        Vec3d a = random.direction(), b = random.direction();
        if (a.z < 0.0) a = -a;
        if (a.z < 0.01 || std::abs(b.z) < 0.01) continue;
        const double there = outside.evaluate(a, b).pdf / std::abs(b.z);
        const double back = (b.z > 0.0 ? outside : inside).evaluate(b, a).pdf / a.z * (b.z > 0.0 || flawed ? 1.0 : kIor * kIor);
        if (there < 1e-9 && back < 1e-9) continue;
        worst = std::max(worst, std::abs(there - back) / std::max(there, back));
        ++compared;
    }
    EXPECT_GT(compared, 1000);
    return worst;
}

TEST(Boundary, scattering_is_reciprocal)
{
    for (const double roughness : {0.05, 0.3, 0.8}) {
        EXPECT_LT(asymmetry(roughness, false), 1e-6) << roughness;
        EXPECT_GT(asymmetry(roughness, true), 0.4) << "the mutant passed";
    }
}

/// A slab of water 2 m thick, 200 m wide, its top at z = 0.
TriangleMesh slab(double thickness)
{
    const float w = 100.0f, d = static_cast<float>(thickness);
    TriangleMesh mesh;
    for (const float z : {-d, 0.0f})
        for (const float y : {-w, w})
            for (const float x : {-w, w}) mesh.vertices.emplace_back(x, y, z);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    mesh.material = "wall";
    return mesh;
}

/// In even light a slab shows what it reflects and what it lets through. With r Fresnel's share and a = exp(-k d / cos) for one way inside, light
/// that is thrown to and fro: R = r + (1 - r)^2 r a^2 / (1 - r^2 a^2), T = (1 - r)^2 a / (1 - r^2 a^2).
double slab_shows(double cosine, double absorption, double thickness)
{
    const double r = fresnel_dielectric(cosine, kIor), inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (kIor * kIor));
    const double a = std::exp(-absorption * thickness / inside);
    return r + (1.0 - r) * (1.0 - r) * (r * a * a + a) / (1.0 - r * r * a * a);
}

TEST(Boundary, a_slab_takes_light_along_the_true_way_inside)
{
    for (const double cosine : {1.0, 0.7, 0.3}) {
        const Vec3d eye(0, 0, 1.0), towards(0.0, std::sqrt(1.0 - cosine * cosine), -cosine);
        SceneParts parts = lit_parts(Camera(eye, eye + towards, Vec3d(1, 0, 0), 1e-3, true), slab(2.0), {ConstantSky(Vec3f(1.0f))},
                                     std::make_unique<PlainLook>(0.5f));
        parts.interiors["wall"] = Interior{kIor, true, {Vec3d(0.1, 0.4, 1.0), Vec3d(0.0), 0.0}};
        const Image image = shoot(Scene(std::move(parts), {}), all_events(count(256, 4096)));
        EXPECT_NEAR(mean(image, "R"), slab_shows(cosine, 0.1, 2.0), 2e-3);
        EXPECT_NEAR(mean(image, "G"), slab_shows(cosine, 0.4, 2.0), 2e-3);
        EXPECT_NEAR(mean(image, "B"), slab_shows(cosine, 1.0, 2.0), 2e-3);
        // The mutant: as if light went straight on.
        const double straight = 2.0 * std::sqrt(1.0 - (1.0 - cosine * cosine) / (kIor * kIor)) / cosine;
        if (cosine < 1.0) {
            EXPECT_GT(std::abs(mean(image, "G") - slab_shows(cosine, 0.4, straight)), 1e-2) << "the mutant passed";
        }
    }
}

/// Irradiance of a floor at z = -depth, as a camera in the water below the surface sees it: a row of pixels over `width` metres along x. Of white
/// ground L = E / pi; the camera counts L / n^2.
Image floor_under(std::unique_ptr<Surface> sea, Light light, double depth, double absorption, double width, int events, int pixels, int samples)
{
    const double above = 0.5 * depth;
    SceneParts parts{Camera(Vec3d(0, 0, above - depth), Vec3d(0, 0, -depth), Vec3d(0, 1, 0), 2.0 * std::atan(0.5 * width / above), true),
                     {std::move(light)},
                     {},
                     {},
                     {},
                     {},
                     {}};
    TriangleMesh floor = ground(30.0f);
    floor.origin = Vec3d(0, 0, -depth);
    parts.objects = {{"sea", "test", {}, {}}, {"floor", "test", {}, {}}};
    parts.shapes.emplace_back(std::move(sea));
    parts.shapes.emplace_back(std::move(floor));
    parts.looks["wall"] = std::make_unique<PlainLook>(1.0f);
    parts.looks["sea"] = std::make_unique<PlainLook>(1.0f);
    parts.interiors["sea"] = Interior{kIor, true, {Vec3d(absorption), Vec3d(0.0), 0.0}};
    Shot shot;
    shot.width = pixels;
    shot.height = 4;
    shot.data = {0, pixels, 0, 4};
    shot.samples = samples;
    shot.path.max_depth = events;
    const Scene scene(std::move(parts), {});
    EXPECT_NE(scene.around_eye(0.0), nullptr);
    return shoot(scene, shot);
}

/// The same as numbers, and without what the water takes between floor and camera.
std::vector<double> irradiances(const Image& image)
{
    std::vector<double> all;
    for (const float p : image.find("G")->pixels) all.push_back(p * kPi * kIor * kIor);
    return all;
}

double average(const std::vector<double>& v)
{
    double sum = 0.0;
    for (const double x : v) sum += x;
    return sum / static_cast<double>(v.size());
}

struct SunCase {
    double zenith_deg;
    bool disc;
};

TEST(UnderWater, the_floor_gets_what_fresnel_and_beer_let_through_of_the_sun)
{
    for (const SunCase& c : {SunCase{0.0, false}, SunCase{35.0, false}, SunCase{35.0, true}, SunCase{75.0, true}}) {
        const double zenith = c.zenith_deg * kPi / 180.0, cosine = std::cos(zenith), depth = 3.0, absorption = 0.2;
        const Vec3d direction(std::sin(zenith), 0.0, cosine);
        const Light sun = c.disc ? Light(DiscSun(direction, Vec3f(5.0f), 0.00925)) : Light(DeltaSun(direction, Vec3f(5.0f)));
        // One event: what the sun sends to the floor. A narrow view, so that the way to the camera is the depth between.
        const Image seen = floor_under(std::make_unique<SineSea>(0.0), sun, depth, absorption, 0.01, 1, 8, count(600, 4000));
        const double inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (kIor * kIor));
        const double expected = 5.0 * cosine * (1.0 - fresnel_dielectric(cosine, kIor)) * std::exp(-absorption * depth / inside);
        EXPECT_NEAR(average(irradiances(seen)) * std::exp(absorption * 0.5 * depth) / expected, 1.0, 0.01) << "sun at " << c.zenith_deg << " degrees";
    }
}

TEST(UnderWater, the_floor_gets_what_fresnel_and_beer_let_through_of_the_sky)
{
    const double depth = 3.0, absorption = 0.2;
    const Image seen = floor_under(std::make_unique<SineSea>(0.0), ConstantSky(Vec3f(1.0f)), depth, absorption, 0.01, 2, 8, count(8000, 100000));
    double expected = 0.0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {  // 2 pi integral of (1 - F) exp(-a d / cos inside) cos d cos
        const double c = (i + 0.5) / n, inside = std::sqrt(1.0 - (1.0 - c * c) / (kIor * kIor));
        expected += 2.0 * kPi / n * c * (1.0 - fresnel_dielectric(c, kIor)) * std::exp(-absorption * depth / inside);
    }
    EXPECT_NEAR(average(irradiances(seen)) * std::exp(absorption * 0.5 * depth) / expected, 1.0, 0.01);
}

TEST(UnderWater, a_swell_gathers_sunlight_into_lines_and_loses_none)
{
    // Wavelength 2 m, amplitude 0.08 m over 6 m: the crests' focus, at about n / ((n - 1) a k^2) = 5 m, lies above the floor: up to three refractions
    // meet a point. The view is three wavelengths wide.
    const double depth = 6.0, zenith = 20.0 * kPi / 180.0;
    const DiscSun sun(Vec3d(std::sin(zenith), 0.0, std::cos(zenith)), Vec3f(1.0f), 0.00925);
    const auto row = [&](double amplitude, int samples) {
        return irradiances(floor_under(std::make_unique<SineSea>(amplitude, 2.0), sun, depth, 0.0, 6.0, 1, 96, samples));
    };
    const double flat = average(row(0.0, 16));
    std::vector<double> lines = row(0.08, count(200, 3000));
    EXPECT_NEAR(average(lines) / flat, 1.0, 0.02);

    // Percentiles over places: the four rows of a pixel column see the same place of the swell.
    std::vector<double> columns(96);
    for (std::size_t i = 0; i < lines.size(); ++i) columns[i % 96] += 0.25 * lines[i];
    std::sort(columns.begin(), columns.end());
    EXPECT_GT(columns[91] / columns[48], 1.5);
}

TEST(UnderWater, a_swell_loses_none_of_the_sky)
{
    const auto mean_of = [&](double amplitude) {
        return average(
            irradiances(floor_under(std::make_unique<SineSea>(amplitude, 2.0), ConstantSky(Vec3f(1.0f)), 6.0, 0.0, 6.0, 2, 96, count(1000, 20000))));
    };
    EXPECT_NEAR(mean_of(0.08) / mean_of(0.0), 1.0, 0.02);
}

}  // namespace
}  // namespace hoodoo
