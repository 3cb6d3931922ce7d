// What a scene says wrongly about water, foam, haze and waves is answered in words that name the value, what was expected and what was got.
#include "renderer/render.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

/// "what, expected X, got Y, nearest Z" of the first problem of a scene; "none" if it builds.
std::string problem_of(const std::string& text)
{
    try {
        load_scene(
            "version = 1\n[camera]\neye = [0, 0, 20]\ntarget = [0, 10, 20]\n[light.sky]\ntype = \"constant\"\nradiance = { acescg = [1, 1, 1] }\n" +
                text,
            true);
    } catch (const Error& error) {
        const Problem& p = error.problems().front();
        return p.what + (p.expected.empty() ? "" : ", expected " + p.expected) + (p.got.empty() ? "" : ", got " + p.got) +
               (p.nearest.empty() ? "" : ", nearest " + p.nearest);
    }
    return "none";
}

const std::string sea = "[terrain.sea]\ntype = \"breaking_wave\"\nextent = 60\n";
const std::string plane = "[terrain.ground]\ntype = \"plane\"\nmaterial = \"stuff\"\n";

std::string body(const std::string& material, const std::string& medium = {})
{
    return plane + "[material.stuff]\n" + material + "\n" + medium;
}

TEST(WaterErrors, a_rate_is_no_colour_to_look_at)
{
    EXPECT_EQ(problem_of(body("ior = 1.33\nmedium = \"m\"", "[medium.m]\ntype = \"homogeneous\"\nabsorption = { srgb = [0.1, 0.1, 0.1] }\n")),
              "absorption is a rate, not a colour to look at, expected acescg, lin_rec709 or grey, got srgb");
}

TEST(WaterErrors, a_body_is_filled_with_a_medium_there_is)
{
    EXPECT_EQ(problem_of(body("ior = 1.33\nmedium = \"lake\"", "[medium.m]\ntype = \"homogeneous\"\n")),
              "there is no medium of this name, expected one of clear, coastal, deep, m, got \"lake\"");
    EXPECT_EQ(problem_of(body("ior = 1.33\nmedium = \"m\"", "[medium.m]\ntype = \"mist\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n")),
              "a body is filled evenly, expected a medium of type \"homogeneous\", got \"m\" of type \"mist\"");
    EXPECT_EQ(problem_of(body("medium = \"clear\"")),
              "no light gets into this material, expected ior beside it, or the look of water without albedo and coat");
    EXPECT_EQ(problem_of(body("ior = 1.33\nalbedo = { srgb = [0.5, 0.5, 0.5] }")),
              "light passes this material, so it has no colour and no film of its own, expected either ior, or albedo and coat");
}

TEST(WaterErrors, mist_fills_a_box)
{
    EXPECT_EQ(problem_of("[medium.m]\ntype = \"mist\"\nmin = [0, 0, 0]\nmax = [1, -1, 1]\nextinction = 1\n"),
              "the corners of the mist are no box, expected each above 0, 0, 0, got 1, -1, 1");
    EXPECT_EQ(problem_of("[medium.m]\ntype = \"mist\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n"),
              "medium.m lacks the key \"extinction\", expected a number of at least 0");
}

TEST(WaterErrors, foam_is_carried_by_a_terrain_that_has_some)
{
    EXPECT_EQ(problem_of(sea + "[medium.m]\ntype = \"carried\"\nterrain = \"see\"\n"),
              "there is no terrain of this name in the picture, expected one of sea, got \"see\"");
    EXPECT_EQ(problem_of(sea + "[medium.m]\ntype = \"carried\"\nterrain = \"sea\"\n"),
              "the terrain \"sea\" carries no foam or spray, expected one that does");
}

TEST(WaterErrors, haze_is_seen_through)
{
    EXPECT_EQ(problem_of("[haze]\nvisibility = 0\n"),
              "visibility is out of range, expected a length such as 350 (metres) or \"350 m\" above 0, got 0");
    EXPECT_EQ(problem_of("[haze]\nvisibility = 1000\nalbedo = { acescg = [1.5, 1, 1] }\n"),
              "albedo.acescg is out of range, expected a list of 3 numbers between 0 and 1, got 1.5");
    EXPECT_EQ(problem_of("[haze]\nvisibility = 1000\nheight = -1\n"),
              "height is out of range, expected a length such as 350 (metres) or \"350 m\" above 0, got -1");
    EXPECT_EQ(problem_of("[haze]\nvisibility = 1000\nasymmetry = 1\n"), "asymmetry is out of range, expected a number between -0.99 and 0.99, got 1");
    EXPECT_EQ(problem_of("[haze]\nvisibilty = 1000\n"), "unknown key \"visibilty\" in haze, nearest visibility");
}

TEST(WaterErrors, a_wave_has_a_core_in_the_air)
{
    EXPECT_EQ(problem_of(sea + "[[terrain.sea.wave]]\ncore = 6.0\n"), "the core of a wave, expected less than outer, 6 m, got 6");
    EXPECT_EQ(problem_of(sea + "[[terrain.sea.wave]]\ndepth = 0.5\n"),
              "the core of a wave must lie in air, expected at least the core, 0.75 m, got 0.5");
    EXPECT_EQ(problem_of(sea + "[[terrain.sea.wave]]\nalpha = 1.5\n"), "alpha is out of range, expected a number between 2 and 16, got 1.5");
    EXPECT_EQ(problem_of(sea + "[[terrain.sea.swell]]\nheight = 1\n"),
              "swell lacks the key \"wavelength\", expected a length such as 350 (metres) or \"350 m\" of at least 0.1");
}

}  // namespace
}  // namespace hoodoo
