// Ray and triangle: known distances, edges without gaps, and the story of a hit.

#include "renderer/geometry/tracer.h"
#include "renderer/geometry/triangle.h"
#include "terrain/math/hash.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

TriangleMesh right_triangle()
{
    TriangleMesh mesh;
    mesh.origin = Vec3d(1000.0, 0.0, 0.0);
    mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

Ray down_at(double x, double y)
{
    Ray ray;
    ray.origin = Vec3d(x, y, 3.0);
    ray.direction = Vec3d(0, 0, -1);
    return ray;
}

TEST(Triangle, is_met_at_the_known_distance_with_the_weights_of_its_corners)
{
    const auto hit = intersect_triangle(right_triangle(), 0, down_at(1001.0, 2.0));
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->t, 3.0);
    EXPECT_EQ(hit->barycentric, Vec2d(0.25, 0.5));  // (1, 2) = 1/4 of (4, 0) + 1/2 of (0, 4)
    EXPECT_FALSE(intersect_triangle(right_triangle(), 0, down_at(1003.0, 2.0)).has_value());
}

TEST(Triangle, both_sides_and_the_open_interval_count)
{
    Ray ray = down_at(1001.0, 1.0);
    ray.origin.z = -3.0, ray.direction.z = 1.0;
    EXPECT_TRUE(intersect_triangle(right_triangle(), 0, ray).has_value());
    ray.t_max = 3.0;
    EXPECT_FALSE(intersect_triangle(right_triangle(), 0, ray).has_value());
    ray.t_max = kInfinity, ray.t_min = 3.0;
    EXPECT_FALSE(intersect_triangle(right_triangle(), 0, ray).has_value());
}

TEST(Triangle, without_area_is_never_met)
{
    TriangleMesh mesh = right_triangle();
    mesh.vertices[2] = Vec3f(8, 0, 0);
    for (const double x : {1000.0, 1001.0, 1004.0}) EXPECT_FALSE(intersect_triangle(mesh, 0, down_at(x, 0.0)).has_value());
}

TEST(Triangle, rays_aimed_at_shared_edges_and_corners_find_no_gap)
{
    // A fan about the z axis: a closed bowl seen from above. Every ray that passes inside its rim must meet it.
    TriangleMesh mesh;
    mesh.vertices.push_back(Vec3f(0.013f, 0.007f, -1.0f));
    constexpr int n = 17;
    for (int k = 0; k < n; ++k)
        mesh.vertices.push_back(
            Vec3f(static_cast<float>(std::cos(2 * M_PI * k / n)), static_cast<float>(std::sin(2 * M_PI * k / n)), 0.01f * static_cast<float>(k % 3)));
    for (std::uint32_t k = 0; k < n; ++k) mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % n});
    for (int i = 0; i < 20000; ++i) {
        const auto random = [&](int k) { return unit_real(hash_cell(4, i, k)); };
        const auto spoke = static_cast<std::size_t>(1 + random(0) * n);
        // A point of a spoke; or the centre itself.
        const Vec3d target = Vec3d(mesh.vertices[0]) + Vec3d(mesh.vertices[spoke] - mesh.vertices[0]) * (i % 10 == 0 ? 0.0 : 0.9 * random(1));
        Ray ray;
        ray.origin = Vec3d(0.4 * random(2) - 0.2, 0.4 * random(3) - 0.2, 2.0 + random(4));
        ray.direction = (target - ray.origin).normalized();
        bool met = false;
        for (std::size_t k = 0; k < n; ++k) met = met || intersect_triangle(mesh, k, ray).has_value();
        ASSERT_TRUE(met) << i;
    }
}

TEST(Triangle, the_story_of_a_hit_is_exact_whatever_the_tracer_rounded)
{
    TriangleMesh mesh = right_triangle();
    mesh.normals = {Vec3f(0, 0, 1), Vec3f(0.6f, 0, 0.8f), Vec3f(0, 0, 1)};
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    const Ray ray = down_at(1001.0, 2.0);
    // What a tracer in single precision may have found: a little off.
    const Interaction at = interact_triangle(mesh, 0, ray, {3.0001, Vec2d(0.2501, 0.4999)}, 1e-3);
    EXPECT_EQ(at.t, 3.0);
    EXPECT_EQ(at.position, Vec3d(1001.0, 2.0, 0.0));
    EXPECT_EQ(at.geometric_normal, Vec3d(0, 0, 1));
    EXPECT_EQ(at.uv, Vec2d(0.25, 0.5));
    EXPECT_LT(at.position_error, 1e-11);
    EXPECT_GT(at.spawn_offset, 1e-3);  // the tracer's own error, not only ours
    // 3/4 of (0, 0, 1) and 1/4 of (0.6, 0, 0.8): (0.15, 0, 0.95), normalised.
    EXPECT_NEAR(at.shading_normal.x, 0.15 / std::sqrt(0.15 * 0.15 + 0.95 * 0.95), 1e-7);
    ASSERT_EQ(at.materials.count, 1u);
}

TEST(Tracer, weights_of_a_hit_mean_the_same_corners_in_embree_and_in_the_loop)
{
    std::vector<Shape> shapes;
    shapes.emplace_back(right_triangle());
    const TraceHit a = make_embree_tracer(shapes)->intersect(down_at(1001.0, 2.0)),
                   b = make_brute_force_tracer(shapes)->intersect(down_at(1001.0, 2.0));
    ASSERT_TRUE(a.valid && b.valid);
    EXPECT_NEAR(a.barycentric.x, b.barycentric.x, 1e-5);
    EXPECT_NEAR(a.barycentric.y, b.barycentric.y, 1e-5);
}

}  // namespace
}  // namespace hoodoo
