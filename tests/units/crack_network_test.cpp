// Cracks against the golden values (explicit segments, brute force), against explicit polygons of our own, and against what the paper's figures need.
#include "terrain/fields/crack_network.h"
#include "terrain/fields/cracked_field.h"
#include "tests/support/crack_oracle.h"
#include "tests/support/numbers.h"
#include "tests/support/wavy_ground.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using Json = nlohmann::json;
using testing::CrackOracle;
using testing::golden_sites;
using testing::Numbers;
using testing::WavyHeight;

const Json& golden()
{
    static const Json data = Json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/c_cracks.json"));
    return data;
}

const Box2d kUnit(Vec2d(0.0), Vec2d(1.0));

CrackNetwork golden_network()
{
    return CrackNetwork(VoronoiDiagram(golden_sites(200), kUnit), 0.1 / std::sqrt(200.0));
}

CrackedField golden_field()
{
    return CrackedField(std::make_shared<WavyHeight>(), golden_network(), {}, kUnit, 0.0, 1.0);
}

TEST(CrackNetwork, sites_of_the_generator_stay_where_they_are)
{
    const VoronoiDiagram diagram(golden_sites(200), kUnit);
    for (std::size_t k = 0; k < golden()["first_sites"].size(); ++k)
        for (int c = 0; c < 2; ++c) EXPECT_EQ(diagram.sites()[k][c], golden()["first_sites"][k][static_cast<std::size_t>(c)].get<double>());
    // The golden count is of a diagram that ends at a far box, with all borders; ours ends at the unit square.
    EXPECT_EQ(CrackOracle(golden_sites(200), {}, {}).edges().size(), golden()["n_edges"].get<std::size_t>());
}

TEST(CrackNetwork, distance_depth_and_height_equal_the_golden_values)
{
    const CrackedField field = golden_field();
    int seen = 0, torn = 0;
    for (const Json& p : golden()["points"]) {
        const Vec2d uv(p["uv"][0], p["uv"][1]);
        EXPECT_NEAR(field.network().distance(uv), p["d_edge"].get<double>(), 1e-14) << p;
        EXPECT_NEAR(field.iota(uv), p["iota"].get<double>(), 1e-12) << p;
        EXPECT_EQ(field.cracked(uv), p["aleph"] == 1) << p;
        EXPECT_NEAR(field.height(uv), p["h_prime"].get<double>(), 1e-14) << p;
        ++seen;
        torn += field.cracked(uv);
    }
    EXPECT_EQ(seen, 8);
    EXPECT_EQ(torn, 2);
}

TEST(CrackNetwork, iota_equals_the_golden_table)
{
    for (const Json& row : golden()["iota_table"]) EXPECT_NEAR(CrackDepth{}.iota(row["x"]), row["iota"].get<double>(), 1e-12) << row;
}

TEST(CrackNetwork, a_border_error_of_zero_is_a_step)
{
    const CrackDepth depth{0.3, 0.4, 0.0};
    EXPECT_EQ(depth.iota(0.4), 1.0);
    EXPECT_EQ(depth.iota(std::nextafter(0.4, 1.0)), 0.0);
    EXPECT_DOUBLE_EQ(depth.floor(0.4), 0.28);
    EXPECT_EQ(depth.floor(0.41), 0.41);
    // Under ground of 0.4 the crack's wall at the border line goes from 0.28 to 0.4.
    EXPECT_DOUBLE_EQ(depth.ground(0.28), 0.4);
    EXPECT_EQ(depth.ground(0.33), 0.4);
    EXPECT_EQ(depth.ground(0.45), 0.45);
}

TEST(CrackNetwork, ground_is_the_inverse_of_the_floor)
{
    for (const CrackDepth& depth : {CrackDepth{}, CrackDepth{0.99, 0.0, 0.3}, CrackDepth{0.5, 1.0, 0.01}, CrackDepth{0.0, 0.3, 0.2}}) {
        double below = -kInfinity;
        for (double h = -0.5; h < 1.5; h += 1.0 / 1024.0) {
            const double z = depth.floor(h);
            EXPECT_NEAR(depth.ground(z), h, 1e-12) << depth.kappa << ' ' << h;
            EXPECT_GT(z, below) << "floors rise with the ground";
            EXPECT_LE(depth.ground_slope(z), depth.most_ground_slope() + 1e-12);
            below = z;
        }
    }
}

