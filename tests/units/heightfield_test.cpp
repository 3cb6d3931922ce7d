// Height fields: golden heights, samples kept as they are stored, places on the earth, gaps, and files that lie about themselves.

#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/fields/grid_fill.h"
#include "terrain/io/height_file.h"
#include "tests/support/tiny_tiff.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace hoodoo
{
namespace
{

using testing::TinyTiff;

class Heightfield : public ::testing::Test
{
protected:
    Heightfield() : folder_(std::filesystem::temp_directory_path() / fmt::format("hoodoo_heightfield_{}", ::getpid()))
    {
        std::filesystem::create_directories(folder_);
    }
    ~Heightfield() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    template <class T>
    std::string image(const std::string& name, int width, int height, OIIO::TypeDesc type, const std::vector<T>& samples, int tile = 0) const
    {
        OIIO::ImageSpec spec(width, height, 1, type);
        spec.tile_width = spec.tile_height = tile;
        const auto out = OIIO::ImageOutput::create(path(name));
        EXPECT_TRUE(out && out->open(path(name), spec));
        EXPECT_TRUE(out->write_image(type, samples.data()));
        EXPECT_TRUE(out->close());
        return path(name);
    }

    static Shape make(const std::string& text)
    {
        SceneBudget budget;
        std::vector<Problem> problems;
        const Node table = parse_toml(text, "<text>", budget, problems);
        const CatalogueEntry* row = find_in_catalogue("heightfield");
        const Values values = check(row->schema, table, problems);
        if (!problems.empty()) throw Error(ErrorKind::scene, problems);
        return row->make(values, BuildContext{});
    }
    static std::string refusal(const std::string& text)
    {
        try {
            make(text);
        } catch (const Error& error) {
            return error.problems()[0].text().substr(0, error.problems()[0].text().find('\n'));
        }
        return "accepted";
    }

private:
    std::filesystem::path folder_;
};

const Height& height_of(const Shape& shape)
{
    return *std::get<std::unique_ptr<Surface>>(shape)->height();
}

TEST_F(Heightfield, heights_are_those_of_the_two_triangles_of_the_golden_grid)
{
    // b_galin.json: z[i][j], i along x, j along y, over [0, 2] x [0, 6].
    const auto golden = nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/b_galin.json"))["height"];
    std::vector<float> rows;
    for (int j = 3; j >= 0; --j)
        for (int i = 0; i < 3; ++i) rows.push_back(golden["z"][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<float>());
    const Shape shape = make(fmt::format("file = \"{}\"\ncell = [1.0, 2.0]\n", image("golden.tif", 3, 4, OIIO::TypeDesc::FLOAT, rows)));
    for (const auto& point : golden["pts"]) {
        const Vec2d p(point["p"][0].get<double>(), point["p"][1].get<double>());
        EXPECT_NEAR(height_of(shape).height(p), point["triangle"].get<double>(), 1e-12) << p.x << ", " << p.y;
    }
}

TEST_F(Heightfield, samples_stay_as_they_are_stored)
{
    const std::vector<std::uint16_t> words{0, 1, 65535, 40000, 12345, 7};
    const HeightFile file(image("words.png", 3, 2, OIIO::TypeDesc::UINT16, words));
    ASSERT_EQ(file.info().type, SampleType::u16);
    HeightGrid grid({}, 3, 2, SampleType::u16);
    file.read(grid, {});
    // Row 0 of the file is the north.
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column) EXPECT_EQ(grid.sample(column, 1 - row), words[static_cast<std::size_t>(3 * row + column)]);
    EXPECT_EQ(grid.whole().lo, 0.0f);
    EXPECT_EQ(grid.whole().hi, 65535.0f);
    // One block of 17 x 17 nodes, 2 bytes each.
    EXPECT_EQ(grid.sample_bytes(), 2u * 17 * 17);
    EXPECT_EQ(HeightFile(image("bytes.png", 3, 2, OIIO::TypeDesc::UINT8, std::vector<std::uint8_t>(6))).info().type, SampleType::u8);
    EXPECT_EQ(HeightFile(image("signed.tif", 3, 2, OIIO::TypeDesc::INT16, std::vector<std::int16_t>(6))).info().type, SampleType::i16);
    EXPECT_EQ(HeightFile(image("half.exr", 3, 2, OIIO::TypeDesc::FLOAT, std::vector<float>(6))).info().type, SampleType::f32);
}

TEST_F(Heightfield, tiles_and_rows_of_a_file_give_the_same_grid)
{
    // Sizes that no tile and no block divides.
    std::vector<std::uint16_t> samples;
    for (int k = 0; k < 77 * 53; ++k) samples.push_back(static_cast<std::uint16_t>(k * 7919));
    HeightGrid tiled({}, 77, 53, SampleType::u16), rows({}, 77, 53, SampleType::u16);
    const HeightFile file(image("tiled.tif", 77, 53, OIIO::TypeDesc::UINT16, samples, 32));
    ASSERT_EQ(file.info().tile_width, 32);
    file.read(tiled, {});
    HeightFile(image("rows.tif", 77, 53, OIIO::TypeDesc::UINT16, samples)).read(rows, {});
    for (int j = 0; j < 53; ++j) {
        for (int i = 0; i < 77; ++i) {
            ASSERT_EQ(tiled.sample(i, j), samples[static_cast<std::size_t>((52 - j) * 77 + i)]) << i << ", " << j;
            ASSERT_EQ(rows.sample(i, j), tiled.sample(i, j)) << i << ", " << j;
        }
    }
}

TEST_F(Heightfield, white_and_height_scale_say_how_high_it_is)
{
    const std::string file = image("two.png", 2, 2, OIIO::TypeDesc::UINT16, std::vector<std::uint16_t>{65535, 0, 0, 13107});
    // 13107 = 65535 / 5, in the south-east.
    EXPECT_NEAR(height_of(make(fmt::format("file = \"{}\"\ncell = [10.0]\nwhite = 50.0\n", file))).height({10.0, 0.0}), 10.0, 1e-12);
    EXPECT_NEAR(height_of(make(fmt::format("file = \"{}\"\ncell = [10.0]\nheight_scale = 0.01\norigin = [5, 5, -1]\n", file))).height({15.0, 5.0}),
                130.07, 1e-12);
    EXPECT_EQ(refusal(fmt::format("file = \"{}\"\ncell = [10.0]\n", file)),
              "<text>:1:8: how high this image is nobody says, expected white (metres) or height_scale (metres a step), got unsigned integers");
    EXPECT_EQ(refusal(fmt::format("file = \"{}\"\nwhite = 9.0\n", file)),
              "<text>:1:8: how large its pixels are nobody says, expected cell (metres), or a file with a projected coordinate system");
    EXPECT_EQ(refusal(fmt::format("file = \"{}\"\ncell = [1.0]\nwhite = 9.0\nheight_scale = 1.0\n", file)),
              "<text>:3:9: white and height_scale say the same thing twice, expected one of them");
    EXPECT_EQ(refusal(fmt::format("file = \"{}\"\ncell = [1.0]\nwhite = 9.0\nsize = [4, 2]\n", file)),
              "<text>:4:8: the file has another size, expected 4 x 2 samples, got 2 x 2");
    const std::string floats = image("floats.tif", 2, 2, OIIO::TypeDesc::FLOAT, std::vector<float>(4));
    EXPECT_EQ(refusal(fmt::format("file = \"{}\"\ncell = [1.0]\nwhite = 9.0\n", floats)),
              "<text>:3:9: this file has no white: its numbers are heights, expected height_scale, or neither");
}

TEST_F(Heightfield, missing_heights_are_counted_placed_and_filled)
{
    std::vector<float> samples(20, 4.0f);
    samples[7] = std::nanf("");   // column 2, row 1
    samples[13] = -9999.0f;       // column 3, row 2
    samples[12] = std::nanf("");  // column 2, row 2
    const std::string head = fmt::format("file = \"{}\"\ncell = [1.0]\nno_data = -9999\n", image("gaps.tif", 5, 4, OIIO::TypeDesc::FLOAT, samples));
    EXPECT_EQ(refusal(head),
              "<text>:1:8: heights are missing in the file, expected a height everywhere, or fill = \"around\" or \"level\", got 3 of 20 "
              "samples without one, the first at column 2, row 1");
    EXPECT_EQ(height_of(make(head + "fill = \"around\"\n")).height({3.0, 1.0}), 4.0);
    EXPECT_EQ(height_of(make(head + "fill = \"level\"\nfill_height = 1.5\n")).height({3.0, 1.0}), 1.5);
    const std::string none = fmt::format("file = \"{}\"\ncell = [1.0]\nfill = \"around\"\n",
                                         image("none.tif", 5, 4, OIIO::TypeDesc::FLOAT, std::vector<float>(20, std::nanf(""))));
    EXPECT_EQ(refusal(none),
              "<text>:1:8: heights are missing in the file, expected any height, got 20 of 20 samples without one, the first at column "
              "0, row 0");
}

TEST(GridFill, grows_rings_of_means_from_the_rim)
{
    // A gap of 3 x 3 in a slope h = column. Ring 1: corner (2,2) sees 5 known neighbours 1,1,1,2,3 -> 1.6; edge (3,2) sees 2,3,4 -> 3; the middle is
    // ring 2: the mean of its 8 neighbours, by symmetry about column 3 that is 3.
    HeightGrid grid({}, 7, 7, SampleType::f32);
    for (int j = 0; j < 7; ++j)
        for (int i = 0; i < 7; ++i) grid.set(i, j, i >= 2 && i <= 4 && j >= 2 && j <= 4 ? std::nan("") : i);
    fill_missing_from_around(grid, std::nullopt);
    EXPECT_FLOAT_EQ(static_cast<float>(grid.sample(2, 2)), 1.6f);
    EXPECT_FLOAT_EQ(static_cast<float>(grid.sample(3, 2)), 3.0f);
    EXPECT_NEAR(grid.sample(3, 3), 3.0, 1e-6);
    EXPECT_EQ(find_missing(grid, std::nullopt).count, 0u);
}

// -- Files that are wrong -----------------------------------------------------------------------------------------------------------------

TEST_F(Heightfield, refuses_what_is_no_image_and_what_is_too_small)
{
    const std::string text = path("text.tif");
    std::ofstream(text) << "no image";
    EXPECT_THROW(HeightFile{text}, Error);
    const std::string thin = image("thin.tif", 5, 1, OIIO::TypeDesc::FLOAT, std::vector<float>(5));
    try {
        HeightFile file(thin);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.problems()[0].what + "|" + error.problems()[0].expected + "|" + error.problems()[0].got,
                  "the height image is too small|at least 2 x 2 samples, which make one cell|5 x 1");
    }
    EXPECT_THROW(HeightFile{path("absent.tif")}, Error);
}

TEST_F(Heightfield, knows_cell_place_and_gaps_from_the_tags_of_a_geotiff)
{
    TinyTiff tiff(4, 3, 12);
    tiff.values<double>(33550, 12, {30.0, 20.0, 0.0});
    tiff.values<double>(33922, 12, {0, 0, 0, 500000.0, 4000000.0, 0});
    tiff.values<std::uint16_t>(34735, 3, {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32613});
    tiff.values<char>(42113, 2, {'5', '\0', ' ', ' ', '\0'});
    std::ofstream(path("geo.tif"), std::ios::binary) << tiff.bytes();
    const HeightFile file(path("geo.tif"));
    EXPECT_EQ(file.info().cell, Vec2d(30.0, 20.0));
    EXPECT_EQ(file.info().place.system, "EPSG:32613");
    EXPECT_EQ(file.info().place.map_text(), "500000 30 0 4000000 0 -20");
    EXPECT_EQ(file.info().no_data, 5.0);
    // Cell and scale come from the file; sample 5 is a gap; signed numbers are metres.
    const Shape shape = make(fmt::format("file = \"{}\"\nfill = \"level\"\nfill_height = 77\n", path("geo.tif")));
    EXPECT_EQ(height_of(shape).height({30.0, 20.0}), 77.0);
    EXPECT_EQ(height_of(shape).height({90.0, 0.0}), 11.0);
    // The south-western node is the middle of the pixel in column 0, row 2: (500015, 3999950).
    const auto* placed = dynamic_cast<const Georeferenced*>(std::get<std::unique_ptr<Surface>>(shape).get());
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->world_to_earth().map_text(), "500015 1 0 3999950 0 1");
}

TEST_F(Heightfield, refuses_a_file_that_promises_more_than_it_can_hold)
{
    std::ofstream(path("bomb.tif"), std::ios::binary) << TinyTiff(40000, 40000, 12).bytes();
    try {
        HeightFile file(path("bomb.tif"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.problems()[0].what + "|" + error.problems()[0].expected + "|" + error.problems()[0].got,
                  "the height image promises more than its file can hold|at most 2000 bytes for each of its 158|40000 x 40000");
    }
}

}  // namespace
}  // namespace hoodoo
