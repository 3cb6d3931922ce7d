// Law: a picture is a function of the scene and the seed. How it was cut into tiles, shared among threads or cropped does not change a bit of it.
#include "renderer/film/write.h"
#include "renderer/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <filesystem>

using namespace hoodoo;

namespace
{

/// "" if `part` has the bits of `full` in its own window and says so in its windows; else what differs first.
std::string differs(const Image& full, const Image& part)
{
    if (part.width != full.width || part.height != full.height) return "the display windows differ";
    if (part.channels.size() != full.channels.size()) return "the channels differ";
    const PixelBounds &f = full.data, &p = part.data;
    if (p.x0 < f.x0 || p.x1 > f.x1 || p.y0 < f.y0 || p.y1 > f.y1 || p.width() < 1 || p.height() < 1) return "the part is no part";
    for (std::size_t c = 0; c < full.channels.size(); ++c) {
        if (part.channels[c].name != full.channels[c].name) return "the channels differ";
        for (int y = p.y0; y < p.y1; ++y)
            for (int x = p.x0; x < p.x1; ++x) {
                const float a = full.channels[c].pixels[static_cast<std::size_t>(y - f.y0) * f.width() + (x - f.x0)];
                const float b = part.channels[c].pixels[static_cast<std::size_t>(y - p.y0) * p.width() + (x - p.x0)];
                if (std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b))
                    return part.channels[c].name + " differs at " + std::to_string(x) + "," + std::to_string(y);
            }
    }
    return {};
}

class Pictures : public ::testing::Test
{
protected:
    static void SetUpTestSuite()
    {
        SceneOverrides small;
        small.sets = {{"film.width", "48"}, {"film.height", "27"}, {"render.spp", "8"}, {"render.replicates", "1"}};
        scene_ = new LoadedScene(load_scene(HOODOO_SOURCE_DIR "/tests/images/arch/scene.toml", false, small));
        full_ = new Image(render(*scene_, base()));
    }
    static void TearDownTestSuite()
    {
        delete full_;
        delete scene_;
    }
    static RenderOptions base()
    {
        RenderOptions options;
        options.measurements = false;
        options.threads = 1;
        return options;
    }
    static RenderOptions cropped(PixelBounds bounds)
    {
        RenderOptions options = base();
        options.pixel_bounds = bounds;
        return options;
    }
    static LoadedScene* scene_;
    static Image* full_;
};

LoadedScene* Pictures::scene_ = nullptr;
Image* Pictures::full_ = nullptr;

}  // namespace

TEST_F(Pictures, have_the_same_bits_for_any_threads_and_tiles)
{
    struct Arrangement {
        int threads, tile;
    };
    for (const auto& [threads, tile] : {Arrangement{2, 32}, Arrangement{3, 7}, Arrangement{1, 1}, Arrangement{2, 1000}}) {
        RenderOptions options = base();
        options.threads = threads;
        options.tile_size = tile;
        const Image other = render(*scene_, options);
        EXPECT_EQ(differs(*full_, other), "") << threads << " threads, tiles of " << tile;
        EXPECT_EQ(other.metadata, full_->metadata);
    }
}

TEST_F(Pictures, have_the_same_bits_in_every_crop)
{
    for (const PixelBounds& bounds : {PixelBounds{0, 1, 0, 1}, PixelBounds{13, 30, 5, 22}, PixelBounds{47, 48, 0, 27}, PixelBounds{0, 48, 26, 27}})
        EXPECT_EQ(differs(*full_, render(*scene_, cropped(bounds))), "") << bounds.x0 << "," << bounds.y0;
}

TEST_F(Pictures, in_neighbouring_crop_windows_cover_the_full_one_once)
{
    // Windows given as shares: 48 / 3 = 16 and 27 / 2 = 13.5, which rounds up to 14 for both neighbours.
    std::int64_t pixels = 0;
    for (const double x : {0.0, 1.0, 2.0})
        for (const double y : {0.0, 1.0}) {
            RenderOptions options = base();
            options.crop_window = {x / 3.0, (x + 1.0) / 3.0, y / 2.0, (y + 1.0) / 2.0};
            const Image part = render(*scene_, options);
            EXPECT_EQ(differs(*full_, part), "");
            pixels += static_cast<std::int64_t>(part.data.width()) * part.data.height();
        }
    EXPECT_EQ(pixels, 48 * 27);
}

