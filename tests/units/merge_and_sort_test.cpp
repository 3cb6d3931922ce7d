// The settling of one column, which ends every edit.
#include "terrain/stack/merge_and_sort.h"

#include "tests/stacks.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using Column = std::vector<Layer>;

TEST(MergeAndSort, lays_loose_material_down_in_its_pocket)
{
    using enum Material;
    // Floor of bedrock to 4, roof from 20 to 25. Rock, air, sand, water, soil between; sand above the roof.
    const Column loose = {{bedrock, 4}, {rock, 6}, {air, 9}, {sand, 10}, {water, 13}, {soil, 15}, {air, 20}, {bedrock, 25}, {air, 27}, {sand, 30}};
    const Column settled = {{bedrock, 4}, {sand, 5}, {soil, 7}, {rock, 9}, {water, 12}, {air, 20}, {bedrock, 25}, {sand, 28}};
    EXPECT_EQ(merge_and_sort(loose), settled);
    EXPECT_EQ(merge_and_sort(settled), settled);
    EXPECT_TRUE(merge_and_sort(Column{{air, 9}}).empty());
    EXPECT_EQ(merge_and_sort(Column{{air, 9}, {sand, 11}}), (Column{{sand, 2}}));
}

TEST(MergeAndSort, keeps_the_thickness_of_every_material)
{
    const auto stack = testing::random_stack(12, {20, 20}, 1.0, 1.0, 200);
    for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 20; ++i) {
            std::array<std::int32_t, kMaterialCount> before{}, after{};
            const auto measure = [](const Column& column, auto& sums) {
                std::int32_t below = 0;
                for (const Layer& layer : column) {
                    sums[static_cast<std::size_t>(layer.material)] += layer.top - below;
                    below = layer.top;
                }
            };
            measure(stack->column(i, j), before);
            measure(merge_and_sort(stack->column(i, j)), after);
            for (const Material m : {Material::water, Material::sand, Material::bedrock, Material::rock, Material::soil}) {
                EXPECT_EQ(before[static_cast<std::size_t>(m)], after[static_cast<std::size_t>(m)]);
            }
        }
    }
}

}  // namespace
}  // namespace hoodoo
