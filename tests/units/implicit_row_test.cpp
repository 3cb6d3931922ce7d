// What a scene may say of a blob tree, and what it is told where it cannot be.
#include "terrain/field.h"
#include "tests/support/row_builder.h"
#include "tests/support/wavy_ground.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

std::string node(const std::string& name, const std::string& kind, const std::string& rest)
{
    return "[[node]]\nname = \"" + name + "\"\nkind = \"" + kind + "\"\n" + rest + "\n";
}

const std::string kBall = node("ball", "point", "at = [0, 0, 0]\nradius = 1.0");

std::string error_of(const std::string& text, std::unique_ptr<Shape>* built = nullptr, std::shared_ptr<const Surface> base = nullptr)
{
    return testing::error_of_row("implicit", text, built, std::move(base));
}

const Surface& surface_of(const std::unique_ptr<Shape>& shape)
{
    return *std::get<std::unique_ptr<Surface>>(*shape);
}

TEST(ImplicitRow, a_ball_is_a_ball_in_its_own_box)
{
    std::unique_ptr<Shape> shape;
    ASSERT_EQ(error_of(kBall, &shape), "");
    const Surface& surface = surface_of(shape);
    EXPECT_TRUE(surface.closed());
    EXPECT_EQ(surface.materials(), std::vector<std::string>{"bedrock"});
    EXPECT_NEAR(surface.field()->value(Vec3d(0.0, 3.0, 4.0)), 4.0, 1e-12) << "the distance to it";
    EXPECT_LT(surface.field()->value(Vec3d(0.5, 0.5, 0.5)), 0.0);
}

TEST(ImplicitRow, nodes_stand_in_any_order_and_the_last_is_the_root_unless_one_is_named)
{
    const std::string other = node("far", "point", "at = [4, 0, 0]\nradius = 1.0\nmaterial = \"sand\"");
    const std::string both = node("both", "union", "of = [\"far\", \"ball\"]");
    std::unique_ptr<Shape> shape;
    ASSERT_EQ(error_of(kBall + other + both, &shape), "");
    EXPECT_LT(surface_of(shape).field()->value(Vec3d(4, 0, 0)), 0.0);
    EXPECT_EQ(surface_of(shape).materials(), (std::vector<std::string>{"bedrock", "sand"}));
    ASSERT_EQ(error_of("root = \"both\"\n" + both + kBall + other, &shape), "");
    EXPECT_LT(surface_of(shape).field()->value(Vec3d(4, 0, 0)), 0.0);
}

TEST(ImplicitRow, a_name_twice_unknown_or_used_by_nothing_is_an_error)
{
    EXPECT_EQ(error_of(kBall + kBall), "t:7:8: two nodes have one name, expected a name of its own, got \"ball\"");
    EXPECT_EQ(error_of(kBall + node("all", "union", "of = [\"bal\"]")), "t:9:6: there is no node of this name, got \"bal\" (did you mean \"ball\")");
    EXPECT_EQ(error_of("root = \"bell\"\n" + kBall), "t:1:8: there is no node of this name, got \"bell\" (did you mean \"ball\")");
    EXPECT_EQ(error_of(kBall + node("other", "point", "at = [0, 0, 0]\nradius = 1.0")),
              "t:2:8: the node \"ball\" is used by nothing, expected a node that \"other\" is made of");
}

TEST(ImplicitRow, a_circle_of_nodes_is_an_error)
{
    EXPECT_EQ(error_of(node("a", "union", "of = [\"b\"]") + node("b", "union", "of = [\"a\"]")),
              "t:6:8: the node \"b\" is made of itself, expected nodes without a circle");
    EXPECT_EQ(error_of(node("a", "noise", "of = \"a\"\namplitude = 0.1\nwavelength = 1.0")),
              "t:2:8: the node \"a\" is made of itself, expected nodes without a circle");
}

TEST(ImplicitRow, shapes_that_are_none_are_errors)
{
    const auto polygon = [](const std::string& points) { return error_of(node("p", "polygon", "points = " + points + "\nradius = 0.1")); };
    EXPECT_EQ(polygon("[[0, 0, 0], [1, 0, 0], [2, 0, 0]]"), "t:4:10: a polygon, expected corners that enclose an area");
    EXPECT_EQ(polygon("[[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0]]").substr(0, 67),
              "t:4:10: a polygon, expected corners in one plane, got number 2 lies");
    EXPECT_EQ(error_of(node("c", "curve", "points = [[0, 0, 0], [1, 0, 0], [1, 0, 0]]\nradius = [0.5]")),
              "t:4:10: neighbouring points of a path, expected places apart, got number 2 twice");
    EXPECT_EQ(error_of(node("c", "curve", "points = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\nradius = [0.5, 0.6]")),
              "t:5:10: values along a path, expected one, or one for each of its points, got 2 for 3 points");
    EXPECT_EQ(error_of(node("d", "disc", "centre = [0, 0, 0]\nnormal = [0, 0, 0]\nextent = 1.0\nradius = 0.1")),
              "t:5:10: the normal of a disc, expected a vector with a length");
    EXPECT_EQ(error_of(node("s", "sweep", "points = [[0, 0, 0], [1, 0, 0]]\nprofile = [0, 0, 1, 0, 1, 1, 0]")),
              "t:5:11: a profile, expected x and y of each corner in turn, got 7 numbers");
    EXPECT_EQ(error_of(node("s", "sweep", "points = [[0, 0, 0], [1, 0, 0], [0, 0.1, 0]]\nprofile = [0, 0, 1, 0, 1, 1]\nsmooth = false")),
              "t:4:10: the path of a sweep, expected turns of at most 120 degrees, got a sharper one near (1, 0, 0)");
    EXPECT_EQ(error_of(node("b", "point", "at = [0, 0, 0]\nradius = 0.0")),
              "t:5:10: radius is out of range, expected a length such as 350 (metres) or \"350 m\" above 0, got 0");
}

TEST(ImplicitRow, flows_and_regions_that_cannot_be_are_errors)
{
    EXPECT_EQ(error_of("region_min = [0, 0, 5]\nregion_max = [1, 1, 4]\n" + kBall), "t:2:14: the region to trace is empty, expected min below max");
    const std::string warp = node("w", "warp", "of = \"ball\"\nintensity = 1e9\n[[node.flow]]\nkind = \"vortex\"\nradius = 1.0\nstrength = 50.0");
    EXPECT_EQ(error_of(kBall + warp).substr(0, 9), "t:10:13: ");
}

TEST(ImplicitRow, a_terrain_to_carve_needs_a_name_and_a_field)
{
    const std::string ground = node("ground", "terrain", "terrain = \"hill\"");
    EXPECT_EQ(error_of(ground), "t:4:11: there is no other terrain to carve, expected the name of a terrain, got \"hill\"");
    // A surface with a height and no field, as a mesh has neither.
    EXPECT_EQ(error_of(ground, nullptr, std::make_shared<testing::WavyGround>()),
              "t:4:11: this terrain cannot be carved: it has no field, expected a terrain with one field, got \"hill\"");
}

}  // namespace
}  // namespace hoodoo