TEST_F(Pictures, of_mutants_are_found_to_differ)
{
    const PixelBounds bounds{13, 30, 5, 22};
    // A crop that counts its pixels from its own corner sees the light of another place.
    Image shifted = render(*scene_, cropped({14, 31, 5, 22}));
    shifted.data = bounds;
    EXPECT_NE(differs(*full_, shifted), "");
    // Another seed has other noise.
    RenderOptions reseeded = cropped(bounds);
    reseeded.seed = 99;
    EXPECT_NE(differs(*full_, render(*scene_, reseeded)), "");
    // One sample more.
    RenderOptions longer = cropped(bounds);
    longer.spp = 9;
    EXPECT_NE(differs(*full_, render(*scene_, longer)), "");
    // One bit in one channel of one pixel.
    Image flipped = render(*scene_, cropped(bounds));
    float& value = flipped.channels[2].pixels[40];
    value = std::nextafter(value, 1e9f);
    EXPECT_EQ(differs(*full_, flipped), "B differs at 19,7");  // pixel 40 of a row of 17: 13 + 40 % 17, 5 + 40 / 17
    // A window that is not the asked one.
    flipped.data.x1 = 49;
    EXPECT_EQ(differs(*full_, flipped), "the part is no part");
}

TEST_F(Pictures, survive_their_files)
{
    const std::string name = (std::filesystem::path(::testing::TempDir()) / "hoodoo_picture_law.exr").string();
    const Image part = render(*scene_, cropped({13, 30, 5, 22}));
    write_exr(part, name, ExrPrecision::full);
    Image found = read_exr(name);
    std::filesystem::remove(name);
    std::vector<Channel> sorted;
    for (const Channel& channel : full_->channels) sorted.push_back(*found.find(channel.name));
    found.channels = sorted;
    EXPECT_EQ(differs(*full_, found), "");
    EXPECT_EQ(found.metadata.at("hoodoo:sceneHash"), full_->metadata.at("hoodoo:sceneHash"));
    for (const auto& [fact, value] : part.metadata) EXPECT_EQ(found.metadata.at(fact), value) << fact;
}

TEST_F(Pictures, that_are_cancelled_are_empty)
{
    std::atomic<bool> cancel{true};
    RenderOptions options = base();
    options.cancel = &cancel;
    const Image image = render(*scene_, options);
    EXPECT_TRUE(image.channels.empty());
    EXPECT_EQ(image.width, 0);
}

TEST_F(Pictures, that_cannot_be_are_refused)
{
    const auto refusal = [&](const RenderOptions& options) -> std::string {
        try {
            render(*scene_, options);
            return "none";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::scene);
            return error.what();
        }
    };
    EXPECT_EQ(refusal(cropped({0, 49, 0, 27})),
              "the pixel bounds must be a part of the picture, expected 0 <= x0 < x1 <= 48 and 0 <= y0 < y1 <= 27, got 0,49,0,27");
    RenderOptions both = cropped({0, 1, 0, 1});
    both.crop_window = {0.0, 1.0, 0.0, 1.0};
    EXPECT_EQ(refusal(both), "give either a crop window or pixel bounds, not both");
    RenderOptions outside = base();
    outside.crop_window = {0.5, 1.5, 0.0, 1.0};
    EXPECT_EQ(refusal(outside), "the crop window must be a part of the picture, expected 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1, got 0.5,1.5,0,1");
    RenderOptions nothing = base();
    nothing.spp = 0;
    EXPECT_EQ(refusal(nothing), "a picture needs at least one pixel, one sample and one replicate");
    EXPECT_THROW(check_picture_name("a.jpg"), Error);
    EXPECT_THROW(check_picture_name("a.exr/b"), Error);
    EXPECT_NO_THROW(check_picture_name("a.b/c.png"));
}

TEST_F(Pictures, quick_are_a_quarter_in_all_they_cost)
{
    RenderOptions options = base();
    options.quick = true;
    const Image image = render(*scene_, options);
    EXPECT_EQ(image.width, 12);
    EXPECT_EQ(image.height, 6);
    EXPECT_EQ(std::get<int>(image.metadata.at("hoodoo:spp")), 2);
    options.pixel_bounds = PixelBounds{13, 30, 5, 22};
    const PixelBounds data = render(*scene_, options).data;
    EXPECT_EQ(data.x0, 3);  // what covers the asked pixels: floor(13 / 4), ceil(30 / 4)
    EXPECT_EQ(data.x1, 8);
    EXPECT_EQ(data.y0, 1);
    EXPECT_EQ(data.y1, 6);
}
