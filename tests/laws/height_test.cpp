// The laws of heights over every row of the catalogue that is one; and mutants, each of which breaks one bound and must be caught.

#include "tests/counts.h"
#include "tests/expect_law.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/height_laws.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

Box2d middle_of(const Surface& surface)
{
    return area_under(surface_bounds(surface));
}

class HeightLaws : public ::testing::TestWithParam<std::size_t>
{
};

TEST_P(HeightLaws, bounds_hold)
{
    const BuiltRow built = build_row(row_instances()[GetParam()]);
    const Surface& surface = built.surface();
    if (!surface.height()) GTEST_SKIP() << "no height";
    EXPECT_LAW(height_bounds_hold(*surface.height(), middle_of(surface), 8, count(2000, 50000)));
    // As a field, too: what a warp or a crack stands on.
    EXPECT_LAW(field_bounds_hold(HeightAsField(*surface.height()), surface_bounds(surface), 9, count(1000, 20000)));
}

TEST_P(HeightLaws, matter_ends_at_the_height)
{
    const BuiltRow built = build_row(row_instances()[GetParam()]);
    const Surface& surface = built.surface();
    if (!surface.height()) GTEST_SKIP() << "no height";
    for (const Ray& ray : law_rays(surface, 23, count(300, 3000))) {
        const Hit hit = nearest_hit(surface, ray);
        if (!std::isfinite(hit.t)) continue;
        const Interaction at = surface.interact(ray, hit);
        const double h = surface.height()->height({at.position.x, at.position.y});
        const double slope = surface.height()->gradient({at.position.x, at.position.y}).length();
        EXPECT_NEAR(at.position.z, h, 1e-9 + 2.0 * at.position_error * (1.0 + slope));
    }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, HeightLaws, ::testing::Range(std::size_t{0}, row_instances().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& i) { return row_instances()[i.param].name; });

/// A wave, exact in all its bounds; each mutant falls short in one.
class Wave : public Height
{
public:
    double height(const Vec2d& p) const override { return std::sin(p.x) + 0.5 * p.y; }
    Vec2d gradient(const Vec2d& p) const override { return {std::cos(p.x), 0.5}; }
    Interval range(const Box2d& area) const override { return {-1.0 + 0.5 * area.min.y, 1.0 + 0.5 * area.max.y}; }
    double slope_bound(const Box2d&) const override { return std::sqrt(1.25); }
    Box2d domain() const override { return {Vec2d(-10.0), Vec2d(10.0)}; }
    std::array<Interval, 2> gradient_range(const Box2d&) const override { return {Interval{-1.0, 1.0}, Interval{0.5, 0.5}}; }
    double curvature_bound(const Box2d&) const override { return 1.0; }
};
struct LowRange final : Wave {
    Interval range(const Box2d& area) const override { return Wave::range(area).scaled(0.97); }
};
struct LowSlope final : Wave {
    double slope_bound(const Box2d&) const override { return 0.97 * std::sqrt(1.25); }
};
struct NarrowGradient final : Wave {
    std::array<Interval, 2> gradient_range(const Box2d&) const override { return {Interval{-0.97, 0.97}, Interval{0.5, 0.5}}; }
};
struct LowCurvature final : Wave {
    double curvature_bound(const Box2d&) const override { return 0.97; }
};
struct WrongGradient final : Wave {
    Vec2d gradient(const Vec2d& p) const override { return {0.999 * std::cos(p.x), 0.5}; }
};

TEST(HeightLaw, mutants_are_caught)
{
    const auto verdict = [](const Height& h) { return height_bounds_hold(h, h.domain(), 8, 2000); };
    EXPECT_LAW(verdict(Wave()));
    EXPECT_FALSE(verdict(LowRange()).holds());
    EXPECT_FALSE(verdict(LowSlope()).holds());
    EXPECT_FALSE(verdict(NarrowGradient()).holds());
    EXPECT_FALSE(verdict(LowCurvature()).holds());
    EXPECT_FALSE(verdict(WrongGradient()).holds());
}

}  // namespace
}  // namespace hoodoo
