// Voxels of another terrain: whether what edits lay bare shows what it is made of.
#include "tests/support/row_builder.h"
#include "tests/support/surface_laws.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::error_of_row;
using testing::nearest_hit;

/// A block of 2 m of bedrock under 1 m of sand.
std::shared_ptr<const Surface> layers()
{
    std::unique_ptr<Shape> shape;
    EXPECT_EQ(error_of_row("convolution",
                           "columns = [16, 16]\ncell = 0.25\nunit = 0.015625\nborder = \"cut\"\n[[layer]]\nshape = \"flat\"\ntop = 2.0\n[[layer]]\n"
                           "shape = \"flat\"\nthickness = 1.0\nmaterial = \"sand\"\n",
                           &shape),
              "");
    return std::move(std::get<std::unique_ptr<Surface>>(*shape));
}

/// What a ray straight down at (x, y) meets: its height, and its most seen material.
std::pair<double, std::string> below(const Surface& surface, double x, double y)
{
    Ray ray;
    ray.origin = Vec3d(x, y, 10.0);
    ray.direction = Vec3d(0, 0, -1);
    const Hit hit = nearest_hit(surface, ray);
    if (!std::isfinite(hit.t)) return {0.0, "nothing"};
    const Interaction at = surface.interact(ray, hit);
    std::size_t most = 0;
    for (std::size_t m = 1; m < at.materials.count; ++m)
        if (at.materials.weight[m] > at.materials.weight[most]) most = m;
    return {at.position.z, surface.materials()[at.materials.index[most]]};
}

TEST(VoxelsRow, what_an_edit_lays_bare_shows_what_it_is_made_of)
{
    std::unique_ptr<Shape> shape;
    ASSERT_EQ(error_of_row("voxels",
                           "base = \"layers\"\ncell = 0.125\n[[edit]]\ntool = \"sculpt\"\npoints = [[1.2, 2, 3.1], [1.2, 2, 1.5]]\nradius = [0.6]\n"
                           "[[edit]]\ntool = \"sculpt\"\npoints = [[3.0, 2, 3.1]]\nradius = [0.5]\n",
                           &shape, layers()),
              "");
    const Surface& surface = *std::get<std::unique_ptr<Surface>>(*shape);
    const auto [top, on_top] = below(surface, 2.1, 0.8);
    EXPECT_NEAR(top, 3.0, 0.02);
    EXPECT_EQ(on_top, "sand");
    const auto [pit, in_pit] = below(surface, 1.2, 2.0);
    EXPECT_NEAR(pit, 0.9, 0.02) << "the deep pit ends in the bedrock";
    EXPECT_EQ(in_pit, "bedrock");
    const auto [dent, in_dent] = below(surface, 3.0, 2.0);
    EXPECT_NEAR(dent, 2.6, 0.02) << "the shallow one in the sand";
    EXPECT_EQ(in_dent, "sand");
}

TEST(VoxelsRow, errors_say_what_is_wrong)
{
    const auto error_of = [](const std::string& text, std::shared_ptr<const Surface> base = nullptr) {
        return error_of_row("voxels", text, nullptr, base);
    };
    EXPECT_EQ(error_of(""), "t:1:1: voxels come from a file or from a terrain, expected either `file` or `base`");
    EXPECT_EQ(error_of("base = \"x\"\nfile = \"y.npy\""),
              "t:2:8: voxels come from a file or from a terrain, not from both, expected either `file` or `base`");
    EXPECT_EQ(error_of("base = \"x\""), "t:1:8: there is no other terrain to sample, expected the name of a terrain, got \"x\"");
    EXPECT_EQ(error_of("base = \"x\"", layers()), "t:1:8: voxels of a terrain need a cell, expected a length `cell`");
    EXPECT_EQ(error_of("base = \"x\"\ncell = 1e-4", layers()).substr(0, 85),
              "t:2:8: so many voxels cannot be sampled, expected fewer than 4e9 in the region, got 4");
    EXPECT_EQ(error_of("base = \"x\"\ncell = 0.1\nregion_min = [0, 0, 9]\nregion_max = [4, 4, 9]", layers()),
              "t:4:14: the region to sample is empty, expected min below max");
    EXPECT_EQ(error_of("base = \"x\"\ncell = 0.25\nregion_min = [0, 0, 9]\nregion_max = [4, 4, 12]", layers()),
              "t:1:8: there is no surface in the voxels, expected values on both sides of the surface");
}

}  // namespace
}  // namespace hoodoo
