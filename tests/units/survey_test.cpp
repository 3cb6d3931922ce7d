// Samples, heights, sections, contours and mesh errors of terrains whose answers are known.
#include "renderer/survey.h"
#include "terrain/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace hoodoo
{
namespace
{

/// A plane that rises by 1/2 to the east through (0, 0, 1), cut to a disc of 10 m; or what `terrain` says.
LoadedScene slope(const std::string& terrain = "[terrain.slope]\ntype = \"plane\"\npoint = [0, 0, 1]\nnormal = [-0.5, 0, 1]\nextent = 10.0\n")
{
    return load_scene("version = 1\n[camera]\neye = [0, -20, 30]\ntarget = [0, 0, 0]\n" + terrain, true);
}

template <class F>
std::string error_of(const F& f)
{
    try {
        f();
    } catch (const Error& error) {
        const std::string what = error.what();
        return what.substr(0, what.find('\n'));
    }
    return "no error";
}

TEST(Survey, samples_are_the_fields_values_at_the_nodes)
{
    const LoadedScene scene = slope();
    const SurveyedTerrain terrain = survey(scene, "");
    const SampledGrid grid = sample_field(terrain, Box3d(Vec3d(-2, -1, 0), Vec3d(2, 1, 3)), {5, 3, 4});
    EXPECT_EQ(grid.origin, Vec3d(-2, -1, 0));
    EXPECT_EQ(grid.step, Vec3d(1, 1, 1));
    std::size_t next = 0;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 3; ++j)
            // The field is the distance to the plane: (z - 1 - x / 2) / sqrt(1.25).
            for (int k = 0; k < 4; ++k) EXPECT_NEAR(grid.values[next++], (k - 1.0 - 0.5 * (i - 2)) / std::sqrt(1.25), 1e-12) << i << j << k;
    // Along an axis of one node it is the middle.
    EXPECT_EQ(sample_field(terrain, Box3d(Vec3d(-2, -1, 0), Vec3d(2, 1, 3)), {5, 1, 1}).origin, Vec3d(-2, 0, 1.5));
}

TEST(Survey, heights_from_above_are_the_surface_and_nothing_beyond_it)
{
    const LoadedScene scene = slope();
    const HeightImage heights = heights_from_above(survey(scene, "slope"), Imath::Box2d(Vec2d(-12), Vec2d(12)), 1.0);
    ASSERT_EQ(heights.width, 24);
    int seen = 0, none = 0;
    for (int row = 0; row < 24; ++row)
        for (int column = 0; column < 24; ++column) {
            const double x = column - 11.5, y = 11.5 - row;
            // The disc of 10 m lies in the slanted plane.
            const double reach = std::sqrt(1.25 * x * x + y * y);
            const float z = heights.at(column, row);
            if (reach < 9.99) {
                EXPECT_NEAR(z, 1.0 + 0.5 * x, 1e-5);
                ++seen;
            } else if (reach > 10.01) {
                EXPECT_TRUE(std::isnan(z));
                ++none;
            }
        }
    EXPECT_GT(seen, 250);
    EXPECT_GT(none, 250);
}

TEST(Survey, a_section_shows_matter_below_its_outline)
{
    const LoadedScene scene = slope();
    // 8 m in 80 pixels through z = 1 + x / 2, from 0 to 2 m.
    const Drawing page = draw_section(survey(scene, ""), Vec2d(-4, 3), Vec2d(4, 3), {0.0, 2.0}, 80);
    ASSERT_EQ(page.columns(), 80);
    ASSERT_EQ(page.rows(), 20);
    const std::vector<std::uint8_t> pixels = page.pixels();
    const auto red = [&](int x, int y) { return int{pixels[static_cast<std::size_t>(3 * (y * 80 + x))]}; };
    for (int x = 0; x < 80; ++x)
        for (int y = 0; y < 20; ++y) {
            const double above = (2.0 - 0.1 * (y + 0.5)) - (1.0 + 0.5 * (-4.0 + 0.1 * (x + 0.5)));
            if (above > 0.2) {
                EXPECT_EQ(red(x, y), 255) << x << ", " << y;
            }
            if (above < -0.2) {
                EXPECT_EQ(red(x, y), 206) << x << ", " << y;
            }
            if (std::abs(above) < 0.02) {
                EXPECT_LT(red(x, y), 150) << x << ", " << y;
            }
        }
}

TEST(Survey, contours_stand_where_the_height_is_theirs)
{
    // Heights x for columns 0 to 20: contours every 5 are at the pixel centres 0.5, 5.5, 10.5 ...; each fifth multiple, 0, is heavy.
    HeightImage heights{21, 4, 1.0, {}};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 21; ++column) heights.values.push_back(static_cast<float>(column));
    const std::string svg = draw_contours(heights, 5.0, 2.0).svg();
    for (const char* x : {"M11.00", "M21.00", "M31.00", "M41.00"}) EXPECT_NE(svg.find(x), std::string::npos) << x;
    EXPECT_EQ(svg.find("M13.00"), std::string::npos);
    heights.values.assign(84, std::nanf(""));
    EXPECT_EQ(draw_contours(heights, 5.0, 2.0).svg().find("<path"), std::string::npos);
}

