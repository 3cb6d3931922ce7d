// The colour configuration's numbers against those of another program, and who chooses it.
#include "renderer/film/color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace hoodoo;

namespace
{

/// A configuration whose rendering space is ACES 2065-1 itself; with or without the role by which configurations meet.
std::string config_text(const std::string& rendering, bool interchange)
{
    std::string text =
        "ocio_profile_version: 2\nenvironment: {}\nsearch_path: \"\"\nstrictparsing: true\nroles:\n  default: own\n  " + rendering + ": own\n";
    if (interchange) text += "  aces_interchange: own\n";
    return text +
           "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\ndisplays:\n  screen:\n    - !<View> {name: plain, colorspace: own}\n"
           "colorspaces:\n  - !<ColorSpace> {name: own, isdata: false}\n";
}

class Colour : public ::testing::Test
{
protected:
    void SetUp() override
    {
        folder_ = std::filesystem::path(::testing::TempDir()) / ("hoodoo_color_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        ::unsetenv("OCIO");
    }
    void TearDown() override
    {
        std::filesystem::remove_all(folder_);
        ::unsetenv("OCIO");
    }
    std::string file(const std::string& name, const std::string& text)
    {
        const std::string path = (folder_ / name).string();
        std::ofstream(path) << text;
        return path;
    }
    std::filesystem::path folder_;
};

void expect_color(const Vec3f& got, const Vec3f& expected, const std::string& what)
{
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 2e-4f) << what << " channel " << c;
}

Vec3f shown(const ColorTransform& transform, Vec3f rgb)
{
    transform({&rgb, 1});
    return rgb;
}

}  // namespace

TEST_F(Colour, views_show_what_pyopencolorio_shows)
{
    // Values of Debian's PyOpenColorIO 2.1.2 with the same configuration, four decimals, to the sRGB display.
    const auto config = ColorConfig::built_in();
    const ColorTransform aces = config->to_display("sRGB", "ACES 1.0 SDR-video"), plain = config->to_display("sRGB", "Un-tone-mapped");
    struct Row {
        Vec3f color, aces, plain;
    };
    const Row rows[] = {
        {Vec3f(0.18f), Vec3f(0.3560f), Vec3f(0.4614f)},
        {Vec3f(1.0f), Vec3f(0.8120f), Vec3f(1.0f)},
        {Vec3f(10.0f), Vec3f(0.9906f), Vec3f(2.699f)},
        {Vec3f(1, 0, 0), Vec3f(0.9594f, -0.7159f, -0.0048f), Vec3f(1.2627f, -1.683f, -0.310f)},
        {Vec3f(0, 1, 0), Vec3f(-4.194f, 0.8499f, -0.5212f), Vec3f(-8.04f, 1.0595f, -1.667f)},
        {Vec3f(0, 0, 1), Vec3f(-0.6163f, -0.0506f, 0.8524f), Vec3f(-1.076f, -0.136f, 1.0645f)},
    };
    for (const Row& row : rows) {
        for (int c = 0; c < 3; ++c) {
            // Half a unit of the last printed digit, and OpenColorIO's own tolerance; large values were printed with fewer digits.
            EXPECT_NEAR(shown(aces, row.color)[c], row.aces[c], 1e-4f + 1.5e-4f * std::abs(row.aces[c])) << row.color << c;
            EXPECT_NEAR(shown(plain, row.color)[c], row.plain[c], 6e-4f + 7e-4f * std::abs(row.plain[c])) << row.color << c;
        }
    }
}

TEST_F(Colour, scene_colors_reach_the_rendering_space)
{
    const auto config = ColorConfig::built_in();
    // Columns of the matrix from Rec.709 (D65, Bradford adapted) to AP1; PyOpenColorIO prints the same.
    expect_color(config->to_rendering("lin_rec709", Vec3f(1, 0, 0)), Vec3f(0.61310f, 0.07019f, 0.02062f), "red");
    expect_color(config->to_rendering("lin_rec709", Vec3f(0, 1, 0)), Vec3f(0.33952f, 0.91635f, 0.10957f), "green");
    expect_color(config->to_rendering("lin_rec709", Vec3f(0, 0, 1)), Vec3f(0.04738f, 0.01345f, 0.86981f), "blue");
    expect_color(config->to_rendering("acescg", Vec3f(0.1f, 0.2f, 0.3f)), Vec3f(0.1f, 0.2f, 0.3f), "acescg");
    // The sRGB curve: 0.5 -> ((0.5 + 0.055) / 1.055)^2.4 = 0.21404; grey stays grey.
    expect_color(config->to_rendering("srgb", Vec3f(0.5f)), Vec3f(0.21404f), "srgb");
    expect_color(config->to_rendering("Raw", Vec3f(0.5f)), Vec3f(0.5f), "data");
    std::vector<Vec3f> many(3, Vec3f(0.5f));
    config->to_rendering("srgb_tx")(many);
    for (const Vec3f& color : many) expect_color(color, Vec3f(0.21404f), "many");
}

