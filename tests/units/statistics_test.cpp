// The comparison of pictures has the error rates that it states: it is tried on many pairs that are the same and on mutants that are not.
#include "renderer/compare/statistics.h"
#include "renderer/film/film.h"
#include "terrain/math/hash.h"
#include "tests/counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace hoodoo;

namespace
{

constexpr int side = 32, replicates = 8, samples = 64;

/// A picture of heavy-tailed light: lognormal samples (sigma 1, so the mean is e^0.5 times the median), a gradient from left to right, two objects.
/// `gain(x, y)` multiplies the light.
template <typename Gain>
Image noisy(std::uint64_t seed, Gain gain)
{
    FilmLayout layout;
    layout.width = layout.height = side;
    layout.data = {0, side, 0, side};
    layout.samples = samples;
    layout.replicates = replicates;
    layout.materials = {"sand"};
    Film film(layout);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            PixelSums sums(film.layout());
            for (int i = 0; i < samples; ++i) {
                const std::uint64_t cell = hash_cell(seed, x, y, i);
                // Box and Muller: a normal number from two uniform ones.
                const double normal =
                    std::sqrt(-2.0 * std::log(1.0 - unit_real(mix64(cell)))) * std::cos(6.283185307179586 * unit_real(mix64(cell + 1)));
                PixelSample sample;
                sample.radiance = Vec3f(static_cast<float>(gain(x, y) * (1.0 + x / 16.0) * std::exp(normal)));
                sample.alpha = 1.0f;
                sample.object = x < 16 ? 1 : 2;
                const float share = y < 16 ? 1.0f : 0.0f;
                sample.materials = {&share, 1};
                sums.add(sample);
                if ((i + 1) % (samples / replicates) == 0) sums.end_replicate();
            }
            film.record(x, y, sums);
        }
    Image image = film.develop();
    image.metadata["hoodoo:replicates"] = replicates;
    return image;
}

Image noisy(std::uint64_t seed)
{
    return noisy(seed, [](int, int) { return 1.0; });
}

/// The same pixels in another light, without new noise.
Image brighter(Image image, float gain, float variance_gain)
{
    for (Channel& channel : image.channels)
        for (float& v : channel.pixels)
            if (channel.name.size() == 1 && channel.name != "A" && channel.name != "Z")
                v *= gain;
            else if (channel.name.rfind("variance.", 0) == 0)
                v *= variance_gain;
    return image;
}

/// A constant picture without noise.
Image flat(float value)
{
    Image image = noisy(1);
    for (Channel& channel : image.channels)
        for (float& v : channel.pixels)
            if (channel.name == "R" || channel.name == "G" || channel.name == "B")
                v = value;
            else if (channel.name.rfind("variance.", 0) == 0)
                v = 0.0f;
    return image;
}

}  // namespace

TEST(Statistics, pictures_of_the_same_light_are_the_same)
{
    // At a stated rate of 1% the expected number of alarms among 60 pairs is at most 0.6; 6 or more happen with chance 4e-5 if the statement is true.
    // (Nightly: 500 pairs, at most 5 expected, 17 or more have chance 1e-5.)
    CompareSettings settings;
    settings.false_alarm = 0.01;
    const int pairs = hoodoo::testing::count(60, 500);
    int alarms = 0;
    for (int k = 0; k < pairs; ++k) alarms += !compare_statistically(noisy(2 * k + 1000), noisy(2 * k + 1001), settings).same;
    RecordProperty("alarms", alarms);
    EXPECT_LT(alarms, hoodoo::testing::count(6, 17));
}

TEST(Statistics, a_change_as_large_as_stated_is_found_as_often_as_stated)
{
    // The stated change is found with chance 0.99 in the whole picture alone; of 60 pairs at least 56 are found except with chance 3e-4 (of 500: 485,
    // 2e-4).
    CompareSettings settings;
    const int pairs = hoodoo::testing::count(60, 500);
    int found = 0;
    for (int k = 0; k < pairs; ++k) {
        const Image reference = noisy(2 * k + 5000);
        const double detectable = compare_statistically(reference, reference, settings).detectable;
        found += !compare_statistically(reference, noisy(2 * k + 5001, [&](int, int) { return 1.0 + detectable; }), settings).same;
    }
    RecordProperty("found", found);
    EXPECT_GE(found, hoodoo::testing::count(56, 485));
}

