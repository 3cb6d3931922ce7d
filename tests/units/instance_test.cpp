// Instances of meshes: scaled, turned and moved; met by both tracers; told about in world space, textured in their own.

#include "renderer/geometry/instance.h"
#include "renderer/geometry/tracer.h"
#include "renderer/shading/look.h"
#include "renderer/transport/path.h"
#include "terrain/math/hash.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/mesh_surface.h"
#include "tests/support/surface_laws.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// The unit square z = 0 seen from above, as two triangles.
TriangleMesh square()
{
    TriangleMesh mesh;
    mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Instance placed(const Vec3d& position, const Vec3d& axis, double angle, float scale)
{
    Instance instance;
    instance.position = position;
    instance.rotation = Imath::Quatf().setAxisAngle(Vec3f(axis.normalized()), static_cast<float>(angle));
    instance.scale = scale;
    return instance;
}

std::vector<Shape> one(Instances instances)
{
    std::vector<Shape> shapes;
    shapes.emplace_back(std::move(instances));
    return shapes;
}

TEST(Instance, is_scaled_then_turned_then_moved)
{
    // A quarter turn about x takes z to -y: the square of half-width 3 stands in the plane y = 20, its front towards -y.
    Instances instances;
    instances.meshes = {square()};
    instances.instances = {placed({10, 20, 30}, {1, 0, 0}, M_PI / 2, 3.0f)};
    instances.instances[0].id = 7;
    const std::vector<Shape> shapes = one(std::move(instances));
    Ray ray;
    ray.origin = Vec3d(11, 0, 32);
    ray.direction = Vec3d(0, 1, 0);
    for (const auto& tracer : {make_embree_tracer(shapes), make_brute_force_tracer(shapes)}) {
        const TraceHit hit = tracer->intersect(ray);
        ASSERT_TRUE(hit.valid);
        EXPECT_EQ(hit.instance, 0u);
        const Interaction at = tracer->interact(ray, hit);
        EXPECT_NEAR(at.t, 20.0, 1e-6);
        EXPECT_NEAR((at.position - Vec3d(11, 20, 32)).length(), 0.0, 1e-6);
        EXPECT_NEAR((at.geometric_normal - Vec3d(0, -1, 0)).length(), 0.0, 1e-6);
        EXPECT_EQ(at.instance, 7u);
        EXPECT_TRUE(tracer->occluded(ray));
        ray.t_max = 19.9;
        EXPECT_FALSE(tracer->intersect(ray).valid);
        EXPECT_FALSE(tracer->occluded(ray));
        ray.t_max = kInfinity;
    }
}

/// Many turned and scaled copies of the catalogue's rocks.
Instances tumbled(const Vec3d& shift)
{
    BuiltRow built =
        build_row(*std::find_if(row_instances().begin(), row_instances().end(), [](const RowInstance& row) { return row.name == "rock_pile"; }));
    Instances rocks = std::move(std::get<Instances>(*built.shape));
    for (std::size_t k = 0; k < rocks.instances.size(); ++k) {
        const auto u = [&](int n) { return unit_real(hash_cell(4, static_cast<std::int64_t>(k), n)); };
        const Instance old = rocks.instances[k];
        rocks.instances[k] =
            placed(old.position * 2.0 + shift, Vec3d(u(0) - 0.5, u(1) - 0.5, u(2) - 0.5), 6.0 * u(3), static_cast<float>(0.5 + u(4)));
        rocks.instances[k].mesh = old.mesh;
        rocks.instances[k].id = old.id;
        rocks.instances[k].seed = old.seed;
    }
    return rocks;
}

TEST(Instance, tumbled_rocks_are_met_like_the_same_triangles_in_one_mesh)
{
    for (const Vec3d& shift : {Vec3d(0.0), Vec3d(4e6, 3e6, 1000.0)}) {
        Instances rocks = tumbled(shift);
        const TriangleMesh flat = flattened(rocks);
        const MeshSurface surface(flat);
        const std::vector<Ray> rays = law_rays(surface, 3, 1500);
        const std::vector<Shape> shapes = one(std::move(rocks));
        const auto embree = make_embree_tracer(shapes);
        int hits = 0, odd = 0;
        for (const Ray& ray : rays) {
            Ray any = ray;
            any.crossing = Crossing::any;
            const Hit expected = nearest_hit(surface, any);
            const TraceHit hit = embree->intersect(any);
            hits += hit.valid;
            // The flat mesh's vertices are rounded to single precision about the first rock: 10 m / 2^24; near silhouettes that decides.
            odd += hit.valid != std::isfinite(expected.t) || (hit.valid && std::abs(hit.t - expected.t) > 1e-4);
            if (!hit.valid) continue;
            const Interaction at = embree->interact(any, hit);
            ASSERT_NEAR(at.geometric_normal.length(), 1.0, 1e-9);
            ASSERT_GT(at.geometric_normal.dot(at.shading_normal), 0.0);
            ASSERT_LE((at.position - any.at(hit.t)).length(), at.position_error + 1e-9 * (1.0 + shift.length()));
        }
        EXPECT_GT(hits, 500);
        EXPECT_LE(odd, 8);
    }
}

TEST(Instance, a_ray_that_leaves_a_rock_is_not_stopped_by_it)
{
    for (const Vec3d& shift : {Vec3d(0.0), Vec3d(4e6, 3e6, 1000.0)}) {
        const std::vector<Shape> shapes = one(tumbled(shift));
        const auto tracer = make_embree_tracer(shapes);
        const TriangleMesh flat = flattened(std::get<Instances>(shapes[0]));
        int spawned = 0;
        for (const Ray& ray : law_rays(MeshSurface(flat), 4, 1500)) {
            const TraceHit hit = tracer->intersect(ray);
            if (!hit.valid) continue;
            const Interaction at = tracer->interact(ray, hit);
            Ray out;
            out.origin = at.position + at.geometric_normal * at.spawn_offset;
            out.direction = at.geometric_normal;
            out.t_max = 10.0 * at.spawn_offset;
            EXPECT_FALSE(tracer->occluded(out));
            ++spawned;
        }
        EXPECT_GT(spawned, 500);
    }
}

TEST(Instance, a_texture_turns_and_moves_with_the_rock)
{
    Instances still, turned;
    still.meshes = turned.meshes = {square()};
    still.instances = {placed(Vec3d(0.0), {0, 0, 1}, 0.0, 2.0f)};
    turned.instances = {placed({5, 6, 7}, {1, 2, 3}, 1.1, 2.0f)};
    still.instances[0].id = turned.instances[0].id = 1;
    still.instances[0].seed = turned.instances[0].seed = 99;
    const auto look = default_look("rock", {});
    for (int n = 0; n < 20; ++n) {
        const double b1 = 0.04 * n, b2 = 0.1;
        Ray down;
        down.origin = Vec3d(0, 0, 1);
        down.direction = Vec3d(0, 0, -1);
        const TriangleHit found{1.0, {b1, b2}};
        // The same place of the mesh, asked with error 0: the barycentric coordinates decide.
        const Interaction a = interact_instance(still, 0, 0, down, found, 0.0), b = interact_instance(turned, 0, 0, down, found, 0.0);
        EXPECT_NEAR((a.texture_point - b.texture_point).length(), 0.0, 1e-9);
        const Appearance x = look->appearance(a, 0.001), y = look->appearance(b, 0.001);
        EXPECT_NEAR((x.albedo - y.albedo).length(), 0.0, 1e-6);
        // Relief too: the bumped normal leans the same way relative to the rock.
        EXPECT_NEAR((rotated(b.texture_to_world, x.normal) - y.normal).length(), 0.0, 1e-5);
    }
}

TEST(Instance, neighbours_of_one_mesh_differ_in_tint_and_only_instances_are_tinted)
{
    Instances rocks;
    rocks.meshes = {square()};
    const auto look = default_look("rock", {});
    Ray down;
    down.origin = Vec3d(0, 0, 1);
    down.direction = Vec3d(0, 0, -1);
    float least = 1.0f, most = 0.0f;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        rocks.instances = {placed(Vec3d(0.0), {0, 0, 1}, 0.0, 1.0f)};
        rocks.instances[0].seed = seed;
        rocks.instances[0].id = 1;
        Interaction at = interact_instance(rocks, 0, 0, down, {1.0, {0.3, 0.3}}, 0.0);
        at.texture_point = Vec3d(0.0);  // the same place of the texture: what differs is the tint
        const Appearance tinted = look->appearance(at, 1.0);
        least = std::min(least, tinted.albedo.y), most = std::max(most, tinted.albedo.y);
        at.instance = 0;
        EXPECT_EQ(look->appearance(at, 1.0).albedo, (at.look_seed = 0, look->appearance(at, 1.0).albedo));
    }
    // A factor in [0.75, 1.25]: 40 draws come within a tenth of both ends but once in 1e3 ... the seeds are fixed.
    EXPECT_GT(most / least, 1.4f);
    EXPECT_LT(most / least, 1.25f / 0.75f + 1e-3f);
}

}  // namespace
}  // namespace hoodoo
