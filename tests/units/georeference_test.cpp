// Places on the earth: through import, analysis and samples to the header of what is written; elevation models that GDAL knows.

#include "renderer/survey.h"
#include "terrain/error.h"
#include "terrain/io/dem.h"
#include "terrain/io/gdal_heights.h"
#include "terrain/io/raster.h"
#include "tests/support/tiny_tiff.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace hoodoo
{
namespace
{

using testing::TinyTiff;

class Georeference : public ::testing::Test
{
protected:
    Georeference() : folder_(std::filesystem::temp_directory_path() / fmt::format("hoodoo_georeference_{}", ::getpid()))
    {
        std::filesystem::create_directories(folder_);
    }
    ~Georeference() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// An Esri grid, which is text: 4 x 3 cells of 10 units, -9999 where nothing was measured.
    std::string grid(const std::string& name, const std::string& numbers) const
    {
        std::ofstream(path(name)) << "ncols 4\nnrows 3\nxllcorner 500000\nyllcorner 4000000\ncellsize 10\nNODATA_value -9999\n" << numbers;
        return path(name);
    }

    std::filesystem::path folder_;
};

std::string attribute(const std::string& file, const std::string& name)
{
    const auto input = OIIO::ImageInput::open(file);
    return input ? std::string(input->spec().get_string_attribute(name)) : "no file";
}

std::string message(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        return error.problems()[0].text().substr(0, error.problems()[0].text().find('\n'));
    }
    return "accepted";
}

bool with_gdal(const std::string& file)
{
    return read_gdal_heights(file, 0.0).has_value();
}

constexpr const char* kNumbers = "1 2 3 4\n5 6 7 8\n9 10 11 12\n";

TEST_F(Georeference, other_pixels_of_the_same_map)
{
    const GeoReference place{"EPSG:32613", {1000.0, 2.0, 0.5, 2000.0, 0.25, -4.0}};
    const GeoReference half = place.of_pixels(3.0, 5.0, 0.5, 2.0);
    EXPECT_EQ(half.system, place.system);
    // Column 2, row 1 of the new pixels is column 4, row 7 of the old: (1000 + 8 + 3.5, 2000 + 1 - 28).
    EXPECT_DOUBLE_EQ(half.map[0] + 2.0 * half.map[1] + 1.0 * half.map[2], 1011.5);
    EXPECT_DOUBLE_EQ(half.map[3] + 2.0 * half.map[4] + 1.0 * half.map[5], 1973.0);
}

TEST_F(Georeference, an_import_keeps_the_place_through_subset_and_resampling)
{
    HeightImage image{6, 4, 10.0, std::vector<float>(24, 1.0f), {"EPSG:32613", {500000.0, 10.0, 0.0, 4000000.0, 0.0, -10.0}}};
    const std::string file = path("in.exr");
    write_height_image(file, image);
    DemOptions options;
    EXPECT_EQ(import_dem(file, options).place.map_text(), image.place.map_text());
    options.subset = {2, 6, 1, 3};
    options.resample_to = 5.0;
    const HeightImage part = import_dem(file, options);
    EXPECT_EQ(part.place.system, "EPSG:32613");
    EXPECT_EQ(part.place.map_text(), "500020 5 0 3999990 0 -5");
    const std::string out = path("out.exr");
    write_height_image(out, part);
    EXPECT_EQ(attribute(out, "hoodoo:crs"), "EPSG:32613");
    EXPECT_EQ(attribute(out, "hoodoo:geoTransform"), "500020 5 0 3999990 0 -5");
    // What analyses write.
    write_raster(path("raster.exr"), {2, 1, 5.0, {"slope"}, {{1.0f, 2.0f}}, part.place});
    EXPECT_EQ(attribute(path("raster.exr"), "hoodoo:geoTransform"), "500020 5 0 3999990 0 -5");
}

TEST_F(Georeference, samples_of_a_placed_terrain_say_where_they_lie)
{
    const std::string file = path("in.exr");
    write_height_image(file, {6, 4, 10.0, std::vector<float>(24, 1.0f), {"EPSG:32613", {500000.0, 10.0, 0.0, 4000000.0, 0.0, -10.0}}});
    SceneOverrides overrides;
    overrides.allowed_roots = {folder_.string()};
    const LoadedScene scene = load_scene(
        fmt::format("version = 1\n[camera]\neye = [0, -20, 30]\ntarget = [0, 0, 0]\n[terrain.land]\ntype = \"heightfield\"\nfile = \"{}\"\n", file),
        true, overrides);
    const SurveyedTerrain terrain = survey(scene, "");
    // Node (0, 0) of the world is the middle of the pixel in the south-west: (500005, 3999965).
    const SampledGrid grid = sample_field(terrain, Box3d(Vec3d(0, 0, 1), Vec3d(40, 20, 1)), {5, 3, 1});
    EXPECT_EQ(grid.place.map_text(), "500000 10 0 3999990 0 -10");
    write_grid_file(path("samples.exr"), grid);
    EXPECT_EQ(attribute(path("samples.exr"), "hoodoo:crs"), "EPSG:32613");
    const HeightImage above = heights_from_above(terrain, Imath::Box2d(Vec2d(5.0, 5.0), Vec2d(35.0, 25.0)), 5.0);
    EXPECT_EQ(above.place.map_text(), "500010 5 0 3999990 0 -5");
    RenderOptions options;
    options.spp = 1;
    options.width = 16;
    options.height = 16;
    const Image picture = render(scene, options);
    EXPECT_EQ(std::get<std::string>(picture.metadata.at("hoodoo:crs")), "EPSG:32613");
    EXPECT_EQ(std::get<std::string>(picture.metadata.at("hoodoo:worldToMap")), "500005 1 0 3999965 0 1");
}

TEST_F(Georeference, gdal_reads_the_place_of_a_geotiff)
{
    // 4 x 3 samples 0 to 11 of 30 by 20 m in UTM zone 13 north; 5 means not measured.
    TinyTiff tiff(4, 3, 12);
    tiff.values<double>(33550, 12, {30.0, 20.0, 0.0});
    tiff.values<double>(33922, 12, {0, 0, 0, 500000.0, 4000000.0, 0});
    tiff.values<std::uint16_t>(34735, 3, {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32613});
    tiff.values<char>(42113, 2, {'5', '\0', ' ', ' ', '\0'});
    const std::string file = path("geo.tif");
    std::ofstream(file, std::ios::binary) << tiff.bytes();
    const auto heights = read_gdal_heights(file, 77.0);
    if (!heights) GTEST_SKIP() << "a build without GDAL";
    EXPECT_EQ(heights->image.place.system, "EPSG:32613");
    EXPECT_EQ(heights->image.place.map_text(), "500000 30 0 4000000 0 -20");
    EXPECT_EQ(heights->cell_x, 30.0);
    EXPECT_EQ(heights->cell_y, 20.0);
    EXPECT_EQ(heights->image.at(1, 1), 77.0f);
    EXPECT_EQ(heights->image.at(3, 2), 11.0f);
    // Imported: square cells of the smaller side, still in place.
    DemOptions options;
    options.fill = 77.0;
    const HeightImage imported = import_dem(file, options);
    EXPECT_EQ(imported.cell, 20.0);
    EXPECT_EQ(imported.place.map_text(), "500000 20 0 4000000 0 -20");
}

TEST_F(Georeference, gdal_reads_grids_of_text)
{
    const auto heights = read_gdal_heights(grid("land.asc", kNumbers), std::nullopt);
    if (!heights) GTEST_SKIP() << "a build without GDAL";
    // No system: neither metres nor degrees, and no place.
    EXPECT_FALSE(heights->image.place.known());
    EXPECT_EQ(heights->cell_x, 0.0);
    EXPECT_EQ(heights->image.at(1, 0), 2.0f);
    EXPECT_EQ(heights->image.at(3, 2), 12.0f);
}

TEST_F(Georeference, gdal_names_what_was_not_measured)
{
    const std::string file = grid("gaps.asc", "1 2 3 4\n5 -9999 7 8\n9 10 -9999 12\n");
    if (!with_gdal(file)) GTEST_SKIP() << "a build without GDAL";
    EXPECT_EQ(message([&] { read_gdal_heights(file, std::nullopt); }),
              file +
                  ": heights are missing in the file, expected a height everywhere, or --fill METRES, got 2 of 12 samples without one, the first at "
                  "column 1, row 1");
    const auto filled = read_gdal_heights(file, 3.5);
    EXPECT_EQ(filled->image.at(1, 1), 3.5f);
    EXPECT_EQ(filled->image.at(2, 2), 3.5f);
    EXPECT_EQ(filled->image.at(2, 1), 7.0f);
}

}  // namespace
}  // namespace hoodoo
