// Swept tools against the definition of their solids, and what a scene can get wrong.
#include "terrain/edit/sweep.h"

#include "terrain/edit/tools.h"
#include "terrain/error.h"
#include "tests/counts.h"
#include "tests/edits.h"
#include "tests/stacks.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using Column = std::vector<Layer>;
using testing::edit;
using testing::error_of;
using testing::list;
using testing::table;
using testing::tables;

MaterialStack block(int n, double cell, double unit, std::int32_t top, Vec3d origin = Vec3d(0.0))
{
    MaterialStack stack({n, n}, cell, unit, origin);
    stack.set_columns({0, 0}, {n, n}, std::vector<Column>(static_cast<std::size_t>(n * n), {{Material::bedrock, top}}));
    return stack;
}

bool is_matter(const MaterialStack& stack, int i, int j, double z)
{
    for (const Layer& layer : stack.column(i, j)) {
        if (z < layer.top) return layer.material != Material::air;
    }
    return false;
}

double air_below(const MaterialStack& stack, double top_units)
{
    double volume = 0.0;
    for (int j = 0; j < stack.size().y; ++j) {
        for (int i = 0; i < stack.size().x; ++i) {
            double matter = 0.0, below = 0.0;
            for (const Layer& layer : stack.column(i, j)) {
                if (layer.material != Material::air) matter += layer.top - below;
                below = layer.top;
            }
            volume += (top_units - matter) * stack.unit() * stack.cell() * stack.cell();
        }
    }
    return volume;
}

TEST(ProfileCurve, passes_through_its_control_points_and_is_linear_in_them)
{
    const std::vector<Vec2d> one = {{0, 0}, {2, -1}, {3, 4}, {-1, 2}}, other = {{1, 1}, {5, 0}, {2, 2}, {0, 7}};
    std::vector<Vec2d> mean;
    for (std::size_t k = 0; k < 4; ++k) mean.push_back((one[k] + other[k]) * 0.5);
    const Profile2 a = closed_spline(one, 64), b = closed_spline(other, 64), m = closed_spline(mean, 64);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((a[16 * k] - one[k]).length(), 1e-15);
    for (std::size_t k = 0; k < 64; ++k) EXPECT_LT((m[k] - (a[k] + b[k]) * 0.5).length(), 1e-14);
    // Half way between its second and third point: (9 (2,-1) + 9 (3,4) - (0,0) - (-1,2)) / 16.
    EXPECT_LT((a[24] - Vec2d((9 * 5 + 1) / 16.0, (9 * 3 - 2) / 16.0)).length(), 1e-15);
}

TEST(Skeleton, frames_carried_along_a_helix_turn_as_its_torsion_says)
{
    // The rotation-minimising normal turns against the Frenet normal by minus the torsion: for (a cos s, a sin s, b s) by b / sqrt(a^2 + b^2) a
    // radian.
    const double a = 5.0, b = 2.0, c = std::sqrt(a * a + b * b);
    SkeletonPath path(401);
    for (std::size_t k = 0; k < path.size(); ++k) {
        const double s = 0.01 * static_cast<double>(k);
        path[k].at = Vec3d(a * std::cos(s), a * std::sin(s), b * s);
    }
    frame_minimally(path, Vec3d(-1, 0, 0));
    for (const std::size_t k : {100u, 200u, 390u}) {
        const double s = 0.01 * static_cast<double>(k);
        const Vec3d frenet(-std::cos(s), -std::sin(s), 0), tangent = Vec3d(-a * std::sin(s), a * std::cos(s), b) / c;
        const double turned = std::atan2(path[k].normal.dot(tangent.cross(frenet)), path[k].normal.dot(frenet));
        EXPECT_NEAR(turned, -s * b / c, 2e-3);
        EXPECT_NEAR(path[k].normal.length(), 1.0, 1e-12);
        EXPECT_NEAR(path[k].normal.dot(path[k].tangent), 0.0, 1e-12);
    }
}

