// Triplanar weights against the golden values, right planes, and bumped normals against finite geometry.
#include "renderer/shading/triplanar.h"

#include "terrain/math/hash.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

using namespace hoodoo;

namespace
{

Vec3d random_unit(int i)
{
    const double z = 2.0 * unit_real(hash_cell(1, i, 0)) - 1.0, a = 6.283185307179586 * unit_real(hash_cell(1, i, 1)), r = std::sqrt(1.0 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

}  // namespace

TEST(Triplanar, weights_are_the_golden_ones_for_exponent_8)
{
    std::ifstream file(std::string(HOODOO_SOURCE_DIR) + "/tests/golden/a_arches.json");
    const auto cases = nlohmann::json::parse(file).at("triplanar");
    ASSERT_GE(cases.size(), 5u);
    for (const auto& c : cases) {
        const Vec3d n(c["n"][0], c["n"][1], c["n"][2]);
        const Vec3d w = triplanar_weights(n, 8.0);
        for (unsigned k = 0; k < 3; ++k) EXPECT_NEAR(w[k], c["fixed"][k].get<double>(), 1e-13) << n;
    }
}

TEST(Triplanar, weights_sum_to_one_and_ignore_signs_at_any_exponent)
{
    for (int i = 0; i < 1000; ++i)
        for (const double p : {1.0, 2.0, 8.0, 64.0}) {
            const Vec3d n = random_unit(i), w = triplanar_weights(n, p);
            EXPECT_NEAR(w.x + w.y + w.z, 1.0, 1e-14);
            EXPECT_EQ(w, triplanar_weights(-n, p));
            EXPECT_GE(std::min({w.x, w.y, w.z}), 0.0);
        }
}

TEST(Triplanar, lookup_weights_leave_out_what_cannot_be_seen_without_a_jump)
{
    // Along an arc from z to x the change between neighbouring directions stays of the order of the step: no projection appears or goes in a jump.
    Vec3d before = triplanar_lookup_weights(Vec3d(0, 0, 1), 8.0);
    EXPECT_EQ(before, Vec3d(0, 0, 1));
    constexpr int steps = 10000;
    for (int i = 1; i <= steps; ++i) {
        const double a = 1.5707963267948966 * i / steps;
        const Vec3d w = triplanar_lookup_weights(Vec3d(std::sin(a), 0.0, std::cos(a)), 8.0);
        EXPECT_NEAR(w.x + w.y + w.z, 1.0, 1e-14);
        EXPECT_LT((w - before).length(), 10.0 * 1.5707963267948966 / steps);  // d/da of t^8/(1+t^8) is at most 4 at 45 degrees, times sqrt 2
        before = w;
    }
}

TEST(Triplanar, each_axis_projects_the_plane_of_the_other_two_unmirrored)
{
    const Vec3d p(-1.0, 2.0, -3.0);
    EXPECT_EQ(triplanar_coordinates(p, 0), Vec2d(2, -3));
    EXPECT_EQ(triplanar_coordinates(p, 1), Vec2d(-1, -3));
    EXPECT_EQ(triplanar_coordinates(p, 2), Vec2d(-1, 2));
}

TEST(Triplanar, bump_on_each_plane_tilts_the_normal_down_the_slope_whichever_way_it_faces)
{
    // A height that grows along +y by 1/2 a metre on a surface facing +-x, +-z: the normal of x = h(y) is (1, -h', 0) / sqrt(1 + h'^2), and
    // mirrored for the other side. Along the plane's first or second axis, by the table of axes.
    const double h = 0.5, norm = std::sqrt(1.0 + h * h);
    for (const double side : {1.0, -1.0}) {
        const Vec3d x(side, 0, 0), z(0, 0, side), y(0, side, 0);
        EXPECT_LT((bumped_normal(x, triplanar_gradient({h, 0.0}, 0), x) - Vec3d(side, -h, 0.0) / norm).length(), 1e-15);
        EXPECT_LT((bumped_normal(x, triplanar_gradient({0.0, h}, 0), x) - Vec3d(side, 0.0, -h) / norm).length(), 1e-15);
        EXPECT_LT((bumped_normal(y, triplanar_gradient({h, 0.0}, 1), y) - Vec3d(-h, side, 0.0) / norm).length(), 1e-15);
        EXPECT_LT((bumped_normal(z, triplanar_gradient({0.0, h}, 2), z) - Vec3d(0.0, -h, side) / norm).length(), 1e-15);
    }
}

TEST(Triplanar, bumped_normals_stay_unit_and_on_the_side_of_the_geometric_normal)
{
    for (int i = 0; i < 1000; ++i) {
        const Vec3d n = random_unit(i), g = random_unit(i + 5000) * (20.0 * unit_real(hash_cell(2, i, 0)));
        const Vec3d b = bumped_normal(n, g, n);
        EXPECT_NEAR(b.length(), 1.0, 1e-12);
        EXPECT_GE(b.dot(n), 0.0499);
    }
}
