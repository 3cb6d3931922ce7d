// The film's means, its variance of the pixel mean, and what it does with samples that are no numbers. Every expected number is derived beside it.
#include "renderer/film/film.h"
#include "terrain/error.h"
#include "terrain/math/hash.h"

#include <gtest/gtest.h>

#include <limits>

using namespace hoodoo;

namespace
{

FilmLayout layout_of(int samples, int replicates = 1)
{
    FilmLayout layout;
    layout.width = 4;
    layout.height = 3;
    layout.data = {1, 3, 1, 3};
    layout.samples = samples;
    layout.replicates = replicates;
    layout.materials = {"sand", "bedrock"};
    return layout;
}

PixelSample grey(float radiance)
{
    PixelSample sample;
    sample.radiance = Vec3f(radiance);
    sample.z = std::numeric_limits<float>::infinity();
    return sample;
}

PixelSample hit(float z, std::uint32_t object, const Vec3f& normal, std::span<const float> materials)
{
    PixelSample sample = grey(1.0f);
    sample.alpha = 1.0f;
    sample.z = z;
    sample.object = object;
    sample.instance = object + 10;
    sample.shading_normal = sample.geometric_normal = normal;
    sample.position = Vec3f(z, 0, 0);
    sample.albedo = Vec3f(0.5f);
    sample.materials = materials;
    return sample;
}

/// Value of the channel at the data window's first pixel.
float first(const Film& film, const std::string& name)
{
    return film.develop().find(name)->pixels[0];
}

/// A film whose first pixel took these samples.
Film exposed(const FilmLayout& layout, const std::vector<float>& radiances, int per_replicate = 1 << 20)
{
    Film film(layout);
    PixelSums sums(film.layout());
    for (std::size_t i = 0; i < radiances.size(); ++i) {
        sums.add(grey(radiances[i]));
        if ((i + 1) % per_replicate == 0) sums.end_replicate();
    }
    film.record(1, 1, sums);
    return film;
}

std::vector<float> repeated(std::initializer_list<std::pair<int, float>> runs)
{
    std::vector<float> values;
    for (const auto& [count, value] : runs) values.insert(values.end(), count, value);
    return values;
}

}  // namespace

TEST(Film, means_are_over_samples_for_light_and_over_hits_for_surfaces)
{
    Film film(layout_of(4));
    PixelSums sums(film.layout());
    const std::array<float, 2> sand = {1.0f, 0.0f}, both = {0.5f, 0.5f};
    sums.add(hit(8.0f, 2, Vec3f(0, 0, 1), sand));
    sums.add(hit(4.0f, 3, Vec3f(1, 0, 0), both));
    PixelSample sky = grey(6.0f);
    sky.cost = 20.0f;
    sums.add(sky);
    sums.add(grey(0.0f));
    film.record(1, 1, sums);
    EXPECT_EQ(first(film, "R"), 2.0f);  // (1 + 1 + 6 + 0) / 4
    EXPECT_EQ(first(film, "A"), 0.5f);
    EXPECT_EQ(first(film, "N.Z"), 0.5f);  // of two hits, not of four samples
    EXPECT_EQ(first(film, "P.X"), 6.0f);
    EXPECT_EQ(first(film, "albedo.G"), 0.5f);
    EXPECT_EQ(first(film, "material.sand"), 0.75f);
    EXPECT_EQ(first(film, "material.bedrock"), 0.25f);
    EXPECT_EQ(first(film, "cost.Y"), 5.0f);
    EXPECT_EQ(first(film, "samples.Y"), 4.0f);
}

TEST(Film, depth_and_ids_are_those_of_the_nearest_sample)
{
    Film film(layout_of(3));
    PixelSums sums(film.layout());
    sums.add(hit(8.0f, 2, Vec3f(0, 0, 1), {}));
    sums.add(hit(4.0f, 3, Vec3f(0, 0, 1), {}));
    sums.add(hit(9.0f, 1, Vec3f(0, 0, 1), {}));
    film.record(1, 1, sums);
    EXPECT_EQ(first(film, "Z"), 4.0f);
    EXPECT_EQ(first(film, "objectId"), 3.0f);
    EXPECT_EQ(first(film, "instanceId"), 13.0f);
}

TEST(Film, a_pixel_that_sees_only_sky_has_infinite_depth_and_no_id)
{
    const Film film = exposed(layout_of(3), {1.0f, 2.0f, 3.0f});
    EXPECT_EQ(first(film, "Z"), std::numeric_limits<float>::infinity());
    for (const char* name : {"A", "objectId", "instanceId", "N.X", "N.Z", "P.X", "albedo.R", "material.sand"})
        EXPECT_EQ(first(film, name), 0.0f) << name;
}

TEST(Film, variance_between_replicates_is_that_of_their_means_over_their_number)
{
    // Replicates 1,1,1,1 and 3,3,3,3: means 1 and 3, their sample variance 2, over 2 replicates: 1.
    EXPECT_FLOAT_EQ(first(exposed(layout_of(8, 2), repeated({{4, 1.0f}, {4, 3.0f}}), 4), "variance.R"), 1.0f);
}