TEST(Survey, the_error_of_a_mesh_is_its_distance_from_the_field)
{
    const LoadedScene scene = slope();
    // Two triangles of the plane z = 1 + x / 2, lifted by 0.1 along its normal.
    const Vec3d up = Vec3d(-0.5, 0, 1).normalized() * 0.1;
    TriangleMesh mesh;
    for (const Vec2d& p : {Vec2d(-1, -1), Vec2d(1, -1), Vec2d(1, 1), Vec2d(-1, 1)})
        mesh.vertices.push_back(Vec3f(Vec3d(p.x, p.y, 1.0 + 0.5 * p.x) + up));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const MeshError error = mesh_error(survey(scene, ""), mesh, 1.0);
    EXPECT_EQ(error.triangles, 2u);
    EXPECT_NEAR(error.area, 4.0 * std::sqrt(1.25), 1e-6);
    EXPECT_NEAR(error.mean, 0.1, 1e-6);
    EXPECT_NEAR(error.rms, 0.1, 1e-6);
    EXPECT_NEAR(error.maximum, 0.1, 1e-6);
    EXPECT_EQ(error.far_triangles, 0u);
    EXPECT_EQ(mesh_error(survey(scene, ""), mesh, 0.05).far_triangles, 2u);
}

TEST(Survey, a_terrain_that_is_not_there_or_has_no_field_is_named)
{
    const LoadedScene scene = slope("[terrain.a]\ntype = \"plane\"\n[terrain.b]\ntype = \"plane\"\npoint = [0, 0, -5]\n");
    EXPECT_EQ(error_of([&] { survey(scene, "c"); }).substr(0, 38), "<text>: there is no terrain \"c\", expec");
    EXPECT_EQ(survey(scene, "b").bounds.max.z < -4.0, true);
    const LoadedScene torn =
        slope("[terrain.mud]\ntype = \"cracked\"\nbase = \"flat\"\nzero = -1.0\none = 1.0\n[terrain.flat]\ntype = \"plane\"\nextent = 5.0\n");
    EXPECT_EQ(error_of([&] { survey(torn, "flat"); }), "<text>:10:1: this terrain is not shown: another one stands on it, expected visible = true");
    EXPECT_EQ(survey(torn, "mud").fields().size(), 1u);
}

TEST(GridFile, an_array_of_numpy_has_its_head_and_its_numbers)
{
    const std::string path = (std::filesystem::temp_directory_path() / fmt::format("hoodoo_grid_{}.npy", ::getpid())).string();
    SampledGrid grid{{2, 3, 2}, Vec3d(0.0), Vec3d(1.0), {}};
    for (int k = 0; k < 12; ++k) grid.values.push_back(0.5 * k);
    write_grid_file(path, grid);
    std::ifstream file(path, std::ios::binary);
    std::stringstream bytes;
    bytes << file.rdbuf();
    const std::string text = bytes.str();
    EXPECT_EQ(text.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t head = 10 + static_cast<unsigned char>(text[8]) + 256u * static_cast<unsigned char>(text[9]);
    EXPECT_EQ(head % 64, 0u);
    EXPECT_EQ(text.size(), head + 12 * sizeof(double));
    EXPECT_NE(text.find("'shape': (2, 3, 2)"), std::string::npos);
    double last = 0.0;
    std::memcpy(&last, text.data() + text.size() - sizeof(double), sizeof(double));
    EXPECT_EQ(last, 5.5);
    std::filesystem::remove(path);
    EXPECT_EQ(error_of([&] { write_grid_file("a.txt", grid); }), "a.txt: the ending of a grid's file, expected .npy, .exr or .vdb, got txt");
}

}  // namespace
}  // namespace hoodoo