TEST_F(Colour, the_rendering_space_states_its_primaries)
{
    const auto config = ColorConfig::built_in();
    EXPECT_EQ(config->rendering_space(), "ACEScg");
    EXPECT_EQ(config->interop_id(), "lin_ap1_scene");
    // AP1 and its white point as SMPTE and the Academy (S-2014-004) state them.
    const float ap1[8] = {0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f};
    const std::vector<float> xy = config->chromaticities();
    ASSERT_EQ(xy.size(), 8u);
    for (int i = 0; i < 8; ++i) EXPECT_NEAR(xy[i], ap1[i], 2e-5f) << i;
}

TEST_F(Colour, the_command_line_comes_before_the_scene_before_the_environment_before_ours)
{
    const std::string a = file("a.ocio", config_text("rendering", true)), b = file("b.ocio", config_text("scene_linear", true));
    const std::string broken = file("broken.ocio", "this is no configuration");
    EXPECT_EQ(ColorConfig::choose("", "")->rendering_space(), "ACEScg");
    ::setenv("OCIO", a.c_str(), 1);
    EXPECT_EQ(ColorConfig::choose("", "")->rendering_space(), "own");
    ::setenv("OCIO", broken.c_str(), 1);
    EXPECT_THROW(ColorConfig::choose("", ""), Error);
    EXPECT_EQ(ColorConfig::choose("", b)->rendering_space(), "own");
    EXPECT_THROW(ColorConfig::choose("", broken), Error);
    EXPECT_EQ(ColorConfig::choose(a, broken)->rendering_space(), "own");
    ::setenv("OCIO", "", 1);
    EXPECT_EQ(ColorConfig::choose("", "")->rendering_space(), "ACEScg");
}

TEST_F(Colour, words_of_the_scene_mean_the_same_under_a_foreign_configuration)
{
    const auto foreign = ColorConfig::open(file("foreign.ocio", config_text("rendering", true)));
    // Its rendering space is AP0: the columns of the matrix from AP1 to AP0 (Academy TB-2014-004).
    expect_color(foreign->to_rendering("acescg", Vec3f(1, 0, 0)), Vec3f(0.6954522f, 0.0447946f, -0.0055259f), "red");
    expect_color(foreign->to_rendering("acescg", Vec3f(0, 1, 0)), Vec3f(0.1406787f, 0.8596711f, 0.0040252f), "green");
    EXPECT_EQ(foreign->interop_id(), "lin_ap0_scene");
    EXPECT_TRUE(foreign->knows("srgb"));
    EXPECT_TRUE(foreign->knows("own"));
    EXPECT_FALSE(foreign->knows("nonsense"));
}

TEST_F(Colour, a_configuration_that_cannot_be_compared_says_so)
{
    const auto lonely = ColorConfig::open(file("lonely.ocio", config_text("rendering", false)));
    EXPECT_TRUE(lonely->chromaticities().empty());
    EXPECT_EQ(lonely->interop_id(), "");
    EXPECT_FALSE(lonely->knows("acescg"));
    try {
        lonely->to_rendering("acescg", Vec3f(1.0f));
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(),
                     "the colour configuration cannot be told what \"acescg\" is, expected a configuration with the role aces_interchange or a "
                     "colour space ACES2065-1");
    }
    EXPECT_THROW(ColorConfig::open(file("none.ocio", config_text("texture_paint", true))), Error);  // no rendering space
}

TEST_F(Colour, wrong_names_are_answered_with_the_right_ones)
{
    const auto config = ColorConfig::built_in();
    try {
        config->to_display("sRGB", "Un-tone-maped", {"a.toml", 3, 8, ""});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::scene);
        EXPECT_STREQ(error.what(),
                     "a.toml:3:8: the colour configuration has no such view, expected one of \"ACES 1.0 SDR-video\", \"Un-tone-mapped\", \"Raw\", "
                     "got \"Un-tone-maped\" (did you mean \"Un-tone-mapped\")");
    }
    EXPECT_THROW(config->to_display("television", ""), Error);
    EXPECT_THROW(config->to_rendering("ACEScgg"), Error);
    try {
        ColorConfig::open((folder_ / "absent.ocio").string());
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::file);
    }
}
