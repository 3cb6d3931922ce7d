// Law: the slope bound and the range of a convolution field are never passed, on stacks as rugged as stacks can be, for any kernel.
// Mutants: the bounds times 0.9 must fail. Since no slope bound is attained by chance, segments are also built to attain it: across one wall.
#include "tests/counts.h"
#include "tests/stacks.h"
#include "terrain/stack/convolution.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

double random(std::uint64_t i)
{
    return unit_real(mix64(i));
}

struct Verdict {
    int violations = 0;
    double closest = 0.0;  ///< largest share of a bound that was used
};

/// `shrink` breaks the bounds on purpose.
Verdict bounds_hold(const ConvolutionField& field, std::uint64_t seed, int count, double shrink = 1.0)
{
    Verdict verdict;
    const MaterialStack& stack = field.ground().stack();
    const Vec3d extent(stack.size().x * stack.cell(), stack.size().y * stack.cell(), stack.highest_top() * stack.unit() + 2 * field.sigma());
    for (int k = 0; k < count; ++k) {
        const std::uint64_t r = hash_combine(seed, static_cast<std::uint64_t>(k));
        const Vec3d at = stack.origin() +
                         Vec3d((1.4 * random(r) - 0.2) * extent.x, (1.4 * random(r + 1) - 0.2) * extent.y, (1.2 * random(r + 2) - 0.1) * extent.z);
        Vec3d size = Vec3d(random(r + 3), random(r + 4), random(r + 5)) * field.sigma() * std::pow(2.0, 6.0 * random(r + 6) - 5.0);
        if (k % 3 == 0) size[static_cast<int>((r >> 8) % 3)] = 0.0;
        if (k % 5 == 0) size[static_cast<int>((r >> 10) % 3)] = 0.0;
        const Box3d box(at - size, at + size);
        const Interval range = field.range(box);
        const double middle = 0.5 * (range.lo + range.hi), half = 0.5 * (range.hi - range.lo) * shrink;
        const Segment diagonal{box.min, box.max};
        const double slope = field.slope_bound(diagonal) * shrink;
        for (int n = 0; n < 12; ++n) {
            const std::uint64_t s = hash_combine(r, static_cast<std::uint64_t>(n));
            const double u = n < 4 ? (n & 1) : random(s), v = n < 4 ? (n >> 1) : random(s + 1), w = n < 4 ? 1 - (n & 1) : random(s + 2);
            const double f = field.value(box.min + Vec3d(u * 2 * size.x, v * 2 * size.y, w * 2 * size.z));
            const double used = half > 1e-6 ? std::abs(f - middle) / half : 0.0;
            verdict.closest = std::max(verdict.closest, used);
            verdict.violations += std::abs(f - middle) > half + 2e-12;
            const double a = random(s + 3), b = random(s + 4), length = (diagonal.b - diagonal.a).length();
            const double change =
                std::abs(field.value(diagonal.a + (diagonal.b - diagonal.a) * a) - field.value(diagonal.a + (diagonal.b - diagonal.a) * b));
            verdict.violations += change > slope * std::abs(a - b) * length + 1e-11;
        }
    }
    return verdict;
}

TEST(ConvolutionBounds, are_never_passed_and_ninety_percent_of_them_are)
{
    int broken = 0;
    for (const double sigma : {0.5, 0.8, 1.0, 1.5, 2.3}) {
        for (std::uint64_t seed = 1; seed <= 2; ++seed) {
            const auto stack = testing::random_stack(seed, {10, 9}, 1.0, 0.05, 160, Vec3d(-3, 40, 2));
            for (const Border border : {Border::extend, Border::cut}) {
                const ConvolutionField field(Ground(stack, kGround, border, 50), sigma);
                const int count = testing::count(1500, 50000);
                EXPECT_EQ(bounds_hold(field, seed, count).violations, 0) << "sigma " << sigma << " seed " << seed;
                broken += bounds_hold(field, seed, 300, 0.9).violations > 0;
            }
        }
    }
    EXPECT_EQ(broken, 20);
}

TEST(ConvolutionBounds, slope_bound_is_attained_along_each_axis_of_a_wall)
{
    // One tall column beside none: across the wall f changes by exactly 1/sigma a metre, along z on its top as well.
    auto stack = std::make_shared<MaterialStack>(Vec2i(8, 8), 1.0, 1.0);
    for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 4; ++i) stack->set_column(i, j, std::vector<Layer>{{Material::bedrock, 40}});
    }
    const ConvolutionField field(Ground(stack, kGround, Border::extend), 1.0);
    const Segment across{Vec3d(3.6, 4.2, 20), Vec3d(4.4, 4.2, 20)}, up{Vec3d(2.0, 4.2, 39.5), Vec3d(2.0, 4.2, 40.4)},
        inside{Vec3d(1.5, 4, 10), Vec3d(1.9, 5, 12)};
    const auto slope = [&](const Segment& s) { return std::abs(field.value(s.b) - field.value(s.a)) / (s.b - s.a).length(); };
    EXPECT_NEAR(slope(across), 1.0, 1e-9);
    EXPECT_NEAR(field.slope_bound(across), 1.0, 1e-9);
    EXPECT_NEAR(slope(up), 1.0, 1e-9);
    EXPECT_NEAR(field.slope_bound(up), 1.0, 1e-9);
    EXPECT_LT(field.slope_bound(inside), 1e-9);  // solid all around: the local bound is nothing
    EXPECT_LT(field.slope_bound({Vec3d(2, 2, 60), Vec3d(6, 6, 90)}), 1e-9);
}

TEST(ConvolutionBounds, range_is_tight_where_it_matters)
{
    const auto stack = testing::random_stack(4, {10, 10}, 1.0, 0.05, 160);
    const ConvolutionField field(Ground(stack, kGround, Border::extend), 1.0);
    const Box3d air(Vec3d(2, 2, 30), Vec3d(6, 6, 40)), rock(Vec3d(2, 2, -40), Vec3d(6, 6, -10)), far(Vec3d(-1e30), Vec3d(1e30));
    EXPECT_GT(field.range(air).lo, 0.999);
    EXPECT_LT(field.range(rock).hi, -0.999);
    EXPECT_LE(field.range(far).lo, -1.0);
    EXPECT_GE(field.range(far).hi, 1.0);
    const Vec3d p(4.3, 5.1, 3.0);
    EXPECT_NEAR(field.range(Box3d(p, p)).lo, field.value(p), 1e-11);  // a point has no width
}

}  // namespace
}  // namespace hoodoo
