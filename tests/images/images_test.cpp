// Renders the scenes of this folder and compares their light with the references. See README.md here.
#include "renderer/compare/statistics.h"
#include "renderer/film/write.h"
#include "renderer/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>

using namespace hoodoo;

namespace
{

constexpr std::uint64_t test_seed = 1, reference_seed = 2;  // independent noise
constexpr int reference_effort = 8;                         // times the scene's samples: the test's own noise dominates

const std::filesystem::path folder = std::filesystem::path(HOODOO_SOURCE_DIR) / "tests/images";

std::vector<std::string> scene_names()
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (std::filesystem::exists(entry.path() / "scene.toml")) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

bool starts_with(const std::string& name, const std::string& prefix)
{
    return name.rfind(prefix, 0) == 0;
}

Image picked(const Image& image, const std::function<bool(const std::string&)>& wanted)
{
    Image part = image;
    std::erase_if(part.channels, [&](const Channel& channel) { return !wanted(channel.name); });
    return part;
}

void write_reference(const LoadedScene& scene, const std::filesystem::path& where)
{
    RenderOptions options;
    options.seed = reference_seed;
    options.spp = reference_effort * static_cast<int>(scene.description.render.integer("spp"));
    options.measurements = false;
    const Image image = render(scene, options);
    const auto light = [](const std::string& name) {
        return name == "R" || name == "G" || name == "B" || name == "objectId" || starts_with(name, "material.");
    };
    write_exr(picked(image, light), (where / "mean.exr").string(), ExrPrecision::full);
    write_exr(picked(image, [](const std::string& name) { return starts_with(name, "variance."); }), (where / "variance.exr").string(),
              ExrPrecision::full);
}

Image read_reference(const std::filesystem::path& where)
{
    Image reference = read_exr((where / "mean.exr").string());
    for (Channel& channel : read_exr((where / "variance.exr").string()).channels) reference.channels.push_back(std::move(channel));
    return reference;
}

Image brighter(Image image, float gain)
{
    for (Channel& channel : image.channels)
        if (channel.name == "R" || channel.name == "G" || channel.name == "B")
            for (float& value : channel.pixels) value *= gain;
    return image;
}

class Images : public ::testing::TestWithParam<std::string>
{
};

}  // namespace

TEST_P(Images, keeps_its_light)
{
    const std::filesystem::path where = folder / GetParam();
    SceneOverrides overrides;
    overrides.allowed_roots = {HOODOO_SOURCE_DIR "/scenes"};  // some are the scenes themselves, made small
    const LoadedScene scene = load_scene((where / "scene.toml").string(), false, overrides);
    const char* update = std::getenv("HOODOO_UPDATE_REFERENCES");
    if (update && GetParam() == update) {
        write_reference(scene, where);
        GTEST_SKIP() << "the reference was made again: look at it";
    }
    EXPECT_TRUE(std::filesystem::exists(where / "WHY.md"));
    RenderOptions options;
    options.seed = test_seed;
    const Image image = render(scene, options);
    const Image reference = read_reference(where);

    CompareSettings settings;
    settings.false_alarm = 1e-6 / static_cast<double>(scene_names().size());
    const Comparison comparison = compare_statistically(reference, image, settings);
    RecordProperty("detectable_percent", std::to_string(100.0 * comparison.detectable));
    EXPECT_TRUE(comparison.same) << comparison.text();
    // A comparison that could not see 1% would be no test: it is stated, and tried.
    EXPECT_LT(comparison.detectable, 0.01) << comparison.text();
    EXPECT_FALSE(compare_statistically(reference, brighter(image, 1.01f), settings).same);
    EXPECT_FALSE(compare_statistically(reference, brighter(image, 0.99f), settings).same);
}

INSTANTIATE_TEST_SUITE_P(, Images, ::testing::ValuesIn(scene_names()), [](const auto& info) { return info.param; });

TEST(ImageOfThePlane, has_the_radiance_of_its_formula)
{
    // A Lambert plane reflects L = albedo E sin(elevation) / pi; E = 1000, 900, 800 W/m2 at 30 degrees, albedo 0.5, 0.4, 0.3. No noise, so floats are
    // exact.
    const Image reference = read_exr((folder / "plane" / "mean.exr").string());
    const double irradiance[3] = {1000.0, 900.0, 800.0}, albedo[3] = {0.5, 0.4, 0.3};
    for (int c = 0; c < 3; ++c) {
        const double expected = albedo[c] * irradiance[c] * 0.5 / 3.141592653589793;
        for (const float value : reference.find(std::string(1, "RGB"[c]))->pixels) ASSERT_NEAR(value, expected, 2e-6 * expected);
    }
}