TEST(CrackNetwork, the_bend_bounds_how_the_slope_changes_between_kinks)
{
    for (const CrackDepth& depth : {CrackDepth{}, CrackDepth{0.9, 0.1, 0.05}, CrackDepth{0.3, 0.45, 0.01}, CrackDepth{0.3, 0.4, 0.0}}) {
        const std::array<double, 3> kinks = depth.kinks();
        const std::array<double, 5> ends{-0.5, kinks[0], kinks[1], kinks[2], 1.5};
        double tightest = 0.0;
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
            for (int part = 0; part < 16; ++part) {
                const double step = (ends[k + 1] - ends[k]) / 16.0, lo = ends[k] + step * part, hi = lo + step;
                const double bound = depth.ground_bend({lo, hi});
                for (int s = 0; s < 16; ++s) {
                    const double y = lo + step * (s + 0.25) / 16.0, z = y + step / 32.0;
                    const double change = std::abs(depth.ground_slope(y) - depth.ground_slope(z)) / (z - y);
                    EXPECT_LE(change, bound * (1.0 + 1e-6) + 1e-9) << y;
                    if (bound > 0.0) tightest = std::max(tightest, change / bound);
                }
            }
        }
        // A bound smaller by a twentieth would not hold.
        if (depth.epsilon > 0.0) {
            EXPECT_GT(tightest, 0.95);
        }
    }
}

TEST(CrackNetwork, nothing_cracks_where_the_height_is_zero_or_below)
{
    const CrackDepth depth{0.9, 0.4, 0.2};
    for (const double h : {0.0, -1e-300, -0.2, -5.0}) EXPECT_EQ(depth.floor(h), h);
    EXPECT_LT(depth.floor(1e-6), 1e-6);
}

TEST(CrackNetwork, distance_equals_that_to_explicit_segments_of_clipped_polygons)
{
    const std::vector<Vec2d> sites = golden_sites(200);
    const CrackOracle oracle(sites, {}, {});
    const VoronoiDiagram diagram(sites, kUnit);
    Numbers random(3);
    for (int k = 0; k < 4000; ++k) {
        const Vec2d p(random.between(-0.1, 1.1), random.between(-0.1, 1.1));
        ASSERT_NEAR(diagram.border_distance(p), oracle.distance(p), 1e-13) << p;
        std::uint32_t nearest = 0;
        for (std::uint32_t i = 1; i < sites.size(); ++i)
            if ((sites[i] - p).length2() < (sites[nearest] - p).length2()) nearest = i;
        ASSERT_EQ(diagram.nearest(p), nearest) << p;
    }
}

TEST(CrackNetwork, a_lattice_of_sites_has_square_cells)
{
    // Four cells meet at every corner: the library sees borders of no length there. Nine cells of a third, 12 borders, 4 corners with 2 triangles
    // each.
    std::vector<Vec2d> sites;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) sites.emplace_back((i + 0.5) / 4.0, (j + 0.5) / 4.0);
    const VoronoiDiagram diagram(sites, kUnit);
    EXPECT_EQ(diagram.edges().size(), 12u);
    EXPECT_EQ(diagram.triangles().size(), 8u);
    EXPECT_DOUBLE_EQ(diagram.border_distance({0.375, 0.375}), 0.125);
    EXPECT_NEAR(diagram.border_distance({0.26, 0.3}), 0.01, 1e-15);
}

TEST(CrackNetwork, one_site_has_no_cracks_and_equal_ones_count_once)
{
    const std::vector<Vec2d> sites{{0.5, 0.25}, {0.5, 0.25}};
    const VoronoiDiagram diagram(sites, kUnit);
    EXPECT_EQ(diagram.sites().size(), 1u);
    EXPECT_EQ(diagram.border_distance({0.1, 0.9}), kInfinity);
    EXPECT_TRUE(diagram.edges().empty());
    EXPECT_FALSE(CrackNetwork(diagram, 0.1).cracked({0.1, 0.9}));
}

TEST(CrackNetwork, triangles_cover_the_hull_and_their_circles_are_empty)
{
    const std::vector<Vec2d> sites = golden_sites(60);
    const VoronoiDiagram diagram(sites, kUnit);
    double area = 0.0;
    for (const auto& [a, b, c] : diagram.triangles()) {
        const Vec2d p = sites[a], u = sites[b] - p, v = sites[c] - p;
        const double twice = u.cross(v);
        ASSERT_GT(twice, 0.0);
        area += 0.5 * twice;
        const Vec2d centre = p + Vec2d(v.y * u.length2() - u.y * v.length2(), u.x * v.length2() - v.x * u.length2()) / (2.0 * twice);
        for (const Vec2d& q : sites) EXPECT_GE((q - centre).length(), (p - centre).length() - 1e-9);
    }
    // The hull by gift wrapping.
    double hull = 0.0;
    std::size_t at = 0;
    for (std::size_t k = 1; k < sites.size(); ++k)
        if (sites[k].x < sites[at].x) at = k;
    const std::size_t first = at;
    do {
        std::size_t next = at == 0 ? 1 : 0;
        for (std::size_t k = 0; k < sites.size(); ++k)
            if ((sites[next] - sites[at]).cross(sites[k] - sites[at]) < 0.0) next = k;
        hull += 0.5 * sites[at].cross(sites[next]);
        at = next;
    } while (at != first);
    EXPECT_NEAR(area, hull, 1e-12);
}

