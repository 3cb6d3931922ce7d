// The field of a stack against golden values (the oracle sums boxes), and what must hold at edges, far away and across lattice planes.
#include "terrain/stack/convolution.h"

#include "terrain/error.h"
#include "tests/counts.h"
#include "tests/stacks.h"
#include "terrain/stack/visible.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

Vec3d point(const nlohmann::json& p)
{
    return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}
double random(std::uint64_t i)
{
    return unit_real(mix64(i));
}

TEST(Convolution, value_and_gradient_equal_the_golden_box_sums)
{
    const auto stack = testing::golden_stack();
    const nlohmann::json data = testing::golden_arches();
    ASSERT_GT(data["field"].size(), 20u);
    for (const auto& row : data["field"]) {
        const ConvolutionField ground(Ground(stack, kGround, Border::extend), row["sigma"].get<double>());
        const ConvolutionField bedrock(Ground(stack, material_set({Material::bedrock}), Border::extend), row["sigma"].get<double>());
        const Vec3d p = point(row["p"]);
        // The paper is positive inside: negated here, once.
        EXPECT_NEAR(ground.value(p), -row["f_ground"].get<double>(), 1e-12);
        EXPECT_NEAR(bedrock.value(p), -row["f_bedrock"].get<double>(), 1e-12);
        EXPECT_LT((ground.gradient(p) + point(row["grad_ground"])).length(), 1e-11);
    }
}

TEST(Convolution, visible_areas_equal_the_golden_ones)
{
    const auto stack = testing::golden_stack();
    const nlohmann::json data = testing::golden_arches();
    for (const auto& row : data["visible_area"]) {
        const auto areas = visible_areas(Ground(stack, kGround, Border::extend), kGround, row["sigma"].get<double>(), point(row["p"]));
        // Overlaps are multiples of 0.1 here and heights of 0.01, so true areas are multiples of 0.001. The oracle scans heights in steps, which
        // shows in its last case (0.6799575 for 0.680).
        const double sand = areas[static_cast<std::size_t>(Material::sand)], bedrock = areas[static_cast<std::size_t>(Material::bedrock)];
        EXPECT_NEAR(sand, row["area_sand"].get<double>(), 3e-4);
        EXPECT_NEAR(bedrock, row["area_bedrock"].get<double>(), 3e-4);
        EXPECT_NEAR(sand, std::round(sand * 1000) / 1000, 1e-11);
        EXPECT_NEAR(bedrock, std::round(bedrock * 1000) / 1000, 1e-11);
        EXPECT_EQ(areas[static_cast<std::size_t>(Material::rock)], 0.0);
    }
}

TEST(Convolution, visible_areas_of_a_cut_block_count_its_walls_and_its_bottom)
{
    // One column of 3 units over a base of 2: the cube around its middle sees four walls, the top and the bottom of one cell.
    auto stack = std::make_shared<MaterialStack>(Vec2i(1, 1), 1.0, 1.0);
    stack->set_column(0, 0, std::vector<Layer>{{Material::sand, 3}});
    const auto areas = visible_areas(Ground(stack, kGround, Border::cut, 2), kGround, 10.0, Vec3d(0.5, 0.5, 0.5));
    EXPECT_NEAR(areas[static_cast<std::size_t>(Material::sand)], 1.0 + 4 * 3.0, 1e-12);
    EXPECT_NEAR(areas[static_cast<std::size_t>(Material::bedrock)], 1.0 + 4 * 2.0, 1e-12);
}

TEST(Convolution, gradient_is_the_derivative_between_breakpoints)
{
    const auto stack = testing::random_stack(5, {8, 8}, 2.0, 0.25, 60, Vec3d(100, -50, 7));
    for (const double sigma : {1.0, 1.6, 2.0, 3.0, 4.6}) {
        const ConvolutionField field(Ground(stack, kGround, Border::extend), sigma);
        int compared = 0;
        for (std::uint64_t k = 0; k < 400; ++k) {
            const Vec3d p(100 + 16 * random(3 * k), -50 + 16 * random(3 * k + 1), 7 + 14 * random(3 * k + 2));
            const double h = 1e-4;
            Vec3d central, forward, gradient = field.gradient(p);
            for (int axis = 0; axis < 3; ++axis) {
                Vec3d step(0.0);
                step[axis] = h;
                central[axis] = (field.value(p + step) - field.value(p - step)) / (2 * h);
                forward[axis] = (field.value(p + step) - field.value(p)) / h;
            }
            // f is linear along an axis between breakpoints, so both differences are exact there; where they differ, a breakpoint is near.
            if ((central - forward).length() > 1e-8) continue;
            EXPECT_LT((gradient - central).length(), 1e-8);
            ++compared;
        }
        EXPECT_GT(compared, 300);
    }
}

