// Which rocks lie where: in rock layers, seen by air in any direction, touching something; and tiles that do not repeat.

#include "terrain/rocks/corner_cubes.h"
#include "terrain/rocks/poisson_spheres.h"
#include "terrain/rocks/stack_rocks.h"
#include "tests/counts.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/rock_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

constexpr double kUnit = 0.01;

std::int32_t units(double metres)
{
    return static_cast<std::int32_t>(std::lround(metres / kUnit));
}

/// A floor at 2 m with `rocks` metres of rock on it; where x < 6 a roof from 12 m to 30 m (a cave), where x > 18 a cliff: the rock layer goes on
/// inside it, under 30 m of bedrock.
std::shared_ptr<MaterialStack> cave_and_cliff(double rocks)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(24, 20), 1.0, kUnit);
    std::vector<std::vector<Layer>> columns;
    for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 24; ++i) {
            std::vector<Layer> column = {{Material::bedrock, units(2.0)}, {Material::rock, units(2.0 + rocks)}};
            if (i < 6) column.insert(column.end(), {{Material::air, units(12.0)}, {Material::bedrock, units(30.0)}});
            if (i >= 18) column.push_back({Material::bedrock, units(32.0)});
            columns.push_back(std::move(column));
        }
    }
    stack->set_columns({0, 0}, {24, 20}, columns);
    return stack;
}

RockOptions small_rocks()
{
    RockOptions options;
    options.size = 1.2;
    options.level = 3;
    options.seed = 5;
    return options;
}

TEST(StackRocks, knows_air_in_every_direction)
{
    const StackRocks volume(cave_and_cliff(1.0), Border::extend);
    EXPECT_TRUE(volume.holds({10.5, 10.5, 2.5}));
    EXPECT_FALSE(volume.holds({10.5, 10.5, 3.5}));
    EXPECT_FALSE(volume.holds({10.5, -0.5, 2.5}));
    EXPECT_TRUE(volume.ground({10.5, 10.5, 1.5}));
    EXPECT_FALSE(volume.ground({10.5, 10.5, 2.5}));
    // In the cave the air is 0.5 m above; inside the cliff it is beside: the column at x < 18 has air above 3 m, and (18.6, z = 2.5) is
    // sqrt(0.6^2 + 0.5^2) = 0.781 m from it.
    EXPECT_TRUE(volume.air_within({3.0, 10.0, 2.5}, 0.51));
    EXPECT_FALSE(volume.air_within({3.0, 10.0, 2.5}, 0.49));
    EXPECT_TRUE(volume.air_within({18.6, 10.0, 2.5}, 0.785));
    EXPECT_FALSE(volume.air_within({18.6, 10.0, 2.5}, 0.775));
    // Beyond the grid the edge columns go on, or there is air.
    EXPECT_FALSE(volume.air_within({23.9, 10.0, 2.5}, 0.5));
    EXPECT_TRUE(StackRocks(cave_and_cliff(1.0), Border::cut).air_within({23.9, 10.0, 2.5}, 0.5));
}

TEST(Placement, rocks_lie_in_the_layer_in_caves_and_beside_cliffs_but_not_where_nothing_sees_them)
{
    const auto stack = cave_and_cliff(4.0);
    const StackRocks volume(stack, Border::extend);
    const Instances rocks = place_rocks(small_rocks(), volume, stack->origin());
    const RockTile tile = make_rock_tile(small_rocks());
    double reach = 0.0;
    for (const VoronoiCell& cell : tile.cells) reach = std::max(reach, 2.0 * cell.max_radius);
    int cave = 0, inside_cliff = 0, deepest_in_cliff = 0;
    for (const Instance& rock : rocks.instances) {
        ASSERT_TRUE(volume.holds(rock.position));
        ASSERT_TRUE(volume.air_within(rock.position, reach));
        cave += rock.position.x < 6.0;
        inside_cliff += rock.position.x > 18.0;
        deepest_in_cliff = std::max(deepest_in_cliff, static_cast<int>(std::ceil(rock.position.x)));
    }
    // About one rock a cell's mean volume of 1.2^3 pi / 6 = 0.905 m3. In the cave all 4 m may be within reach: at most 6 * 20 * 4 / 0.905 = 530.
    EXPECT_GT(cave, 150);
    EXPECT_LT(cave, 560);
    EXPECT_GT(inside_cliff, 20);
    EXPECT_LE(deepest_in_cliff, static_cast<int>(std::ceil(18.0 + reach)));
    // Every site that must be there is: nothing but the rule decides.
    std::size_t expected = 0;
    const auto sites = make_sites(small_rocks());
    for (int x = -2; x < 30; ++x)
        for (int y = -2; y < 30; ++y)
            for (int z = -2; z < 6; ++z)
                for (const Site& site : sites->sites(Vec3i(0))) {
                    const Vec3d p = Vec3d(x, y, z) * sites->length() + site.position;
                    expected += volume.holds(p) && volume.air_within(p, reach);
                }
    EXPECT_LE(rocks.instances.size(), expected);
    EXPECT_GE(static_cast<double>(rocks.instances.size()), 0.97 * static_cast<double>(expected));  // without company: a few at the rim
}

