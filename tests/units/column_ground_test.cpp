// Layers as a height: the tops of their columns, at the columns' middles.
#include "terrain/surfaces/column_ground.h"
#include "terrain/error.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

/// 3 x 2 columns of 2 m from (10, 20, 5), steps of half a metre.
MaterialStack stack()
{
    MaterialStack stack({3, 2}, 2.0, 0.5, Vec3d(10, 20, 5));
    stack.set_column(0, 0, std::vector<Layer>{{Material::bedrock, 4}});
    stack.set_column(1, 0, std::vector<Layer>{{Material::bedrock, 2}, {Material::sand, 6}});
    stack.set_column(2, 0, std::vector<Layer>{{Material::bedrock, 2}, {Material::water, 8}});
    stack.set_column(1, 1, std::vector<Layer>{{Material::bedrock, 2}, {Material::air, 5}, {Material::soil, 7}});
    return stack;
}

TEST(ColumnGround, tops_stand_at_the_middles_of_columns)
{
    const ColumnGround ground(stack());
    const Height& h = *ground.height();
    EXPECT_DOUBLE_EQ(h.height({11, 21}), 7.0);
    EXPECT_DOUBLE_EQ(h.height({13, 21}), 8.0);
    EXPECT_DOUBLE_EQ(h.height({15, 21}), 6.0) << "water is no ground";
    EXPECT_DOUBLE_EQ(h.height({13, 23}), 8.5) << "the highest of it, whatever is below";
    EXPECT_DOUBLE_EQ(h.height({11, 23}), 5.0) << "no layers: the stack's origin";
    EXPECT_DOUBLE_EQ(h.height({12, 21}), 7.5) << "half way";
    EXPECT_EQ(h.domain().min, Vec2d(11, 21));
    EXPECT_EQ(h.domain().max, Vec2d(15, 23));
}

TEST(ColumnGround, looks_are_those_of_the_columns_about)
{
    const ColumnGround ground(stack());
    EXPECT_EQ(ground.materials(), (std::vector<std::string>{"bedrock", "sand", "soil"}));
    Interaction at;
    at.geometric_normal = Vec3d(0, 0, 1);
    at.position = Vec3d(12.5, 22.5, 8);  // three quarters towards column 1, three quarters towards row 1
    ground.dress(at);
    ASSERT_EQ(at.materials.count, 3u);
    EXPECT_FLOAT_EQ(at.materials.weight[0], 0.25f);
    EXPECT_FLOAT_EQ(at.materials.weight[1], 0.1875f);
    EXPECT_FLOAT_EQ(at.materials.weight[2], 0.5625f);
}

TEST(ColumnGround, one_column_is_no_ground)
{
    try {
        const ColumnGround ground(MaterialStack({1, 5}, 1.0, 0.1));
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the layers are too few columns for a ground, expected at least 2 x 2, got 1 x 5");
    }
}

}  // namespace
}  // namespace hoodoo