TEST(Skeleton, arcs_pass_through_their_nodes)
{
    const Skeleton skeleton{{Vec3d(0, 0, 0), Vec3d(10, 0, 0), Vec3d(12, 5, 1), Vec3d(12, 30, 0)}, {{0, 1, 2, 3}}};
    for (const bool smooth : {true, false}) {
        const SkeletonPath path = arc_steps(skeleton, 0, 0.5, smooth);
        std::size_t nodes = 0;
        for (std::size_t k = 0; k < path.size(); ++k) {
            if (path[k].node != std::floor(path[k].node)) continue;
            EXPECT_EQ(path[k].at, skeleton.nodes[static_cast<std::size_t>(path[k].node)]);
            ++nodes;
        }
        EXPECT_EQ(nodes, 4u);
        for (std::size_t k = 1; k < path.size(); ++k) EXPECT_LT((path[k].at - path[k - 1].at).length(), 1.0);
    }
}

/// Inside by the definition: F* of the straight skeleton from `a` along +y, that is the even-odd rule in the section.
bool inside_section(const Profile2& profile, const Vec2d& p)
{
    bool inside = false;
    for (std::size_t k = 0; k < profile.size(); ++k) {
        const Vec2d &a = profile[k], &b = profile[(k + 1) % profile.size()];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    return inside;
}

TEST(Sweep, carves_a_section_that_is_not_convex_and_changes_along_the_way)
{
    // A horseshoe that becomes a flat one over 12 m along y. At y the section is the mean of both, in proportion.
    const std::vector<Vec2d> horseshoe = {{-4, -3}, {-4, 4}, {4, 4}, {4, -3}, {2.5, -3}, {2.5, 2}, {-2.5, 2}, {-2.5, -3}};
    std::vector<Vec2d> flat;
    for (const Vec2d& p : horseshoe) flat.emplace_back(p.x, 0.4 * p.y);
    const auto curve = [](const std::vector<Vec2d>& points) {
        Node::Array numbers;
        for (const Vec2d& p : points) numbers.push_back(testing::number(p.x)), numbers.push_back(testing::number(p.y));
        Node node;
        node.value = std::move(numbers);
        return node;
    };
    MaterialStack stack = block(80, 0.25, 0.01, 2000);
    edit(stack, "sweep",
         table({{"profile", tables({table({{"name", "tall"}, {"curve", curve(horseshoe)}}), table({{"name", "low"}, {"curve", curve(flat)}})})},
                {"node",
                 tables({table({{"name", "a"}, {"at", {10.1, 4.0, 10.0}}}), table({{"name", "b"}, {"at", {10.1, 16.0, 10.0}}, {"profile", "low"}})})},
                {"arc", tables({table({{"nodes", list({"a", "b"})}})})},
                {"ends", "flat"}}));
    const Profile2 tall = closed_spline(horseshoe, 64), low = closed_spline(flat, 64);
    int carved = 0, wrong = 0, all = 0;
    for (int j = 0; j < 80; ++j) {
        for (int i = 0; i < 80; ++i) {
            for (int k = 3; k < 2000; k += 25) {
                const Vec3d p((i + 0.5) * 0.25, (j + 0.5) * 0.25, (k + 0.5) * 0.01);
                const double u = (p.y - 4.0) / 12.0;
                bool expected = false;
                if (u > 0.0 && u < 1.0) {
                    Profile2 section;
                    for (std::size_t c = 0; c < 64; ++c) section.push_back(tall[c] + (low[c] - tall[c]) * u);
                    expected = inside_section(section, Vec2d(p.x - 10.1, p.z - 10.0));
                }
                const bool air = !is_matter(stack, i, j, k + 0.5);
                carved += air, wrong += air != expected, ++all;
            }
        }
    }
    EXPECT_GT(carved, 5000);
    // Triangles instead of ruled patches between rings 0.3 m apart, and whole units: next to nothing.
    EXPECT_LT(wrong, carved / 200);
}

TEST(Sweep, a_round_tool_has_the_volume_of_a_capsule_and_a_ball_that_of_a_ball)
{
    MaterialStack stack = block(80, 0.25, 0.01, 2000), ball = stack;
    const ColumnSet changed = edit(stack, "sweep", table({{"points", list({{6.0, 10.0, 10.0}, {14.0, 10.0, 10.0}})}, {"radius", {3.0}}}));
    // 64 corners instead of a circle: an area of 0.9984 of it; 8 rings to an end: less than 1 % of a ball.
    EXPECT_NEAR(air_below(stack, 2000), M_PI * 9 * 8 + 4.0 / 3.0 * M_PI * 27, 3.0);
    EXPECT_NEAR(static_cast<double>(changed.count()), (6 * 8 + M_PI * 9) * 16, 20.0);
    EXPECT_NEAR(stack.column(40, 40)[0].top, 700, 1);
    edit(ball, "sweep", table({{"points", list({{10.0, 10.0, 10.0}})}, {"radius", {5.0}}}));
    EXPECT_NEAR(air_below(ball, 2000), 4.0 / 3.0 * M_PI * 125, 8.0);
}

TEST(Sweep, bends_and_branches_are_whole)
{
    // Inside is what lies nearer to the skeleton than the radius. Two arcs that meet at a right angle, and a bend as sharp.
    const Vec3d a(4, 4, 8), b(12, 4, 8), c(12, 12, 8), d(20, 4, 8);
    MaterialStack branch = block(96, 0.25, 0.01, 1600), bend = branch;
    const auto node = [](const char* name, const Vec3d& p) { return table({{"name", name}, {"at", {p.x, p.y, p.z}}}); };
    edit(branch, "sweep",
         table({{"profile", tables({table({{"width", 4.0}})})},
                {"node", tables({node("a", a), node("b", b), node("c", c), node("d", d)})},
                {"arc", tables({table({{"nodes", list({"a", "b", "d"})}}), table({{"nodes", list({"b", "c"})}})})}}));
    edit(bend, "sweep",
         table({{"points", list({{4.0, 4.0, 8.0}, {12.0, 4.0, 8.0}, {12.0, 12.0, 8.0}})}, {"radius", {2.0}}, {"smooth", testing::flag(false)}}));
    const auto away = [](const Vec3d& p, const Vec3d& from, const Vec3d& to) {
        const double u = std::clamp((p - from).dot(to - from) / (to - from).dot(to - from), 0.0, 1.0);
        return (p - from - (to - from) * u).length();
    };
    int checked = 0;
    for (int j = 0; j < 96; ++j) {
        for (int i = 0; i < 96; ++i) {
            for (int k = 7; k < 1600; k += 50) {
                const Vec3d p((i + 0.5) * 0.25, (j + 0.5) * 0.25, (k + 0.5) * 0.01);
                const double of_bend = std::min(away(p, a, b), away(p, b, c)), of_branch = std::min(of_bend, away(p, b, d));
                if (std::abs(of_branch - 2.0) > 0.06) {
                    EXPECT_EQ(!is_matter(branch, i, j, k + 0.5), of_branch < 2.0) << p;
                    ++checked;
                }
                if (std::abs(of_bend - 2.0) > 0.06) {
                    EXPECT_EQ(!is_matter(bend, i, j, k + 0.5), of_bend < 2.0) << p;
                }
            }
        }
    }
    EXPECT_GT(checked, 100000);
}

TEST(Sweep, lays_cracks_onto_the_surface_but_not_tunnels)
{
    // A slope of one in two. The skeleton is drawn in the plane at z = 30; a ravine two metres deep follows the ground, a tunnel there meets air
    // alone.
    MaterialStack stack({60, 40}, 0.5, 0.01);
    for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 60; ++i) stack.set_column(i, j, Column{{Material::bedrock, 500 + 25 * i}});
    MaterialStack tunnel = stack;
    const auto tool = [](bool project) {
        return table({{"points", list({{5.0, 10.0, 30.0}, {25.0, 10.0, 30.0}})},
                      {"profile", tables({table({{"curve", {-1.5, 1.0, 1.5, 1.0, 0.6, -2.0, -0.6, -2.0}}})})},
                      {"project", testing::flag(project)}});
    };
    EXPECT_TRUE(edit(tunnel, "sweep", tool(false)).empty());
    edit(stack, "sweep", tool(true));
    for (int i = 14; i < 46; ++i) {
        // The section stands across the slope: 2 m along the normal are 2 / cos(atan 1/2) = 2.236 m down. Catmull-Rom bulges below its lowest points.
        const double ground = 500 + 25 * i, depth = ground - stack.column(i, 19)[0].top;
        EXPECT_GT(depth, 200) << i;
        EXPECT_LT(depth, 270) << i;
        EXPECT_EQ(stack.column(i, 0), (Column{{Material::bedrock, 500 + 25 * i}}));
    }
}

