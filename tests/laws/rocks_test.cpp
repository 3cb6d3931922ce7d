// The laws of rocks over many tiles: cells, contacts, weathered fields and meshes at every level of detail; and mutants that break each.

#include "terrain/rocks/rock_mesh.h"
#include "tests/counts.h"
#include "tests/support/rock_tile.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// Every kind of tile: few and many rocks, all levels of detail, round and broken, flat and long.
RockOptions options_for(int seed)
{
    RockOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.per_tile = seed % 5 == 0 ? 50 : 8 + seed % 17;
    options.size = seed % 3 == 0 ? 0.4 : 1.7;
    options.level = seed % kRockLevels;
    options.contacts = 5 + seed % 3;
    options.roundness = 0.1 * (seed % 11);
    options.roughness = 0.02 * (seed % 6);
    if (seed % 4 == 1) options.shape = Vec3d(1.4, 1.0, 0.7);
    return options;
}

void expect_all_laws(const RockTile& tile, int seed)
{
    const auto holds = [&](const Verdict& v) { EXPECT_TRUE(v.holds()) << "seed " << seed << ": " << v.fault; };
    holds(volumes_fill_the_tile(tile));
    holds(points_keep_their_distance(tile));
    holds(faces_have_twins(tile));
    holds(contacts_are_shared(tile));
    holds(rocks_keep_out(tile, count(4000, 40000)));
    holds(meshes_are_closed(tile));
    holds(contacts_are_reached(tile));
}

TEST(RockLaws, hold_for_every_seed_and_level)
{
    for (int seed = 1; seed <= count(20, 100); ++seed) expect_all_laws(make_rock_tile(options_for(seed)), seed);
}

TEST(RockLaws, hold_for_the_finest_level_of_a_tile_of_seventy)
{
    RockOptions options;
    options.per_tile = 70;
    options.roughness = 0.08;
    options.seed = 1;
    expect_all_laws(make_rock_tile(options), 0);
}

class RockMutants : public ::testing::Test
{
protected:
    RockMutants()
    {
        RockOptions options;
        options.per_tile = 20;
        options.level = 2;
        options.seed = 3;
        tile_ = make_rock_tile(options);
    }
    RockTile tile_;
};

TEST_F(RockMutants, a_cell_a_thousandth_too_large_is_noticed)
{
    tile_.cells[4].volume *= 1.001;
    EXPECT_FALSE(volumes_fill_the_tile(tile_).holds());
}

TEST_F(RockMutants, points_too_near_across_the_border_are_noticed)
{
    // Two points that only the copies in the next tile bring together.
    tile_.points[0] = Vec3d(0.1 * tile_.radius, 0.5 * tile_.length, 0.5 * tile_.length);
    tile_.points[1] = Vec3d(tile_.length - 1.8 * tile_.radius, 0.5 * tile_.length, 0.5 * tile_.length);
    tile_.points.resize(2);
    EXPECT_EQ(points_keep_their_distance(tile_).fault.substr(0, 22), "points 1 and 0 are 1.9");
}

TEST_F(RockMutants, a_face_that_one_side_lacks_is_noticed)
{
    tile_.cells[2].faces.erase(std::max_element(tile_.cells[2].faces.begin(), tile_.cells[2].faces.end(),
                                                [](const CellFace& a, const CellFace& b) { return a.area < b.area; }));
    EXPECT_FALSE(faces_have_twins(tile_).holds());
}

TEST_F(RockMutants, a_contact_moved_on_one_side_is_noticed)
{
    tile_.contacts[3][0].point += Vec3d(0.01 * tile_.radius);
    EXPECT_FALSE(contacts_are_shared(tile_).holds());
}

TEST_F(RockMutants, a_field_that_leaves_its_cell_is_noticed)
{
    // Without wear and with its planes moved out by 3% of a radius each rock overlaps its neighbours.
    for (std::size_t i = 0; i < tile_.cells.size(); ++i) {
        VoronoiCell larger = tile_.cells[i];
        for (CellFace& face : larger.faces) face.offset += 0.03 * tile_.radius;
        tile_.fields[i] = std::make_unique<RockField>(larger, std::vector<Vec3d>{}, tile_.radius, Weathering{.depth = 0.0, .exposure = 0.0});
    }
    EXPECT_FALSE(rocks_keep_out(tile_, 4000).holds());
}

TEST_F(RockMutants, a_mesh_that_swells_by_a_fifteenth_is_noticed)
{
    for (TriangleMesh& mesh : tile_.meshes)
        for (Vec3f& v : mesh.vertices) v *= 1.07f;
    EXPECT_FALSE(rocks_keep_out(tile_, 8000).holds());
}

TEST_F(RockMutants, a_missing_and_a_turned_triangle_are_noticed)
{
    std::swap(tile_.meshes[5].triangles[7][0], tile_.meshes[5].triangles[7][1]);
    EXPECT_FALSE(meshes_are_closed(tile_).holds());
    std::swap(tile_.meshes[5].triangles[7][0], tile_.meshes[5].triangles[7][1]);
    EXPECT_TRUE(meshes_are_closed(tile_).holds());
    tile_.meshes[5].triangles.pop_back();
    EXPECT_FALSE(meshes_are_closed(tile_).holds());
}

TEST_F(RockMutants, a_mesh_that_faces_inwards_is_noticed)
{
    for (auto& t : tile_.meshes[1].triangles) std::swap(t[0], t[1]);
    EXPECT_EQ(meshes_are_closed(tile_).fault, "rock 1 faces inwards");
}

TEST_F(RockMutants, meshes_that_shrink_by_a_twentieth_reach_too_few_contacts)
{
    for (TriangleMesh& mesh : tile_.meshes)
        for (Vec3f& v : mesh.vertices) v *= 0.95f;
    EXPECT_FALSE(contacts_are_reached(tile_).holds());
}

}  // namespace
}  // namespace hoodoo