TEST(CrackNetwork, pieces_of_a_path_say_what_its_points_say)
{
    const CrackNetwork network = golden_network();
    Numbers random(11);
    int walls = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec2d origin(random.between(-0.2, 1.2), random.between(-0.2, 1.2)), direction(random.between(-1, 1), random.between(-1, 1));
        double at = -0.3;
        bool before = false;
        network.for_each_piece(origin, direction, -0.3, 1.7, [&](const CrackNetwork::Piece& piece) {
            EXPECT_EQ(piece.from, at);
            EXPECT_LT(piece.from, piece.to);
            const double middle = 0.5 * (piece.from + piece.to);
            if (piece.to - piece.from > 1e-9) {
                EXPECT_EQ(network.cracked(origin + direction * middle), piece.cracked);
            }
            if (at > -0.3) {
                EXPECT_EQ(piece.wall, piece.cracked != before);
            }
            if (piece.wall) {
                ++walls;
                EXPECT_NEAR(network.distance(origin + direction * piece.from), 0.5 * network.width(), 1e-12);
                EXPECT_NEAR(piece.into.length(), 1.0, 1e-15);
            }
            before = piece.cracked;
            at = piece.to;
            return true;
        });
        EXPECT_EQ(at, 1.7);
    }
    EXPECT_GT(walls, 20000);
}

TEST(CrackNetwork, a_wall_is_met_at_the_same_bits_wherever_a_path_begins)
{
    const CrackNetwork network = golden_network();
    Numbers random(12);
    for (int k = 0; k < 500; ++k) {
        const Vec2d origin(random(), random()), direction(random.between(-1, 1), random.between(-1, 1));
        std::vector<double> walls, again;
        network.for_each_piece(origin, direction, 0.0, 1.0,
                               [&](const CrackNetwork::Piece& p) { return p.wall ? walls.push_back(p.from), true : true; });
        for (double from = 0.0; from < 1.0; from += 0.125)
            network.for_each_piece(origin, direction, from - 1e-6, from + 0.125 + 1e-6, [&](const CrackNetwork::Piece& p) {
                if (p.wall && (again.empty() || p.from > again.back()) && p.from >= 0.0 && p.from <= 1.0) again.push_back(p.from);
                return true;
            });
        EXPECT_EQ(walls, again);
    }
}

double coverage(int n, SiteKind kind, int seeds)
{
    long torn = 0, all = 0;
    for (int seed = 0; seed < seeds; ++seed) {
        const CrackNetwork network(VoronoiDiagram(crack_sites(hash_cell(7, seed, n), n, kUnit, kind), crack_box(n, kUnit)), 0.1 / std::sqrt(n));
        constexpr int side = 300;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i, ++all) torn += network.cracked({(i + 0.5) / side, (j + 0.5) / side});
    }
    return static_cast<double>(torn) / static_cast<double>(all);
}

TEST(CrackNetwork, a_width_of_a_tenth_of_the_spacing_cracks_a_share_that_does_not_depend_on_n)
{
    // Random cells have 2 sqrt(n / area) of border an area, so bands of lambda = 0.1 cover 0.2 less what they share at their corners: 0.190 of
    // endless ground, less near a border.
    for (const int n : {100, 200, 300, 400, 600, 800}) EXPECT_NEAR(coverage(n, SiteKind::random, 24), 0.185, 0.004) << n;
}

TEST(CrackNetwork, even_sites_keep_farther_apart_than_random_ones)
{
    const auto closest = [](SiteKind kind) {
        std::vector<Vec2d> sites = crack_sites(5, 400, kUnit, kind);
        sites.resize(400);
        double least = kInfinity;
        for (std::size_t a = 0; a < sites.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) least = std::min(least, (sites[a] - sites[b]).length());
        return least;
    };
    // The best of 16 draws rarely falls within half the mean spacing of 0.05; two of 400 random ones nearly surely within a fiftieth of it.
    EXPECT_GT(closest(SiteKind::even), 0.02);
    EXPECT_LT(closest(SiteKind::random), 0.01);
}

TEST(CrackNetwork, more_random_sites_keep_those_there_were)
{
    const std::vector<Vec2d> few = crack_sites(9, 100, kUnit, SiteKind::random), many = crack_sites(9, 800, kUnit, SiteKind::random);
    EXPECT_TRUE(std::equal(few.begin(), few.begin() + 100, many.begin()));
    EXPECT_NE(few, crack_sites(10, 100, kUnit, SiteKind::random));
}

TEST(CrackNetwork, sites_of_the_rim_surround_the_ground_as_densely)
{
    const std::vector<Vec2d> sites = crack_sites(9, 400, kUnit, SiteKind::even);
    const Box2d box = crack_box(400, kUnit);
    // A quarter of 1/20 on each side: 1.025^2 - 1 = 0.050625 of the area.
    EXPECT_DOUBLE_EQ(box.size().x, 1.025);
    ASSERT_EQ(sites.size(), 420u);
    for (std::size_t k = 0; k < sites.size(); ++k) {
        EXPECT_EQ(kUnit.intersects(sites[k]), k < 400) << k;
        EXPECT_TRUE(box.intersects(sites[k])) << k;
    }
}

}  // namespace
}  // namespace hoodoo