TEST(Statistics, half_of_that_change_is_not_always_found)
{
    // So that the statement is no understatement: the chance of a find at half the change is below one half (the threshold is more than two thirds of
    // it).
    const Image reference = noisy(1);
    const double detectable = compare_statistically(reference, reference).detectable;
    int found = 0;
    for (int k = 0; k < 20; ++k) found += !compare_statistically(reference, noisy(100 + k, [&](int, int) { return 1.0 + 0.5 * detectable; })).same;
    EXPECT_LT(found, 18);
}

TEST(Statistics, one_per_cent_is_found_where_the_noise_allows_it)
{
    // Scaling the variances by 1/100 is what 100 times the samples do; then 1% more light is far above the stated limit.
    const Image calm = brighter(noisy(3), 1.0f, 0.01f);
    const Comparison same = compare_statistically(calm, calm);
    EXPECT_TRUE(same.same);
    EXPECT_LT(same.detectable, 0.01);
    const Comparison changed = compare_statistically(calm, brighter(calm, 1.01f, 1.0f));
    EXPECT_FALSE(changed.same);
    EXPECT_GT(changed.regions.front().t, 0.0);
    EXPECT_FALSE(compare_statistically(calm, brighter(calm, 0.99f, 1.0f)).same);
}

TEST(Statistics, the_region_that_changed_is_named)
{
    const Image reference = noisy(11);
    const auto worst = [&](const Image& test) { return compare_statistically(reference, test).regions.front().region; };
    EXPECT_EQ(worst(noisy(12, [](int x, int) { return x < 16 ? 1.25 : 1.0; })), "object 1");
    EXPECT_EQ(worst(noisy(13, [](int, int y) { return y < 16 ? 1.25 : 1.0; })), "material sand");
    EXPECT_EQ(worst(noisy(14, [](int x, int y) { return x < 16 && y >= 16 ? 1.25 : 1.0; })), "block 0,16");
}

TEST(Statistics, pictures_without_noise_differ_as_soon_as_rounding_does_not_explain_it)
{
    EXPECT_TRUE(compare_statistically(flat(1.0f), flat(1.0f)).same);
    EXPECT_TRUE(compare_statistically(flat(1.0f), flat(1.0f + 0x1p-23f)).same);
    EXPECT_FALSE(compare_statistically(flat(1.0f), flat(1.00001f)).same);
}

TEST(Statistics, what_cannot_be_compared_is_not_the_same)
{
    const Image good = noisy(1);
    const auto problem = [&](const Image& test) {
        const Comparison result = compare_statistically(good, test);
        EXPECT_FALSE(result.same);
        return result.problem;
    };
    Image single = good;
    single.metadata["hoodoo:replicates"] = 1;
    EXPECT_EQ(problem(single), "the test picture states no variance between replicates");
    Image crop = good;
    crop.data.x1 = 16;
    EXPECT_EQ(problem(crop), "the pictures have different windows: 32x32 and 16x32");
    Image nan = good;
    nan.channels[1].pixels[5] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(problem(nan), "channel G of the test picture has a value that is not finite, at pixel 5 of its data window");
    Image bare = good;
    std::erase_if(bare.channels, [](const Channel& channel) { return channel.name == "variance.B"; });
    EXPECT_EQ(problem(bare), "the test picture has no channel variance.B");
}

TEST(Statistics, students_distribution_is_used_where_replicates_are_few)
{
    // One pixel region: two replicates each, so nu = (va + vb)^2 / (va^2 + vb^2) = 2 for va = vb. With D = 2, va = vb = 1: t = sqrt(2). The two-sided
    // probability for nu = 2 is 1 - t / sqrt(2 + t^2) = 1 - sqrt(2) / 2 = 0.292893; a normal distribution would give 0.157.
    Image a;
    a.width = a.height = 1;
    a.data = {0, 1, 0, 1};
    for (const char* name : {"R", "G", "B", "variance.R", "variance.G", "variance.B"}) a.channels.push_back({name, {1.0f}});
    a.metadata["hoodoo:replicates"] = 2;
    Image b = a;
    for (int c = 0; c < 3; ++c) b.channels[c].pixels[0] = 3.0f;
    const RegionTest test = compare_statistically(a, b).regions.front();
    EXPECT_NEAR(test.t, std::sqrt(2.0), 1e-5);
    EXPECT_NEAR(test.probability, 1.0 - std::sqrt(0.5), 1e-5);
}
