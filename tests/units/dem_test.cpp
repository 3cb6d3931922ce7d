// Height images and elevation models: round trips, resampling, degrees, and files that lie about themselves.
#include "terrain/io/dem.h"

#include "terrain/error.h"
#include "terrain/io/npz.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace hoodoo
{
namespace
{

class Files : public ::testing::Test
{
protected:
    Files()
        : folder_(std::filesystem::temp_directory_path() /
                  ("hoodoo_dem_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name())))
    {
        std::filesystem::create_directories(folder_);
    }
    ~Files() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string write(const std::string& name, const std::string& bytes) const
    {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }

private:
    std::filesystem::path folder_;
};

using HeightImages = Files;
using Dem = Files;

std::string refusal(auto&& action)
{
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::file);
        return error.what();
    }
    return "accepted";
}

HeightImage ramp(int width, int height)
{
    HeightImage image{width, height, 2.5, {}};
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) image.values.push_back(static_cast<float>(100 + 3 * column - 0.5 * row));
    }
    return image;
}

TEST_F(HeightImages, come_back_as_they_were_written)
{
    const HeightImage image = ramp(7, 5);
    write_height_image(path("a.exr"), image);
    const HeightImage back = read_height_image(path("a.exr"));
    EXPECT_EQ(back.width, 7);
    EXPECT_EQ(back.height, 5);
    EXPECT_EQ(back.cell, 2.5);
    EXPECT_EQ(back.values, image.values);
}

TEST_F(HeightImages, that_hold_no_numbers_or_no_image_are_refused)
{
    HeightImage image = ramp(4, 4);
    image.values[6] = std::nanf("");
    write_height_image(path("nan.exr"), image);
    EXPECT_NE(refusal([&] { read_height_image(path("nan.exr")); }).find("at column 2, row 1"), std::string::npos);
    EXPECT_NE(refusal([&] { read_height_image(path("absent.exr")); }), "accepted");
    EXPECT_NE(refusal([&] { read_height_image(write("empty.png", "")); }), "accepted");
    EXPECT_NE(refusal([&] { read_height_image(write("junk.tif", std::string(300, 'x'))); }), "accepted");
    EXPECT_NE(refusal([&] { read_height_image(std::filesystem::temp_directory_path().string()); }), "accepted");
}