TEST(Sweep, puts_an_arch_into_the_air_and_takes_only_what_it_may)
{
    MaterialStack stack = block(40, 0.5, 0.01, 500);
    edit(stack, "sweep", table({{"points", list({{4.0, 10.0, 4.0}, {10.0, 10.0, 12.0}, {16.0, 10.0, 4.0}})}, {"radius", {1.0}}, {"mode", "add"}}));
    const Column top = stack.column(20, 20);
    ASSERT_EQ(top.size(), 3u);
    EXPECT_EQ(top[1], (Layer{Material::air, top[1].top}));
    EXPECT_NEAR(top[1].top, 1100, 30);
    EXPECT_NEAR(top[2].top, 1300, 30);

    MaterialStack sandy({20, 20}, 1.0, 0.01);
    sandy.set_columns({0, 0}, {20, 20}, std::vector<Column>(400, {{Material::bedrock, 1000}, {Material::sand, 1200}}));
    edit(sandy, "sweep",
         table({{"points", list({{5.0, 10.0, 10.0}, {15.0, 10.0, 10.0}})},
                {"radius", {1.5}},
                {"removes", list({"bedrock"})},
                {"stabilise", testing::flag(false)}}));
    std::int32_t sand = 0, below = 0;
    for (const Layer& layer : sandy.column(10, 10)) {
        if (layer.material == Material::sand) sand += layer.top - below;
        below = layer.top;
    }
    EXPECT_EQ(sand, 200);
}