TEST(Film, variance_between_blocks_weighs_a_short_last_block_by_its_samples)
{
    // Blocks 16 x 1, 16 x 2, 8 x 4: mean 80 / 40 = 2; sum n (m - 2)^2 = 16 + 0 + 32 = 48; over (3 - 1) * 40: 0.6.
    EXPECT_FLOAT_EQ(first(exposed(layout_of(40), repeated({{16, 1.0f}, {16, 2.0f}, {8, 4.0f}})), "variance.G"), 0.6f);
}

TEST(Film, variance_of_fewer_than_two_blocks_is_between_samples)
{
    // Samples 1, 2, 3: sample variance 1, over 3.
    EXPECT_FLOAT_EQ(first(exposed(layout_of(3), {1.0f, 2.0f, 3.0f}), "variance.B"), 1.0f / 3.0f);
}

TEST(Film, variance_of_a_single_sample_is_unknown)
{
    EXPECT_EQ(first(exposed(layout_of(1), {1.0f}), "variance.R"), std::numeric_limits<float>::infinity());
}

TEST(Film, variance_of_independent_samples_is_right_on_average)
{
    // Uniform numbers have variance 1/12, a mean of 64 has 1/768. With B batch means an estimate has relative variance 2 / (B - 1) (normal means), so
    // the mean of 4000 estimates is within 5 sqrt(2 / (B - 1) / 4000) of it except once in 2e6: 6.5% for 4 blocks, 4.2% for 8 replicates. An estimate
    // that forgets the - 1 of B - 1 would be 25% or 12.5% too low.
    for (const int replicates : {1, 8}) {
        FilmLayout layout = layout_of(64, replicates);
        Film film(layout);
        const int pixels = 4000, batches = replicates == 1 ? 4 : replicates;
        double mean = 0.0;
        for (int pixel = 0; pixel < pixels; ++pixel) {
            PixelSums sums(film.layout());
            for (int i = 0; i < 64; ++i) {
                sums.add(grey(static_cast<float>(unit_real(hash_cell(7, pixel, i, replicates)))));
                if ((i + 1) % (64 / replicates) == 0) sums.end_replicate();
            }
            film.record(1, 1, sums);
            mean += first(film, "variance.R") / pixels;
        }
        EXPECT_NEAR(mean * 768.0, 1.0, 5.0 * std::sqrt(2.0 / (batches - 1) / pixels)) << replicates;
    }
}

TEST(Film, samples_that_are_no_numbers_are_dropped_and_counted)
{
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    Film film(layout_of(4));
    for (const auto& [x, y] : {std::pair(2, 2), std::pair(2, 1)}) {
        PixelSums sums(film.layout());
        sums.add(grey(2.0f));
        sums.add(grey(nan));
        sums.add(grey(infinity));
        PixelSample bad_normal = hit(1.0f, 1, Vec3f(0, nan, 0), {});
        sums.add(bad_normal);
        film.record(x, y, sums);
    }
    EXPECT_EQ(film.dropped_samples(), 6u);
    EXPECT_EQ(film.first_dropped_pixel(), Vec2i(2, 1));
    const Image image = film.develop();
    EXPECT_EQ(image.find("R")->pixels[1], 2.0f);  // (2, 1) is the second pixel of the data window
    EXPECT_EQ(image.find("samples.Y")->pixels[1], 1.0f);
    EXPECT_EQ(image.find("A")->pixels[1], 0.0f);
}

TEST(Film, a_pixel_without_any_good_sample_is_black_and_its_variance_unknown)
{
    const Film film = exposed(layout_of(2), {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN()});
    EXPECT_EQ(first(film, "R"), 0.0f);
    EXPECT_EQ(first(film, "samples.Y"), 0.0f);
    EXPECT_EQ(first(film, "variance.R"), std::numeric_limits<float>::infinity());
    EXPECT_EQ(exposed(layout_of(2), {1.0f, 1.0f}).first_dropped_pixel(), Vec2i(-1, -1));
}

TEST(Film, blocks_of_sixteen_are_summed_apart)
{
    // 2^24 + 1 is no float but a double, and 2^53 + 1 is no double: in one running sum every 1 after 2^53 would vanish. In blocks of 16 the first
    // block loses its fifteen and the second adds 16; a last block of -2^53 leaves 16 in all, over 33 samples.
    std::vector<float> values = repeated({{1, 0x1p53f}, {31, 1.0f}, {1, -0x1p53f}});
    EXPECT_FLOAT_EQ(first(exposed(layout_of(33), values), "R"), 16.0f / 33.0f);
}

TEST(Film, bounds_outside_the_picture_are_refused)
{
    for (const PixelBounds bounds : {PixelBounds{-1, 2, 0, 2}, PixelBounds{0, 5, 0, 2}, PixelBounds{2, 2, 0, 2}, PixelBounds{0, 2, 2, 1}}) {
        FilmLayout layout = layout_of(1);
        layout.data = bounds;
        EXPECT_THROW(Film{layout}, Error);
    }
    FilmLayout layout = layout_of(1);
    layout.data = {0, 5, 0, 2};
    try {
        Film film(layout);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::scene);
        EXPECT_STREQ(error.what(), "the pixel bounds must be a part of the picture, expected 0 <= x0 < x1 <= 4 and 0 <= y0 < y1 <= 3, got 0,5,0,2");
    }
}
