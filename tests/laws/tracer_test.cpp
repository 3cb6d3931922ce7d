// The tracer: its gate, Embree against the loop over everything, watertightness, and the company of other shapes.

#include "renderer/geometry/tracer.h"
#include "renderer/scene/read.h"
#include "terrain/math/hash.h"
#include "tests/counts.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/surface_laws.h"
#include "tests/support/test_rays.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

std::vector<Shape> shapes_of(BuiltRow built)
{
    std::vector<Shape> shapes;
    shapes.push_back(std::move(*built.shape));
    return shapes;
}

const RowInstance& instance_named(const std::string& name)
{
    for (const RowInstance& i : row_instances())
        if (i.name == name) return i;
    throw std::runtime_error("no instance " + name);
}

/// A ray made of random bits, or one of the classes that break tracers.
Ray hostile_ray(std::uint64_t n)
{
    std::uint64_t h = hash_cell(77, static_cast<std::int64_t>(n), 0);
    const auto bits = [&] { return std::bit_cast<double>(h = mix64(h)); };
    const auto special = [&]() -> double {
        const double values[] = {0.0,    -0.0,  1.0,       -1.0,       1e-310,       1e30,  -1e30, 1e18,
                                 1.9e18, 1e300, kInfinity, -kInfinity, std::nan(""), 1e-38, 5.0,   0.5};
        return values[(h = mix64(h)) % 16];
    };
    Ray ray;
    const bool raw = n % 2 == 0;
    for (int k = 0; k < 3; ++k) ray.origin[k] = raw ? bits() : special();
    for (int k = 0; k < 3; ++k) ray.direction[k] = raw ? bits() : special();
    // Every third has a direction that passes, every fifth an origin that passes, so that the gate's later parts and the tracers are reached.
    if (n % 3 == 0) ray.direction = Vec3d(0.6, 0.0, n % 2 ? 0.8 : -0.8);
    if (n % 9 == 0) ray.direction = Vec3d(1e-310, 1.0, n % 2 ? 0.0 : 1e-200);
    if (n % 5 == 0) ray.origin = Vec3d(1.0, 2.0, 3.0);
    ray.t_min = n % 4 == 0 ? 0.0 : raw ? bits() : special();
    ray.t_max = n % 4 == 0 ? kInfinity : raw ? bits() : special();
    ray.time = n % 7 == 0 ? special() : 0.0;
    // From ever farther away towards the terrains, which all lie near the origin: until a step along the ray is less than its rounding.
    if (n % 11 == 0) {
        const Vec3d target(7.0 * unit_real(mix64(h + 1)), 6.0 * unit_real(mix64(h + 2)), 5.0 * unit_real(mix64(h + 3)));
        const double z = 2.0 * unit_real(mix64(h + 4)) - 1.0, phi = 6.28 * unit_real(mix64(h + 5)), r = std::sqrt(1.0 - z * z);
        ray.direction = Vec3d(r * std::cos(phi), r * std::sin(phi), z);
        ray.origin = target - ray.direction * std::pow(10.0, 18.0 * unit_real(mix64(h + 6)));
        ray.t_min = 0.0, ray.t_max = kInfinity, ray.time = 0.0;
    }
    return ray;
}

bool should_pass(const Ray& ray)
{
    for (int k = 0; k < 3; ++k)
        if (!(std::abs(ray.origin[k]) < 1e18) || !(std::abs(ray.direction[k]) < 1e18)) return false;
    const double length = std::sqrt(ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y + ray.direction.z * ray.direction.z);
    return std::abs(length - 1.0) <= 1e-3 && ray.t_min >= 0.0 && ray.t_min < ray.t_max && ray.t_min < 1e18 && ray.time >= 0.0 && ray.time <= 1.0;
}

TEST(Gate, random_bits_are_counted_or_traced_and_nothing_breaks)
{
    for (const char* name : {"plane", "mesh", "convolution_sphere", "convolution_exact", "rock_pile"}) {
        const std::vector<Shape> shapes = shapes_of(build_row(instance_named(name)));
        for (const bool embree : {true, false}) {
            const auto tracer = embree ? make_embree_tracer(shapes) : make_brute_force_tracer(shapes);
            std::uint64_t refused = 0;
            for (int n = 0, end = embree ? count(100000, 5000000) : count(2000, 20000); n < end; ++n) {
                const Ray ray = hostile_ray(static_cast<std::uint64_t>(n));
                refused += 2 * !should_pass(ray);
                const TraceHit hit = tracer->intersect(ray);
                tracer->occluded(ray);
                ASSERT_FALSE(hit.valid && !should_pass(ray)) << name << " ray " << n;
                ASSERT_TRUE(!hit.valid || (hit.t > ray.t_min && hit.t < ray.t_max)) << name << " ray " << n << ": " << hit.t;
            }
            EXPECT_EQ(tracer->refused_rays(), refused) << name;
        }
    }
}