TEST(Convolution, extend_repeats_the_edge_and_cut_has_nothing_beyond)
{
    const auto stack = testing::random_stack(6, {5, 4}, 1.0, 0.1, 60);
    const ConvolutionField extend(Ground(stack, kGround, Border::extend), 1.5), cut(Ground(stack, kGround, Border::cut, 40), 1.5);
    for (std::uint64_t k = 0; k < 200; ++k) {
        const double y = 4 * random(2 * k), z = 8 * random(2 * k + 1) - 1;
        EXPECT_EQ(extend.value(Vec3d(-1.5, y, z)), extend.value(Vec3d(-1e9, y, z)));
        EXPECT_EQ(extend.value(Vec3d(6.5, y, z)), extend.value(Vec3d(kInfinity, y, z)));
        EXPECT_EQ(cut.value(Vec3d(-1.5, y, z)), 1.0);
        EXPECT_GE(cut.value(Vec3d(-0.001, y, z)), 0.0);  // beyond a face more than half of the cube is air
    }
    EXPECT_EQ(extend.value(Vec3d(2, 2, -1e6)), -1.0);
    EXPECT_EQ(cut.value(Vec3d(2, 2, -1e6)), 1.0);
    EXPECT_EQ(extend.value(Vec3d(2, 2, 1e6)), 1.0);
    const Box3d box = cut.bounds();
    EXPECT_EQ(box.min, Vec3d(0, 0, -4));
    EXPECT_EQ(box.max.x, 5.0);
    EXPECT_EQ(box.max.z, stack->highest_top() * 0.1);
}

TEST(Convolution, a_flat_plain_is_the_height_over_sigma)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(4, 4), 1.0, 1.0, Vec3d(0, 0, 1.5e5));
    const std::vector<std::vector<Layer>> columns(16, {{Material::bedrock, 10}});
    stack->set_columns({0, 0}, {4, 4}, columns);
    for (const double sigma : {0.5, 1.0, 2.3}) {
        const ConvolutionField field(Ground(stack, kGround, Border::extend), sigma);
        for (const double h : {-0.4, -0.1, 0.0, 0.25, 0.45}) EXPECT_NEAR(field.value(Vec3d(2.2, 1.7, 1.5e5 + 10 + h)), h / sigma, 1e-10);
        EXPECT_NEAR(field.gradient(Vec3d(2.2, 1.7, 1.5e5 + 10.1)).z, 1.0 / sigma, 1e-12);
    }
}

TEST(Convolution, moving_stack_and_point_together_changes_nothing)
{
    const Vec3d far(4096.0, -65536.0, 512.0);  // exact in binary, so the differences are the same numbers
    const auto here = testing::random_stack(9, {6, 6}, 1.0, 0.125, 50), there = testing::random_stack(9, {6, 6}, 1.0, 0.125, 50, far);
    const ConvolutionField a(Ground(here, kGround, Border::extend), 1.0), b(Ground(there, kGround, Border::extend), 1.0);
    for (std::uint64_t k = 0; k < 200; ++k) {
        const Vec3d p(std::floor(6e4 * random(3 * k)) / 8192, std::floor(6e4 * random(3 * k + 1)) / 8192, std::floor(6e4 * random(3 * k + 2)) / 8192);
        EXPECT_EQ(a.value(p), b.value(p + far));
    }
}

TEST(Convolution, a_sheet_as_thin_as_the_kernel_still_has_a_normal)
{
    // Sheet of thickness sigma: f = 0 in an open set. The nearest side of the column gives the normal.
    auto stack = std::make_shared<MaterialStack>(Vec2i(8, 8), 1.0, 0.5);
    const std::vector<std::vector<Layer>> columns(64, {{Material::air, 20}, {Material::bedrock, 22}});
    stack->set_columns({0, 0}, {8, 8}, columns);
    const ConvolutionField field(Ground(stack, kGround, Border::extend), 1.0);
    EXPECT_NEAR(field.value(Vec3d(4, 4, 10.6)), 0.0, 1e-12);
    EXPECT_EQ(field.smoothed_gradient(Vec3d(4, 4, 10.6), 0.2), Vec3d(0, 0, 1));
    EXPECT_EQ(field.smoothed_gradient(Vec3d(4, 4, 10.4), 0.2), Vec3d(0, 0, -1));
}

TEST(Convolution, refuses_kernels_and_materials_that_cannot_be)
{
    const auto stack = testing::random_stack(1, {3, 3}, 1.0, 1.0, 9);
    const Ground ground(stack, kGround, Border::extend);
    EXPECT_THROW(ConvolutionField(ground, 0.0), Error);
    EXPECT_THROW(ConvolutionField(ground, std::nan("")), Error);
    EXPECT_THROW(ConvolutionField(ground, 65.0), Error);
    EXPECT_THROW(Ground(stack, material_set({Material::air}), Border::extend), Error);
    EXPECT_THROW(Ground(stack, 0, Border::extend), Error);
    EXPECT_THROW(Ground(stack, kGround, Border::cut, -1), Error);
}

}  // namespace
}  // namespace hoodoo