TEST_F(HeightImages, cut_short_anywhere_are_refused_or_read_but_never_crash)
{
    write_height_image(path("whole.exr"), ramp(16, 16));
    std::ifstream file(path("whole.exr"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (std::size_t k = 0; k < 40; ++k) {
        const std::string cut = write("cut.exr", bytes.substr(0, bytes.size() * k / 40));
        EXPECT_NE(refusal([&] { read_height_image(cut); }), "accepted") << k;
    }
}

TEST_F(HeightImages, that_promise_more_than_their_file_can_hold_are_refused)
{
    // A Targa header of 18 bytes: 60000 x 60000 grey pixels, run-length coded. And 30000 x 4000, which would pass the limit of samples.
    const auto targa = [](int w, int h) {
        std::string bytes(18, '\0');
        bytes[2] = 11;
        bytes[12] = static_cast<char>(w & 255), bytes[13] = static_cast<char>(w >> 8), bytes[14] = static_cast<char>(h & 255),
        bytes[15] = static_cast<char>(h >> 8);
        bytes[16] = 8;
        return bytes;
    };
    EXPECT_NE(refusal([&] { read_height_image(write("huge.tga", targa(60000, 60000))); }), "accepted");
    EXPECT_NE(refusal([&] { read_height_image(write("bomb.tga", targa(30000, 4000))); }).find("promises more than its file can hold"),
              std::string::npos);
}

TEST(Resampling, keeps_ramps_and_interpolates_the_old_pixels)
{
    // Keys' kernel reproduces parabolas away from the edges; half-pixel steps put every new pixel at -1/4 or +1/4 of an old one.
    const HeightImage image = ramp(12, 10), fine = resample(image, 0.5, 0.5), same = resample(image, 1.0, 1.0);
    ASSERT_EQ(fine.width, 24);
    ASSERT_EQ(fine.height, 20);
    EXPECT_EQ(same.values, image.values);
    for (int row = 6; row < 14; ++row) {
        for (int column = 6; column < 18; ++column) {
            EXPECT_NEAR(fine.at(column, row), 100 + 3 * (0.5 * (column + 0.5) - 0.5) - 0.5 * (0.5 * (row + 0.5) - 0.5), 1e-4);
        }
    }
    // Shrinking averages: a checkerboard becomes its mean.
    HeightImage board{32, 32, 1.0, {}};
    for (int k = 0; k < 32 * 32; ++k) board.values.push_back(static_cast<float>((k + k / 32) % 2));
    const HeightImage small = resample(board, 4.0, 4.0);
    EXPECT_NEAR(small.at(4, 4), 0.5f, 1e-3);
}

TEST(Degrees, have_the_lengths_of_the_ellipsoid)
{
    // Published lengths of a degree on WGS 84: at the equator 111.320 and 110.574 km, at 45 degrees 78.847 and 111.132 km, at 60 degrees 55.800 and
    // 111.412 km.
    EXPECT_NEAR(metres_in_a_degree(0)[0], 111320, 1);
    EXPECT_NEAR(metres_in_a_degree(0)[1], 110574, 1);
    EXPECT_NEAR(metres_in_a_degree(45)[0], 78847, 1);
    EXPECT_NEAR(metres_in_a_degree(45)[1], 111132, 1);
    EXPECT_NEAR(metres_in_a_degree(-60)[0], 55800, 1);
    EXPECT_NEAR(metres_in_a_degree(-60)[1], 111412, 1);
}

const std::string kJacksboro = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz";

TEST_F(Dem, of_the_jacksboro_fault_becomes_square_metres)
{
    if (!std::filesystem::exists(kJacksboro)) GTEST_SKIP() << "needs python-matplotlib-data";
    // 344 x 403 pixels of 1/1200 degree at 36.59 degrees north: 74.56 m wide, 92.48 m high; heights 236 to 1076 m.
    const HeightImage whole = import_dem(kJacksboro, {});
    EXPECT_EQ(whole.width, 403);
    EXPECT_NEAR(whole.cell, 74.56, 0.05);
    EXPECT_NEAR(whole.height, 344 * 92.48 / 74.56, 1.0);
    const auto [low, high] = std::minmax_element(whole.values.begin(), whole.values.end());
    EXPECT_NEAR(*low, 236, 12);
    EXPECT_NEAR(*high, 1076, 12);
    // Row 0 is the north: the archive's first row, unless it is flipped.
    DemOptions raw;
    raw.cell_x = raw.cell_y = 90.0;
    const HeightImage plain = import_dem(kJacksboro, raw);
    EXPECT_EQ(plain.height, 344);
    raw.flip = true;
    raw.subset = {10, 20, 0, 1};
    const HeightImage south = import_dem(kJacksboro, raw);
    EXPECT_EQ(south.width, 10);
    for (int k = 0; k < 10; ++k) EXPECT_EQ(south.at(k, 0), plain.at(10 + k, 343));
    raw.resample_to = 30.0;
    EXPECT_EQ(import_dem(kJacksboro, raw).width, 30);
    DemOptions wrong;
    wrong.array = "elevatoin";
    EXPECT_NE(refusal([&] { import_dem(kJacksboro, wrong); }).find("elevation"), std::string::npos);
}

TEST_F(Dem, archives_that_are_damaged_are_refused)
{
    if (!std::filesystem::exists(kJacksboro)) GTEST_SKIP() << "needs python-matplotlib-data";
    std::ifstream file(kJacksboro, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    for (std::size_t k = 0; k < 20; ++k) {
        const std::string cut = write("cut.npz", bytes.substr(0, bytes.size() * k / 20));
        EXPECT_NE(refusal([&] { import_dem(cut, {}); }), "accepted") << k;
    }
    // Any single byte may change in the directory or in a header: an answer or an Error, never a crash.
    for (std::size_t k = 1; k < 400; ++k) {
        std::string flipped = bytes;
        flipped[k < 200 ? k : flipped.size() - k] ^= 0x55;
        const std::string damaged = write("flip.npz", flipped);
        try {
            NpzFile(damaged).read("elevation");
        } catch (const Error&) {
        }
    }
}

}  // namespace
}  // namespace hoodoo
