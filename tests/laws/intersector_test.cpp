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

#include <atomic>
#include <ostream>

namespace hoodoo {
namespace {

using testing::count;
using testing::judge;
using testing::RayVerdict;
using testing::StackOracle;

enum class Kind { sphere, exact };

std::unique_ptr<PatchIntersector> make(Kind kind, const ConvolutionField& field) { return kind == Kind::sphere ? make_sphere_bricks(field) : make_exact_cells(field); }

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
    double sigma;   ///< in cells
    bool rugged;
    Border border;
    friend std::ostream& operator<<(std::ostream& out, const Case& c)
    {
        return out << (c.kind == Kind::sphere ? "sphere" : "exact") << (c.rugged ? "_rugged" : "_gentle") << "_sigma" << static_cast<int>(100 * c.sigma)
                   << (c.border == Border::cut ? "_cut" : "");
    }
};

class Intersector : public ::testing::TestWithParam<Case> {};

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
    const int n = count(2500, 12500);   // eight cases an intersector: 2e4 rays, 1e5 nightly
    tbb::parallel_for(0, n, [&](int k) {
        const Ray ray = testing::test_ray(field, 11, static_cast<std::uint64_t>(k));
        const Hit hit = nearest(*patches, ray);
        const RayVerdict verdict = judge(oracle, ray, hit.t, tolerance(*patches, field, ray, hit.t));
        misses += verdict.missed;
        false_hits += verdict.false_hit;
        hits += std::isfinite(hit.t);
        if (verdict.missed || verdict.false_hit) {
            ADD_FAILURE() << "ray " << k << ": t " << hit.t << (verdict.missed ? " missed the crossing at " : " ") << verdict.at << ", f there " << verdict.value << ", crossing "
                          << static_cast<int>(ray.crossing) << ", origin " << ray.origin << ", direction " << ray.direction;
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

INSTANTIATE_TEST_SUITE_P(Laws, Intersector, ::testing::ValuesIn(cases()), ::testing::PrintToStringParamName());

}  // namespace
}  // namespace hoodoo
