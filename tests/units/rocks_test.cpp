// Rocks against the golden tile (brute force: half-space clipping over 125 copies, Phi by definition), and what impossible parameters say.

#include "terrain/rocks/poisson_spheres.h"
#include "terrain/rocks/rock_mesh.h"
#include "tests/support/rock_tile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <set>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

Vec3d vec(const nlohmann::json& v)
{
    return {v[0], v[1], v[2]};
}

/// The golden tile: explicit sites, edge 1 m, and as contacts the centroids of all faces of area >= 0.02.
struct Golden {
    nlohmann::json data = nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/a_rocks.json"));
    RockOptions options;
    Golden()
    {
        for (const auto& p : data["sites"]) options.sites.push_back(vec(p));
        for (const auto& f : data["faces"])
            if (f["area"].get<double>() >= 0.02) options.contact_points.push_back(vec(f["centroid"]));
        options.size = 1.0 / std::cbrt(8.0 * 3.14159265358979323846 / 6.0);  // tile_length's inverse for an edge of 1
        options.radius = data["poisson_r"].get<double>();
        options.level = 3;
    }
};

TEST(VoronoiCell, has_the_golden_volumes_faces_and_radius)
{
    const Golden golden;
    const RockTile tile = make_rock_tile(golden.options);
    EXPECT_NEAR(tile.length, 1.0, 1e-15);
    std::size_t faces = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(tile.cells[i].max_radius, golden.data["max_radius"][i].get<double>(), 1e-9);
        EXPECT_NEAR(tile.cells[i].volume, golden.data["cell_volume"][i].get<double>(), 1e-9);
        for (const CellFace& f : tile.cells[i].faces) faces += f.area > 1e-9;
    }
    EXPECT_EQ(faces, golden.data["faces"].size());
    for (const auto& f : golden.data["faces"]) {
        const auto i = f["cell"].get<std::size_t>();
        const Vec3d shift = vec(f["shift"]);
        const SiteId to{Vec3i(static_cast<int>(shift.x), static_cast<int>(shift.y), static_cast<int>(shift.z)), f["neighbour"].get<std::uint32_t>()};
        const auto& list = tile.cells[i].faces;
        const auto found = std::find_if(list.begin(), list.end(), [&](const CellFace& face) { return face.neighbour == to; });
        ASSERT_NE(found, list.end()) << f;
        EXPECT_NEAR(found->area, f["area"].get<double>(), 1e-9);
        EXPECT_NEAR((found->centroid + tile.points[i] - vec(f["centroid"])).length(), 0.0, 1e-7);
    }
}

TEST(RockField, has_the_golden_values)
{
    const Golden golden;
    const RockTile tile = make_rock_tile(golden.options);
    for (const auto& sample : golden.data["phi"]) {
        const auto i = sample["cell"].get<std::size_t>();
        std::vector<Vec3d> contacts;
        for (const Contact& c : tile.contacts[i]) contacts.push_back(c.point);
        const RockField field(tile.cells[i], contacts, golden.data["poisson_r"].get<double>(),
                              {.depth = 0.25, .exposure = 1.0, .sharpness = 12.0, .width = 1.0});
        const Vec3d p = vec(sample["p"]) - tile.points[i];
        EXPECT_NEAR(field.value(p), sample["Phi"].get<double>(), 1e-9) << sample;
        EXPECT_NEAR(field.plane_distance(p), sample["M"].get<double>(), 1e-9);
        EXPECT_NEAR(field.smooth_distance(p), sample["S"].get<double>(), 1e-9);
        EXPECT_NEAR(field.resistance(p), sample["rho"].get<double>(), 1e-9);
        EXPECT_LE(field.slope(), golden.data["phi_lipschitz_bound"].get<double>() + 0.05);
    }
}

TEST(RockField, obeys_the_law_of_fields)
{
    RockOptions options;
    options.per_tile = 12;
    options.roughness = 0.1;
    options.level = 3;
    const RockTile tile = make_rock_tile(options);
    for (std::size_t i = 0; i < 4; ++i) {
        const Verdict v = field_bounds_hold(*tile.fields[i], tile.cells[i].box, i, 2000);
        EXPECT_TRUE(v.holds()) << v.fault;
    }
}

TEST(Contacts, are_about_as_many_as_asked_and_at_least_three)
{
    for (const int asked : {5, 6, 7}) {
        RockOptions options;
        options.per_tile = 70;
        options.contacts = asked;
        options.level = 3;
        const RockTile tile = make_rock_tile(options);
        double sum = 0.0;
        for (const auto& contacts : tile.contacts) {
            EXPECT_GE(contacts.size(), 3u);
            sum += static_cast<double>(contacts.size());
        }
        EXPECT_NEAR(sum / 70.0, asked, 1.0);
    }
}

TEST(RockMesh, has_as_many_triangles_as_its_level_says_and_lies_on_the_surface)
{
    RockOptions options;
    options.per_tile = 8;
    for (int level = 0; level < kRockLevels; ++level) {
        options.level = level;
        for (const Rock& rock : make_tile(options)) {
            EXPECT_EQ(rock.mesh.triangles.size(), rock_triangles(level));
            // Single precision rounds a vertex by half a unit in the last place of about 0.7 m: 3e-8 m.
            for (const Vec3f& v : rock.mesh.vertices) EXPECT_NEAR(rock.field->value(Vec3d(v)), 0.0, 2e-7);
        }
    }
    EXPECT_EQ(rock_triangles(0), 8000u);
}

std::string refusal(const RockOptions& options)
{
    try {
        make_sites(options);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(RockOptions, say_what_fits_where_their_rocks_do_not)
{
    // 1000 rocks with a mean diameter of 0.2 m: the tile's edge is 0.2 (1000 pi / 6)^(1/3) = 1.612 m; random placing ends at
    // 1.612 (3 * 0.384 / (4000 pi))^(1/3) = 0.07269 m, 0.93 of which is 0.0676 m.
    RockOptions options;
    options.per_tile = 1000;
    options.size = 0.2;
    options.radius = 0.5;
    EXPECT_THAT(refusal(options), ::testing::HasSubstr("1000 rocks with a radius of 0.5 m do not fit into a tile of 1.612 m"));
    EXPECT_THAT(refusal(options), ::testing::HasSubstr("a radius of at most 0.0676 m, or at most 2 rocks a tile"));
    options.radius.reset();
    EXPECT_EQ(refusal(options), "accepted");
    options.per_tile = 8;
    options.corner_cubes = true;
    EXPECT_THAT(refusal(options), ::testing::HasSubstr("corner cubes of 0.3224 m are too small for rocks with a radius of"));
}

TEST(PoissonSpheres, are_the_same_for_the_same_seed_and_others_for_another)
{
    const auto a = poisson_spheres(50, 2.0, 0.22, 7), b = poisson_spheres(50, 2.0, 0.22, 7), c = poisson_spheres(50, 2.0, 0.22, 8);
    ASSERT_EQ(a.size(), 50u);
    EXPECT_EQ(a, b);
    EXPECT_NE(a, c);
}

}  // namespace
}  // namespace hoodoo