TEST(Sweep, rough_walls_move_by_no_more_than_their_share_and_depend_on_the_name)
{
    MaterialStack stack = block(64, 0.25, 0.01, 2000), least = stack, most = stack, other = stack;
    const auto tool = [](double radius, double roughness) {
        return table({{"points", list({{8.0, 8.0, 10.0}})}, {"radius", {radius}}, {"roughness", roughness}, {"wavelength", 2.0}});
    };
    edit(stack, "sweep", tool(4.0, 0.25));
    edit(other, "sweep", tool(4.0, 0.25), 1);
    edit(least, "sweep", tool(2.95, 0.0));
    edit(most, "sweep", tool(5.05, 0.0));
    int different = 0;
    for (int j = 0; j < 64; ++j) {
        for (int i = 0; i < 64; ++i) {
            different += stack.column(i, j) != other.column(i, j);
            for (int k = 10; k < 2000; k += 20) {
                if (is_matter(stack, i, j, k)) {
                    EXPECT_TRUE(is_matter(least, i, j, k));
                } else {
                    EXPECT_FALSE(is_matter(most, i, j, k));
                }
            }
        }
    }
    EXPECT_GT(different, 300);
}

TEST(Sweep, says_what_cannot_be)
{
    MaterialStack stack = block(20, 1.0, 0.01, 1000);
    const MaterialStack before = stack;
    const auto message = [&](const Node& entries) { return error_of([&] { edit(stack, "sweep", entries); }); };
    const auto path = [](std::initializer_list<testing::Item> points) { return table({{"points", list(points)}, {"radius", {1.0}}}); };
    EXPECT_EQ(message(table({{"points", list({{2.0, 2.0, 5.0}})}, {"profile", tables({table({{"curve", {0.0, 1.0, 1.0, 1.0}}})})}})),
              "curve of a profile, expected at least 3 points, x and y of each in turn, got 2 points");
    EXPECT_EQ(message(table({{"points", list({{2.0, 2.0, 5.0}})}, {"profile", tables({table({{"curve", {0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 1.0}}})})}})),
              "curve of a profile, expected at least 3 points, x and y of each in turn, got 7 numbers");
    EXPECT_EQ(message(table({{"points", list({{2.0, 2.0, 5.0}})}, {"radius", {-1.0}}})).substr(0, 44),
              "radius is out of range, expected a list of 1");
    EXPECT_EQ(message(path({{2.0, 2.0, 5.0}, {18.0, 18.0, 5.0}, {18.0, 2.0, 5.0}, {2.0, 18.0, 5.0}})).substr(0, 73),
              "the skeleton crosses itself, expected a node there, or another way, got (");
    EXPECT_EQ(message(path({{2.0, 2.0, 5.0}, {8.0, 2.0, 5.0}, {4.0, 2.0, 5.0}})).substr(0, 27), "the skeleton crosses itself");
    EXPECT_EQ(message(path({{2.0, 2.0, 5.0}, {2.0, 2.0, 5.0}})),
              "two neighbouring nodes of a sweep lie at one place, expected places apart, got (2, 2, 5) m");
    // A polygon of 64 corners with a circle's area is 1.0008 times as wide.
    EXPECT_EQ(message(path({{40.0, 2.0, 5.0}, {50.0, 2.0, 5.0}})),
              "the tool lies outside the terrain, expected a part of it within x in [0, 20], y in [0, 20], z in [0, 81.91] m, got x in "
              "[38.9992, 51.0008], y in [0.999196, 3.0008], z in [3.9992, 6.0008] m");
    EXPECT_EQ(message(table({{"points", list({{2.0, 2.0, 5.0}})}})),
              "cross section of a sweep, expected profiles, or with points a radius instead, got neither");
    EXPECT_EQ(message(table({{"points", list({{2.0, 2.0, 5.0}, {5.0, 2.0, 5.0}, {5.0, 7.0, 5.0}})}, {"radius", {1.0, 2.0}}})),
              "radii of a sweep, expected one, or one for each of the 3 points, got 2");
    EXPECT_EQ(
        message(table({{"profile", tables({table({{"width", 2.0}})})},
                       {"node", tables({table({{"name", "near"}, {"at", {2.0, 2.0, 5.0}}}), table({{"name", "far"}, {"at", {9.0, 2.0, 5.0}}})})},
                       {"arc", tables({table({{"nodes", list({"near", "fat"})}})})}})),
        "no node has this name, got \"fat\" (did you mean \"far\")");
    EXPECT_EQ(message(table({{"profile", tables({table({{"width", 2.0}})})},
                             {"node", tables({table({{"name", "a"}, {"at", {2.0, 2.0, 5.0}}}), table({{"name", "b"}, {"at", {9.0, 9.0, 5.0}}}),
                                              table({{"name", "c"}, {"at", {2.0, 9.0, 5.0}}}), table({{"name", "d"}, {"at", {9.0, 2.0, 5.0}}})})},
                             {"arc", tables({table({{"nodes", list({"a", "b"})}}), table({{"nodes", list({"c", "d"})}})})}})),
              "the skeleton crosses itself, expected a common node where arcs meet, got arcs 0 and 1 at (5.5, 5.5, 5) m");
    const Node high = table({{"points", list({{10.5, 10.5, 81.0}})}, {"radius", {3.0}}, {"mode", "add"}});
    EXPECT_EQ(message(high).substr(0, 66), "column (10, 10) would rise over the stack's height range, expected");
    for (int j = 0; j < 20; ++j)
        for (int i = 0; i < 20; ++i) EXPECT_EQ(stack.column(i, j), before.column(i, j));
}

TEST(Sweep, leaves_columns_alone_that_it_only_meets_in_air)
{
    MaterialStack stack({5, 5}, 1.0, 0.1);
    const Column floating = {{Material::bedrock, 10}, {Material::air, 90}, {Material::rock, 100}};
    stack.set_columns({0, 0}, {5, 5}, std::vector<Column>(25, floating));
    EXPECT_TRUE(edit(stack, "sweep", table({{"points", list({{2.5, 2.5, 5.0}})}, {"radius", {2.0}}})).empty());
    EXPECT_EQ(stack.column(2, 2), floating);
}

}  // namespace
}  // namespace hoodoo