/// Empty if the tracers agree on every ray: on hitting, and on where.
Verdict embree_agrees(const std::vector<Shape>& shapes, const std::vector<Ray>& rays, double size)
{
    const auto embree = make_embree_tracer(shapes), brute = make_brute_force_tracer(shapes);
    const bool mesh = !std::holds_alternative<std::unique_ptr<Surface>>(shapes[0]);
    int edge_cases = 0;
    for (const Ray& ray : rays) {
        const TraceHit a = embree->intersect(ray), b = brute->intersect(ray);
        const bool same = a.valid == b.valid && (!a.valid || std::abs(a.t - b.t) <= (mesh ? 2e-4 * size : 0.0));
        // Triangles are Embree's own, in single precision: a ray within rounding of a silhouette may be on either side.
        if (!same && (!mesh || ++edge_cases > static_cast<int>(rays.size()) / 200))
            return {"Embree finds t " + std::to_string(a.valid ? a.t : kInfinity) + ", the loop " + std::to_string(b.valid ? b.t : kInfinity)};
        if (!mesh && embree->occluded(ray) != a.valid) return {"occluded disagrees at t " + std::to_string(a.t)};
    }
    return {};
}

class TracerLaws : public ::testing::TestWithParam<std::size_t>
{
};

TEST_P(TracerLaws, embree_finds_what_the_loop_finds_near_and_far_from_the_origin)
{
    const RowInstance& instance = row_instances()[GetParam()];
    for (const Vec3d& shift : {Vec3d(0.0), Vec3d(1.5e5, 1234.0, -250.0), Vec3d(4e6, 3e6, 1000.0)}) {
        BuiltRow built = build_row(instance, shift);
        const std::vector<Ray> rays = law_rays(built.surface(), 31, count(2000, 20000));
        const double size = surface_bounds(built.surface()).size().length();
        const Verdict v = embree_agrees(shapes_of(std::move(built)), rays, size);
        EXPECT_TRUE(v.holds()) << v.fault << " at offset " << shift;
    }
}

TEST_P(TracerLaws, a_neighbour_changes_nothing)
{
    const RowInstance& instance = row_instances()[GetParam()];
    BuiltRow built = build_row(instance);
    const std::vector<Ray> rays = law_rays(built.surface(), 32, count(1000, 10000));
    const std::vector<Shape> alone = shapes_of(std::move(built));
    std::vector<Shape> company = shapes_of(build_row(instance_named("mesh"), Vec3d(0.0, 0.0, -900.0)));
    company.push_back(std::move(shapes_of(build_row(instance))[0]));
    const auto a = make_embree_tracer(alone), b = make_embree_tracer(company);
    std::size_t silhouettes = 0;
    for (const Ray& ray : rays) {
        const TraceHit x = a->intersect(ray);
        TraceHit y = b->intersect(ray);
        if (y.valid && y.object == 0) y = TraceHit{};
        if (!std::holds_alternative<std::unique_ptr<Surface>>(alone[0])) {
            // Embree's triangles are rounded about another centre; what is told of the hit is exact again, but a ray within rounding of a
            // silhouette may be on either side of it.
            silhouettes += x.valid != y.valid || (x.valid && (a->interact(ray, x).position - b->interact(ray, y).position).length() > 1e-6);
            continue;
        }
        ASSERT_EQ(x.valid, y.valid);
        if (!x.valid) continue;
        ASSERT_EQ(std::memcmp(&x.t, &y.t, sizeof x.t), 0);
        ASSERT_TRUE(a->interact(ray, x).position == b->interact(ray, y).position);
    }
    EXPECT_LE(silhouettes, rays.size() / 200);
}

TEST(Description, a_terrain_keeps_its_seed_whatever_stands_beside_it)
{
    const std::string head = "version = 1\n[camera]\neye = [0, 0, 5]\ntarget = [1, 0, 0]\n", abyss = "[terrain.abyss]\ntype = \"plane\"\n";
    const std::string hill = "[terrain.hill]\ntype = \"plane\"\n", one = head + hill, two = head + abyss + hill;
    const Description alone = read_scene(one, true), company = read_scene(two, true);
    const auto seed = [](const Description& d, const std::string& name) {
        const auto at = std::find_if(d.terrains.begin(), d.terrains.end(), [&](const DescribedNode& n) { return n.name == name; });
        return at == d.terrains.end() ? 0 : at->seed;
    };
    EXPECT_NE(seed(alone, "hill"), 0u);
    EXPECT_EQ(seed(alone, "hill"), seed(company, "hill"));
    EXPECT_NE(seed(company, "abyss"), seed(company, "hill"));
}

