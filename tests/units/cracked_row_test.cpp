// What a scene may say of cracked ground, and what it is told where it cannot be.
#include "terrain/surfaces/cracked.h"
#include "tests/support/row_builder.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

std::string flat(const std::string& more)
{
    return more + "\n[[ground]]\ntype = \"plane\"\nextent = 10.0\n";
}

std::string error_of(const std::string& text, std::unique_ptr<Shape>* built = nullptr, std::shared_ptr<const Surface> base = nullptr)
{
    return testing::error_of_row("cracked", text, built, std::move(base));
}

const CrackedField& cracks_of(const std::unique_ptr<Shape>& shape)
{
    return dynamic_cast<const CrackedSurface&>(*std::get<std::unique_ptr<Surface>>(*shape)).cracks();
}

TEST(CrackedRow, defaults_are_the_papers)
{
    std::unique_ptr<Shape> shape;
    ASSERT_EQ(error_of(flat("zero = -1.0\none = 1.0"), &shape), "");
    const CrackedField& cracks = cracks_of(shape);
    EXPECT_EQ(cracks.depth().kappa, 0.3);
    EXPECT_EQ(cracks.depth().psi, 0.4);
    EXPECT_EQ(cracks.depth().epsilon, 0.2);
    // 20 m a side, 200 sites: a tenth of sqrt(2) m.
    EXPECT_DOUBLE_EQ(cracks.network().width(), 0.1 * std::sqrt(2.0));
    EXPECT_EQ(cracks.region().min, Vec2d(-10.0));
    EXPECT_EQ(cracks.region().max, Vec2d(10.0));
    // 200 of them and a rim of 0.25 sqrt(2) m: (20.7071 / 20)^2 - 1 = 7.196 %.
    EXPECT_EQ(cracks.network().diagram().sites().size(), 214u);
}

TEST(CrackedRow, heights_count_from_the_lowest_to_the_highest_of_the_ground)
{
    std::unique_ptr<Shape> shape;
    ASSERT_EQ(
        error_of("region_min = [-2.0, -3.0]\nregion_max = [4.0, 5.0]\n[[ground]]\ntype = \"plane\"\nnormal = [-0.5, 0.25, 1.0]\nextent = 10.0\n",
                 &shape),
        "");
    // z = 0.5 x - 0.25 y: least at (-2, 5), most at (4, -3); found to 1e-4 of 5 m.
    EXPECT_NEAR(cracks_of(shape).zero(), -2.25, 5e-4);
    EXPECT_NEAR(cracks_of(shape).one(), 2.75, 5e-4);
}

TEST(CrackedRow, errors_say_what_is_wrong)
{
    EXPECT_EQ(error_of(flat("")), "t:1:1: the elevations of h = 0 and h = 1, expected zero below one (flat ground needs both), got 0 m and 0 m");
    EXPECT_EQ(error_of("n = 3"), "t:1:1: what is cracked, expected either base = \"NAME\" or one [[ground]] table, got neither");
    EXPECT_EQ(error_of(flat("base = \"x\"")), "t:1:1: what is cracked, expected either base = \"NAME\" or one [[ground]] table, got both");
    EXPECT_EQ(error_of("base = \"x\""), "t:1:8: there is no other terrain to crack, expected the name of a terrain, got \"x\"");
    EXPECT_EQ(
        error_of("[[ground]]\ntype = \"plane\"\nnormal = [1.0, 0.0, 0.0]\n"),
        "t:1:1: this terrain cannot be cracked: it is no height over the plane, expected a terrain such as heightfield or elevation, got \"plane\"");
    EXPECT_EQ(error_of(flat("region_max = [11.0, 2.0]")),
              "t:1:14: the region reaches beyond the ground, expected [-10, -10] to [10, 10], got [-10, -10] to [11, 2]");
    EXPECT_EQ(error_of(flat("region_max = [-10.0, 2.0]")),
              "t:1:14: the region that is cracked is empty, expected region_min below region_max, got [-10, -10] to [-10, 2]");
    EXPECT_EQ(error_of(flat("kappa = 1.0\nzero = 0.0\none = 1.0")), "t:1:9: kappa is out of range, expected a number between 0 and 0.99, got 1");
}

TEST(CrackedRow, a_terrain_without_height_cannot_be_cracked)
{
    struct Cave final : Surface {
        std::uint32_t patch_count(std::uint32_t) const override { return 0; }
        Box3d patch_bounds(PatchId) const override { return {}; }
        bool intersect(PatchId, const Ray&, Hit&) const override { return false; }
        Interaction interact(const Ray&, const Hit&) const override { return {}; }
        bool contains(const Vec3d&) const override { return false; }
        std::vector<std::string> materials() const override { return {"rock"}; }
        bool closed() const override { return true; }
        SurfaceInfo info() const override { return {}; }
    };
    EXPECT_EQ(
        error_of("base = \"cave\"", nullptr, std::make_shared<Cave>()),
        "t:1:8: this terrain cannot be cracked: it is no height over the plane, expected a terrain such as heightfield or elevation, got \"cave\"");
}

}  // namespace
}  // namespace hoodoo