TEST(Placement, gives_each_instance_its_own_id_and_seed_and_copies_of_few_meshes)
{
    const auto stack = cave_and_cliff(2.0);
    const Instances rocks = place_rocks(small_rocks(), StackRocks(stack, Border::extend), stack->origin());
    std::set<std::uint32_t> ids, seeds;
    for (const Instance& rock : rocks.instances) ids.insert(rock.id), seeds.insert(rock.seed);
    EXPECT_EQ(ids.size(), rocks.instances.size());
    EXPECT_EQ(*ids.begin(), 1u);
    EXPECT_EQ(seeds.size(), rocks.instances.size());
    EXPECT_GT(rocks.meshes.size(), 10u);  // a layer thinner than a tile shows only some of its 50
    EXPECT_LE(rocks.meshes.size(), 50u);
    EXPECT_EQ(rocks.rocks.instances, rocks.instances.size());
    EXPECT_EQ(rocks.rocks.per_tile, 50u);
}

/// Share of rocks of which a vertex lies within 0.05 r of another's vertex (contacts are vertices of both), or of the ground.
double touching_share(const Instances& rocks, const RockVolume& volume, double radius)
{
    std::size_t touching = 0;
    for (const Instance& a : rocks.instances) {
        bool touches = false;
        for (const Vec3f& v : rocks.meshes[a.mesh].vertices) {
            const Vec3d p = a.position + Vec3d(v);
            touches = touches || volume.ground(p - Vec3d(0.0, 0.0, 0.05 * radius));
        }
        for (const Instance& b : rocks.instances) {
            if (touches || &a == &b || (a.position - b.position).length() > 6.0 * radius) continue;
            for (const Vec3f& v : rocks.meshes[a.mesh].vertices)
                for (const Vec3f& w : rocks.meshes[b.mesh].vertices)
                    touches = touches || (a.position + Vec3d(v) - b.position - Vec3d(w)).length() <= 0.05 * radius;
        }
        touching += touches;
    }
    return static_cast<double>(touching) / static_cast<double>(rocks.instances.size());
}

TEST(Placement, nearly_all_rocks_touch_another_or_the_ground)
{
    for (const double thickness : {0.3, 1.0, 3.0}) {
        for (const bool cubes : {false, true}) {
            const auto stack = cave_and_cliff(thickness);
            const StackRocks volume(stack, Border::extend);
            RockOptions options = small_rocks();
            options.corner_cubes = cubes;
            const Instances rocks = place_rocks(options, volume, stack->origin());
            ASSERT_GT(rocks.instances.size(), 30u);
            EXPECT_GE(touching_share(rocks, volume, make_sites(options)->radius()), 0.95) << thickness << " m of rock";
        }
    }
}

TEST(Placement, rocks_lifted_apart_are_noticed_not_to_touch)
{
    const auto stack = cave_and_cliff(1.0);
    const StackRocks volume(stack, Border::extend);
    Instances rocks = place_rocks(small_rocks(), volume, stack->origin());
    for (Instance& rock : rocks.instances) rock.position = rock.position * 3.0 + Vec3d(0.0, 0.0, 40.0);
    EXPECT_LT(touching_share(rocks, volume, 0.5), 0.05);
}

/// Empty if all points of 4^3 tiles keep their distance, and the tiles that share corners agree.
std::string cubes_fit(const SiteArrangement& cubes)
{
    std::vector<Vec3d> all;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z)
                for (std::uint32_t k = 0; k < cubes.sites({x, y, z}).size(); ++k) all.push_back(cubes.position({{x, y, z}, k}));
    const double least = 4.0 * cubes.radius() * cubes.radius();
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if ((all[i] - all[j]).length2() < least)
                return "two points are " + std::to_string((all[i] - all[j]).length() / cubes.radius()) + " radii apart";
    return {};
}

TEST(CornerCubes, keep_their_distance_across_all_faces_and_are_about_as_dense_as_the_tile)
{
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(count(3, 20)); ++seed) {
        const double radius = 0.93 * random_packing_radius(50, 1.0);
        const CornerCubes cubes(1.0, radius, seed);
        EXPECT_EQ(cubes_fit(cubes), "") << "seed " << seed;
        // Saturated points of 0.93 of that radius would be 50 / 0.93^3 = 62; what borders between regions cost is under a fifth.
        EXPECT_GT(cubes.density(), 50.0);
        EXPECT_LT(cubes.density(), 62.0);
    }
}

/// Colours chosen for each tile by itself: corners do not agree.
class Quarrelling final : public SiteArrangement
{
public:
    explicit Quarrelling(const CornerCubes& cubes) : SiteArrangement(cubes.length(), cubes.radius()), cubes_(cubes) {}
    std::span<const Site> sites(const Vec3i& tile) const override
    {
        return cubes_.cube(static_cast<std::size_t>(tile.x * 7 + tile.y * 31 + tile.z * 111) % 256);
    }
    double density() const override { return cubes_.density(); }

private:
    const CornerCubes& cubes_;
};

