// Both intersectors against the exact oracle: no crossing missed, no false hit, for every width of the kernel.

#include "terrain/march/exact_cells.h"
#include "terrain/march/sphere_bricks.h"
#include "tests/counts.h"
#include "tests/stacks.h"
#include "tests/support/stack_oracle.h"
#include "tests/support/terrains.h"
#include "tests/support/test_rays.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <ostream>

namespace hoodoo
{
namespace
{

using testing::count;
using testing::judge;
using testing::RayVerdict;
using testing::StackOracle;

enum class Kind { sphere, exact };

std::unique_ptr<PatchIntersector> make(Kind kind, const ConvolutionField& field)
{
    return kind == Kind::sphere ? make_sphere_bricks(field) : make_exact_cells(field);
}

/// All patches, one by one: nothing that could hide a fault of a box.
Hit nearest(const PatchIntersector& patches, const Ray& ray)
{
    Hit hit;
    hit.t = ray.t_max;
    bool found = false;
    for (std::uint32_t tile = 0; tile < patches.tile_count(); ++tile)
        for (std::uint32_t i = 0; i < patches.patch_count(tile); ++i) found = patches.intersect({tile, i}, ray, hit) || found;
    if (!found) hit.t = kInfinity;
    return hit;
}

struct Case {
    Kind kind;
    double sigma;  ///< in cells
    bool rugged;
    Border border;
    friend std::ostream& operator<<(std::ostream& out, const Case& c)
    {
        return out << (c.kind == Kind::sphere ? "sphere" : "exact") << (c.rugged ? "_rugged" : "_gentle") << "_sigma"
                   << static_cast<int>(100 * c.sigma) << (c.border == Border::cut ? "_cut" : "");
    }
};

class Intersector : public ::testing::TestWithParam<Case>
{
};

/// What the test of 2e4 rays adds to the field's own error: the rounding of the tester's position.
double tolerance(const PatchIntersector& patches, const ConvolutionField& field, const Ray& ray, double t)
{
    const double far = std::isfinite(t) ? t : 0.0;
    return patches.value_error() + std::sqrt(3.0) / field.sigma() * 0x1p-50 * (ray.origin.length() + far);
}

TEST_P(Intersector, agrees_with_the_exact_oracle)
{
    const Case c = GetParam();
    testing::TerrainRecipe recipe;
    recipe.size = {40, 36};
    recipe.cell = 0.75;
    recipe.relief = 24.0;
    recipe.rugged = c.rugged;
    recipe.tunnels = 4;
    const ConvolutionField field(Ground(testing::make_terrain(recipe), kGround, c.border, 64), c.sigma * recipe.cell);
    if (c.kind == Kind::exact && why_not_exact(field)) GTEST_SKIP() << *why_not_exact(field);
    const auto patches = make(c.kind, field);
    const StackOracle oracle(field.ground(), field.sigma());
    std::atomic<int> misses{0}, false_hits{0}, hits{0}, disagreements{0};
    const int n = count(2500, 12500);  // eight cases an intersector: 2e4 rays, 1e5 nightly
    tbb::parallel_for(0, n, [&](int k) {
        const Ray ray = testing::test_ray(field, 11, static_cast<std::uint64_t>(k));
        const Hit hit = nearest(*patches, ray);
        const RayVerdict verdict = judge(oracle, ray, hit.t, tolerance(*patches, field, ray, hit.t));
        misses += verdict.missed;
        false_hits += verdict.false_hit;
        hits += std::isfinite(hit.t);
        if (verdict.missed || verdict.false_hit) {
            ADD_FAILURE() << "ray " << k << ": t " << hit.t << (verdict.missed ? " missed the crossing at " : " ") << verdict.at << ", f there "
                          << verdict.value << ", crossing " << static_cast<int>(ray.crossing) << ", origin " << ray.origin << ", direction "
                          << ray.direction;
        }
        bool any = false;
        for (std::uint32_t tile = 0; tile < patches->tile_count() && !any; ++tile)
            for (std::uint32_t i = 0; i < patches->patch_count(tile) && !any; ++i) any = patches->occluded({tile, i}, ray);
        disagreements += any != std::isfinite(hit.t);
    });
    EXPECT_EQ(misses, 0);
    EXPECT_EQ(false_hits, 0);
    EXPECT_EQ(disagreements, 0);
    EXPECT_GT(hits, n / 4);
}

std::vector<Case> cases()
{
    std::vector<Case> all;
    for (const Kind kind : {Kind::sphere, Kind::exact}) {
        for (const double sigma : {1.0, 1.5, 2.0, 3.0})
            for (const bool rugged : {true, false}) all.push_back({kind, sigma, rugged, sigma == 1.5 ? Border::cut : Border::extend});
    }
    all.push_back({Kind::sphere, 0.83, true, Border::extend});
    all.push_back({Kind::sphere, 1.71, true, Border::cut});
    return all;
}

// -- The oracle itself ---------------------------------------------------------------------------------------------------------------------

TEST(StackOracle, agrees_with_the_golden_rays_and_field_values)
{
    // a_arches.json: box sums for the field, a dense march with bisection for the rays; the paper's sign, so negated here.
    const nlohmann::json data = testing::golden_arches();
    const auto stack = testing::golden_stack();
    for (const auto& f : data["field"]) {
        const Ground ground(stack, kGround, Border::extend);
        const StackOracle oracle(ground, f["sigma"]);
        EXPECT_NEAR(oracle.value(Vec3d(f["p"][0], f["p"][1], f["p"][2])), -f["f_ground"].get<double>(), 1e-12);
    }
    int hits = 0;
    for (const auto& r : data["rays"]) {
        const Ground ground(stack, kGround, Border::extend);
        const StackOracle oracle(ground, r["sigma"]);
        Ray ray;
        ray.origin = Vec3d(r["o"][0], r["o"][1], r["o"][2]);
        ray.direction = Vec3d(r["d"][0], r["d"][1], r["d"][2]);
        const bool hit = r["t_hit"].is_number();
        // The golden terrain goes on beyond its grid, so the whole ray counts. The first stretch of matter begins at the hit, a margin later.
        const double end = hit ? r["t_hit"].get<double>() + 0.01 : 60.0;
        const auto stretches = oracle.stretches(ray, 0.0, end, 1e-9);
        const auto first = std::find_if(stretches.begin(), stretches.end(), [](const auto& s) { return s.inside; });
        ASSERT_EQ(first != stretches.end(), hit);
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR(first->from, r["t_hit"].get<double>(), 1e-6);
    }
    EXPECT_GT(hits, 5);
}

TEST(StackOracle, sees_every_planted_fault)
{
    testing::TerrainRecipe recipe;
    recipe.size = {24, 20};
    recipe.relief = 16.0;
    const ConvolutionField field(Ground(testing::make_terrain(recipe), kGround, Border::extend), 1.0);
    const auto patches = make_sphere_bricks(field);
    const StackOracle oracle(field.ground(), field.sigma());
    int hits = 0, missed = 0, second_hits_missed = 0, seconds = 0, pushed = 0;
    for (std::uint64_t k = 0; k < 1000; ++k) {
        const Ray ray = testing::test_ray(field, 12, k);
        const double t = nearest(*patches, ray).t;
        if (!std::isfinite(t)) continue;
        ++hits;
        const double error = tolerance(*patches, field, ray, t);
        // A hit that is left out, the next one told instead of the first, a hit a millionth of a cell too far.
        missed += judge(oracle, ray, kInfinity, error).missed;
        Ray behind = ray;
        behind.t_min = t + 1e-6;
        const double next = nearest(*patches, behind).t;
        if (std::isfinite(next)) ++seconds, second_hits_missed += judge(oracle, ray, next, error).missed;
        pushed += judge(oracle, ray, t + 1e-6, error).false_hit;
    }
    // All but grazes that are shallower than the error, and rays whose field is flat.
    EXPECT_GT(missed, hits * 99 / 100);
    EXPECT_GT(second_hits_missed, seconds * 98 / 100);
    EXPECT_GT(pushed, hits * 98 / 100);
    EXPECT_GT(seconds, 100);
}

TEST(TestRays, are_as_hard_as_promised)
{
    testing::TerrainRecipe recipe;
    recipe.size = {24, 20};
    recipe.relief = 16.0;
    const ConvolutionField field(Ground(testing::make_terrain(recipe), kGround, Border::extend), 1.0);
    int tangent = 0, near = 0, aligned = 0;
    const int n = 1000;
    for (int k = 0; k < n; ++k) {
        const Ray ray = testing::test_ray(field, 13, static_cast<std::uint64_t>(k));
        near += std::abs(field.value(ray.origin)) < 1.0;
        aligned += ray.direction.x == 0.0 || ray.direction.y == 0.0 || ray.direction.z == 0.0;
        // Tangent at one of the ray's crossings, or where it comes nearest to one: |df/dt| small against the gradient at small |f|.
        bool grazes = false;
        for (double t = 0.0; t < 30.0 && !grazes; t += 0.02) {
            const Vec3d p = ray.at(t), g = field.gradient(p);
            grazes = std::abs(field.value(p)) < 0.02 && std::abs(g.dot(ray.direction)) < 0.02 * g.length();
        }
        tangent += grazes;
    }
    EXPECT_GE(tangent, n / 5);
    EXPECT_GE(near, n / 10);
    EXPECT_GE(aligned, n / 10);
}

INSTANTIATE_TEST_SUITE_P(Laws, Intersector, ::testing::ValuesIn(cases()), ::testing::PrintToStringParamName());

}  // namespace
}  // namespace hoodoo
