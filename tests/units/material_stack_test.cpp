// The packed stack: what goes in comes out, in its canonical form; its memory; its refusals; the border rule.
#include "terrain/stack/material_stack.h"

#include "terrain/error.h"
#include "tests/stacks.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

TEST(MaterialStack, columns_come_out_as_they_went_in)
{
    const Vec2i size(67, 41);  // tiles of 32: three by two, the last ones partly filled
    const auto stack = testing::random_stack(3, size, 2.0, 0.1, 300);
    std::uint64_t layers = 0;
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) {
            const std::vector<Layer> column = stack->column(i, j);
            ASSERT_FALSE(column.empty());
            EXPECT_NE(column.back().material, Material::air);
            for (std::size_t k = 1; k < column.size(); ++k) {
                EXPECT_GT(column[k].top, column[k - 1].top);
                EXPECT_NE(column[k].material, column[k - 1].material);
            }
            layers += column.size();
        }
    }
    EXPECT_EQ(stack->layer_count(), layers);

    const std::vector<Layer> before = stack->column(40, 20), beside = stack->column(41, 20);
    const std::vector<Layer> layered = {{Material::bedrock, 10}, {Material::air, 20}, {Material::rock, 8191}};
    stack->set_column(40, 20, layered);
    EXPECT_EQ(stack->column(40, 20), layered);
    EXPECT_EQ(stack->column(41, 20), beside);
    EXPECT_EQ(stack->highest_top(), 8191);
    stack->set_column(40, 20, before);
    EXPECT_EQ(stack->column(40, 20), before);
}

TEST(MaterialStack, equal_neighbours_merge_and_empty_layers_and_air_on_top_vanish)
{
    MaterialStack stack({1, 1}, 1.0, 1.0);
    const std::vector<Layer> loose = {{Material::sand, 0}, {Material::bedrock, 3}, {Material::bedrock, 5},
                                      {Material::sand, 5}, {Material::bedrock, 6}, {Material::air, 9}};
    stack.set_column(0, 0, loose);
    EXPECT_EQ(stack.column(0, 0), (std::vector<Layer>{{Material::bedrock, 6}}));
    EXPECT_EQ(stack.layer_count(), 1u);
}

TEST(MaterialStack, takes_two_bytes_a_layer_two_a_column_and_little_a_tile)
{
    // 1024 x 768 columns of 3 layers: N (2 + 2 n) = 6.3 MB and 768 tiles of 32 to 64 bytes; the paper's encoding took 28 bytes a column.
    const Vec2i size(1024, 768);
    MaterialStack stack(size, 1.0, 1.0);
    const std::vector<Layer> column = {{Material::bedrock, 5}, {Material::sand, 6}, {Material::soil, 7}};
    stack.set_columns({0, 0}, size, std::vector<std::vector<Layer>>(static_cast<std::size_t>(size.x) * size.y, column));
    const std::uint64_t payload = static_cast<std::uint64_t>(size.x) * size.y * 8;
    EXPECT_GE(stack.memory_bytes(), payload);
    EXPECT_LE(stack.memory_bytes(), payload + 768 * 64 + 4096);
}

std::string refusal(auto&& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(MaterialStack, refuses_columns_it_cannot_hold_and_stays_as_it_was)
{
    MaterialStack stack({4, 3}, 1.0, 1.0);
    const std::vector<Layer> good = {{Material::bedrock, 7}}, falling = {{Material::bedrock, 7}, {Material::sand, 6}},
                             high = {{Material::bedrock, 8192}};
    stack.set_column(2, 1, good);
    EXPECT_NE(refusal([&] {
                  stack.set_column(2, 1, falling);
              }).find("column (2, 1): a layer ends below the one under it, expected a top of at least 7 units, got 6"),
              std::string::npos);
    EXPECT_NE(refusal([&] { stack.set_column(2, 1, high); }).find("a top of at most 8191 units, got 8192"), std::string::npos);
    EXPECT_NE(refusal([&] { stack.set_column(4, 1, good); }), "accepted");
    EXPECT_EQ(stack.column(2, 1), good);
    EXPECT_NE(refusal([] { MaterialStack({0, 3}, 1.0, 1.0); }), "accepted");
    EXPECT_NE(refusal([] { MaterialStack({3, 3}, 0.0, 1.0); }), "accepted");
    EXPECT_NE(refusal([] { MaterialStack({3, 3}, 1.0, std::nan("")); }), "accepted");
    EXPECT_NE(refusal([] { material_from_name("bedrok"); }).find("bedrock"), std::string::npos);
    EXPECT_EQ(material_from_name("soil"), Material::soil);
}

std::vector<Run> runs(const Ground& ground, int i, int j)
{
    std::vector<Run> found;
    ground.for_each_run(i, j, [&](Run run) { found.push_back(run); });
    return found;
}

TEST(Ground, runs_are_the_matter_of_the_set_and_end_where_the_border_says)
{
    auto stack = std::make_shared<MaterialStack>(Vec2i(2, 2), 1.0, 1.0);
    stack->set_column(0, 0, std::vector<Layer>{{Material::sand, 2}, {Material::air, 5}, {Material::bedrock, 9}, {Material::rock, 12}});
    const Ground extend(stack, kGround, Border::extend), cut(stack, kGround, Border::cut, 3);
    ASSERT_EQ(runs(extend, 0, 0).size(), 2u);
    EXPECT_EQ(runs(extend, 0, 0)[0].bottom, Ground::bottomless);
    EXPECT_EQ(runs(extend, 0, 0)[0].top, 2);
    EXPECT_EQ(runs(extend, 0, 0)[1].bottom, 5);
    EXPECT_EQ(runs(extend, 0, 0)[1].top, 9);
    EXPECT_EQ(runs(extend, -7, -9)[1].top, 9);  // the edge column, repeated
    EXPECT_EQ(runs(cut, 0, 0)[0].bottom, -3);
    EXPECT_TRUE(runs(cut, -1, 0).empty());
    EXPECT_TRUE(runs(cut, 0, 2).empty());
    const Ground rock(stack, material_set({Material::rock}), Border::extend);
    ASSERT_EQ(runs(rock, 0, 0).size(), 1u);
    EXPECT_EQ(runs(rock, 0, 0)[0].bottom, 9);
    EXPECT_TRUE(runs(rock, 1, 1).empty());
}

TEST(Ground, length_is_that_of_the_runs_clipped)
{
    const auto stack = testing::random_stack(8, {9, 9}, 1.0, 1.0, 40);
    for (const Border border : {Border::extend, Border::cut}) {
        const Ground ground(stack, material_set({Material::bedrock, Material::soil}), border, 6);
        for (std::uint64_t k = 0; k < 2000; ++k) {
            const int i = static_cast<int>(mix64(4 * k) % 13) - 2, j = static_cast<int>(mix64(4 * k + 1) % 13) - 2;
            const double low = unit_real(mix64(4 * k + 2)) * 60 - 12, high = low + unit_real(mix64(4 * k + 3)) * 20;
            double expected = 0;
            ground.for_each_run(
                i, j, [&](const auto& run) { expected += std::max(0.0, std::min<double>(run.top, high) - std::max<double>(run.bottom, low)); });
            ASSERT_NEAR(ground.length(i, j, low, high), expected, 1e-12);
        }
    }
}

}  // namespace
}  // namespace hoodoo