TEST_P(TracerLaws, a_closed_surface_leaks_none_through_embree)
{
    const RowInstance& instance = row_instances()[GetParam()];
    for (const Vec3d& shift : {Vec3d(0.0), Vec3d(1.5e5, 1234.0, -250.0), Vec3d(4e6, 3e6, 1000.0)}) {
        BuiltRow built = build_row(instance, shift);
        if (!built.surface().closed() || built.mesh) return;
        const Box3d box = surface_bounds(built.surface());
        const std::vector<Shape> shapes = shapes_of(std::move(built));
        const Surface& surface = *std::get<std::unique_ptr<Surface>>(shapes[0]);
        const auto tracer = make_embree_tracer(shapes);
        std::atomic<int> inside{0}, leaks{0};
        const int n = count(60000, 1000000);
        tbb::parallel_for(0, n, [&](int k) {
            std::uint64_t h = hash_cell(41, k, 0);
            const auto next = [&h] { return unit_real(h = mix64(h)); };
            Ray ray;
            ray.origin = box.min + Vec3d(next(), next(), next()) * box.size();
            // From matter, every other time towards a point where patches meet: an edge of a cell.
            if (!(surface.field()->value(ray.origin) < -1e-6)) return;
            Vec3d target = box.min + Vec3d(next(), next(), next()) * box.size();
            if (k % 2) {
                const PatchId patch{0, static_cast<std::uint32_t>(next() * surface.patch_count(0))};
                const Box3d b = surface.patch_bounds(patch);
                target = Vec3d(next() < 0.5 ? b.min.x : b.max.x, next() < 0.5 ? b.min.y : b.max.y, b.min.z + (b.max.z - b.min.z) * next());
            }
            ray.direction = (target - ray.origin).normalized();
            if (!is_finite(ray.direction)) return;
            ++inside;
            leaks += !tracer->intersect(ray).valid;
        });
        EXPECT_EQ(leaks, 0) << "of " << inside << " at offset " << shift;
        EXPECT_GT(inside, n / 20);
    }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, TracerLaws, ::testing::Range(std::size_t{0}, row_instances().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& i) { return row_instances()[i.param].name; });

/// A surface whose boxes are as tight as the patches, and end where single precision cannot tell: what padding is for.
TEST(TracerLaws, the_law_of_agreement_fails_for_shrunk_boxes)
{
    class Shrunk final : public Surface
    {
    public:
        explicit Shrunk(std::unique_ptr<Surface> s) : s_(std::move(s)) {}
        std::uint32_t tile_count() const override { return s_->tile_count(); }
        std::uint32_t patch_count(std::uint32_t tile) const override { return s_->patch_count(tile); }
        Box3d patch_bounds(PatchId p) const override
        {
            const Box3d b = s_->patch_bounds(p);
            return {b.min + b.size() * 0.02, b.max - b.size() * 0.02};
        }
        bool intersect(PatchId p, const Ray& ray, Hit& hit) const override { return s_->intersect(p, ray, hit); }
        Interaction interact(const Ray& ray, const Hit& hit) const override { return s_->interact(ray, hit); }
        bool contains(const Vec3d& p) const override { return s_->contains(p); }
        std::vector<std::string> materials() const override { return s_->materials(); }
        bool closed() const override { return s_->closed(); }
        SurfaceInfo info() const override { return s_->info(); }

    private:
        std::unique_ptr<Surface> s_;
    };
    BuiltRow built = build_row(instance_named("convolution_sphere"));
    const std::vector<Ray> rays = law_rays(built.surface(), 31, 2000);
    std::vector<Shape> shapes;
    shapes.emplace_back(std::make_unique<Shrunk>(std::move(std::get<std::unique_ptr<Surface>>(*built.shape))));
    EXPECT_FALSE(embree_agrees(shapes, rays, 10.0).holds());
}

TEST(Triangle, spawn_offset_of_a_mesh_leaves_it_through_embree)
{
    for (const Vec3d& shift : {Vec3d(0.0), Vec3d(1.5e5, 1234.0, -250.0), Vec3d(4e6, 3e6, 1000.0)}) {
        BuiltRow built = build_row(instance_named("mesh"), shift);
        const std::vector<Ray> rays = law_rays(built.surface(), 33, count(2000, 20000));
        const std::vector<Shape> shapes = shapes_of(std::move(built));
        const auto tracer = make_embree_tracer(shapes);
        for (const Ray& ray : rays) {
            const TraceHit hit = tracer->intersect(ray);
            if (!hit.valid) continue;
            const Interaction at = tracer->interact(ray, hit);
            const double side = at.geometric_normal.dot(ray.direction) < 0.0 ? 1.0 : -1.0;
            Ray spawned;
            spawned.origin = at.position + at.geometric_normal * (side * at.spawn_offset);
            spawned.direction = (ray.direction - at.geometric_normal * (2.0 * at.geometric_normal.dot(ray.direction))).normalized();
            const TraceHit again = tracer->intersect(spawned);
            ASSERT_FALSE(again.valid && again.patch.index == hit.patch.index) << "met its own triangle at " << again.t;
        }
    }
}

}  // namespace
}  // namespace hoodoo
