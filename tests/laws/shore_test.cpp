// Where water is not alone: flecks of foam on it, and haze before its horizon.
#include "renderer/render.h"
#include "tests/counts.h"
#include "tests/support/bodies.h"
#include "tests/support/lit_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// Flat water of which a share is covered by flecks, finer than any pixel, of another material.
class FleckedSea final : public Surface
{
public:
    explicit FleckedSea(float covered) : covered_(covered) {}
    std::uint32_t patch_count(std::uint32_t tile) const override { return sea_.patch_count(tile); }
    Box3d patch_bounds(PatchId patch) const override { return sea_.patch_bounds(patch); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return sea_.intersect(patch, ray, hit); }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = sea_.interact(ray, hit);
        at.materials = {};
        at.materials.add(0, 1.0f - covered_);
        at.materials.add(1, covered_);
        return at;
    }
    bool contains(const Vec3d& p) const override { return sea_.contains(p); }
    std::vector<std::string> materials() const override { return {"wall", "flecks"}; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override { return {}; }

private:
    SineSea sea_{0.0};
    float covered_;
};

/// Under an even sky of radiance 1, above and below: bare water is invisible, black flecks take what they cover.
double flecked(float covered, bool light_passes)
{
    SceneParts parts = lit_parts(Camera(Vec3d(0, -3, 2), Vec3d(0.0), Vec3d(0, 0, 1), 0.5, true), std::make_unique<FleckedSea>(covered),
                                 {ConstantSky(Vec3f(1.0f))}, std::make_unique<PlainLook>(0.0f));
    parts.looks["flecks"] = std::make_unique<PlainLook>(0.0f);
    if (light_passes) parts.interiors["wall"] = Interior{1.333, true, {}};
    Shot shot;
    shot.samples = count(64, 4096);
    return mean(shoot(Scene(std::move(parts), {}), shot), "G");
}

TEST(Flecks, take_the_light_of_the_share_that_they_cover)
{
    // 16 x 16 pixels x 64 samples of a coin: a standard deviation of at most 0.5 / sqrt(16384) = 0.004; six of them.
    for (const float covered : {0.02f, 0.3f, 0.9f}) EXPECT_NEAR(flecked(covered, true), 1.0 - covered, count(24, 3) * 1e-3) << covered;
    // The mutant: an average of both that lets nothing pass.
    EXPECT_LT(flecked(0.02f, false), 0.5) << "the mutant passed";
}

/// Mean radiance of a strip of 1/100 degree, `degrees` above the horizon of a dark plain, 5 m under the eye.
double strip(double degrees, const std::string& visibility)
{
    const double slope = std::tan(degrees * 3.14159265358979323846 / 180.0);
    const LoadedScene loaded = load_scene(
        fmt::format(
            "version = 1\n[camera]\neye = [0, 0, 5]\ntarget = [0, 100, {}]\nhfov = \"0.08 deg\"\n[film]\nwidth = 16\nheight = 2\n[light.sky]\n"
            "type = \"sky\"\nelevation = \"25 deg\"\nazimuth = \"70 deg\"\n{}[material.ground]\nalbedo = {{ acescg = [0.03, 0.03, 0.03] }}\n"
            "[terrain.plain]\ntype = \"plane\"\nextent = 2000000\n",
            5.0 + 100.0 * slope, visibility),
        true);
    RenderOptions options;
    options.spp = count(256, 4096);
    return mean(render(loaded, options), "G");
}

TEST(Haze, sea_and_sky_meet_at_the_horizon)
{
    // 0.05 degrees down the plain is 5.7 km away: with a visibility of 1.5 km its own light is e^-14 of itself, and what is seen is the haze.
    const std::string haze = "[haze]\nvisibility = 1500\nheight = 400\n";
    const double below = strip(-0.05, haze), above = strip(0.05, haze);
    EXPECT_NEAR(below / above, 1.0, 0.06) << below << " and " << above;
    // The mutant: no haze, and a plain as dark as it is.
    EXPECT_LT(strip(-0.05, "") / strip(0.05, ""), 0.5) << "the mutant passed";
}

}  // namespace
}  // namespace hoodoo