TEST(CornerCubes, tiles_whose_corners_disagree_do_not_fit)
{
    const CornerCubes cubes(1.0, 0.93 * random_packing_radius(50, 1.0), 1);
    EXPECT_NE(cubes_fit(Quarrelling(cubes)), "");
}

TEST(CornerCubes, cells_of_neighbouring_tiles_fill_space)
{
    // Cells of all points of a tile and all its neighbours' cells that reach into it: volumes of a block of 3^3 tiles stay within the border cells'.
    const CornerCubes cubes(1.0, 0.93 * random_packing_radius(50, 1.0), 2);
    std::vector<SiteId> ids;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
            for (int z = 0; z < 3; ++z)
                for (std::uint32_t k = 0; k < cubes.sites({x, y, z}).size(); ++k) ids.push_back({{x, y, z}, k});
    const VoronoiCells cells(cubes, ids, Vec3d(1.0));
    for (const SiteId& id : ids) {
        for (const CellFace& face : cells.at(id).faces) {
            const VoronoiCell& other = cells.at({id.tile + face.neighbour.tile, face.neighbour.index});
            const auto twin = std::find_if(other.faces.begin(), other.faces.end(), [&](const CellFace& f) {
                return f.neighbour == SiteId{-face.neighbour.tile, id.index};
            });
            if (face.area < 1e-7) continue;
            ASSERT_NE(twin, other.faces.end());
            EXPECT_NEAR(twin->area, face.area, 1e-9);
        }
    }
}

/// A scree that rises along y, deep enough that its top is rocks only.
constexpr double kRise = 0.6;
class Scree final : public RockVolume
{
public:
    Scree(double x, double y) : size_(x, y, kRise * y) {}
    Box3d bounds() const override { return {Vec3d(0.0), size_}; }
    Interval heights(const Vec2d&, const Vec2d&) const override { return {0.0, size_.z}; }
    bool holds(const Vec3d& p) const override { return Box3d(Vec3d(0.0), size_).intersects(p) && p.z < kRise * p.y; }
    bool air_within(const Vec3d& p, double distance) const override { return kRise * p.y - p.z < distance * std::hypot(1.0, kRise); }
    bool ground(const Vec3d& p) const override { return p.z < 0.0; }

private:
    Vec3d size_;
};

/// Autocorrelation of a scree's height over its slope at a shift of one tile along x, without the tiles at its edges.
double height_correlation(const RockOptions& options)
{
    const double length = tile_length(options);
    const int tiles_x = 9, tiles_y = 4, samples = 12, width = tiles_x * samples;
    const Instances rocks = place_rocks(options, Scree(tiles_x * length, tiles_y * length), Vec3d(0.0));
    const double step = length / samples;
    std::vector<double> heights(static_cast<std::size_t>(width * tiles_y * samples), -0.5 * options.size);
    for (const Instance& rock : rocks.instances) {
        for (const auto& t : rocks.meshes[rock.mesh].triangles) {
            Vec3d p = rock.position;
            for (const std::uint32_t k : t) p += Vec3d(rocks.meshes[rock.mesh].vertices[k]) / 3.0;
            const int i = static_cast<int>(std::floor(p.x / step)), j = static_cast<int>(std::floor(p.y / step));
            if (i < 0 || j < 0 || i >= width || j >= tiles_y * samples) continue;
            double& h = heights[static_cast<std::size_t>(j * width + i)];
            h = std::max(h, p.z - kRise * (j + 0.5) * step);
        }
    }
    const auto at = [&](int i, int j) { return heights[static_cast<std::size_t>(j * width + i)]; };
    const auto inner = [&](auto&& visit) {
        for (int j = samples; j < (tiles_y - 1) * samples; ++j)
            for (int i = samples; i < (tiles_x - 2) * samples; ++i) visit(i, j);
    };
    double mean = 0.0, variance = 0.0, covariance = 0.0;
    int count = 0;
    inner([&](int i, int j) { mean += at(i, j), ++count; });
    mean /= count;
    inner([&](int i, int j) {
        variance += (at(i, j) - mean) * (at(i, j) - mean);
        covariance += (at(i, j) - mean) * (at(i + samples, j) - mean);
    });
    return covariance / variance;
}

TEST(CornerCubes, do_not_repeat_where_the_periodic_tile_does)
{
    RockOptions options;
    options.level = 3;
    options.seed = 9;
    const double periodic = height_correlation(options);
    options.corner_cubes = true;
    EXPECT_LT(std::abs(height_correlation(options)), 0.2);
    EXPECT_GT(periodic, 0.9);
}

TEST(CornerCubes, make_at_least_four_times_as_many_different_rocks)
{
    RockOptions options = small_rocks();
    const auto stack = cave_and_cliff(4.0);
    const StackRocks volume(stack, Border::extend);
    const std::size_t periodic = place_rocks(options, volume, Vec3d(0.0)).meshes.size();
    options.corner_cubes = true;
    const Instances rocks = place_rocks(options, volume, Vec3d(0.0));
    EXPECT_LE(periodic, 50u);
    EXPECT_GE(rocks.meshes.size(), 200u);
    RecordProperty("meshes", static_cast<int>(rocks.meshes.size()));
}

}  // namespace
}  // namespace hoodoo
