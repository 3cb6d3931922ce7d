// The pictures behind cracked ground say what rays meet.
#include "terrain/io/crack_maps.h"
#include "terrain/error.h"
#include "terrain/surfaces/cracked.h"
#include "tests/support/crack_oracle.h"
#include "tests/support/surface_laws.h"
#include "tests/support/wavy_ground.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

const Vec2d kCorner(3.0, -7.0);

std::unique_ptr<CrackedSurface> cracked()
{
    const auto ground = std::make_shared<WavyGround>(0.45, kCorner);
    const Box2d unit(Vec2d(0.0), Vec2d(1.0));
    CrackedField field(std::shared_ptr<const Height>(ground, ground->height()), CrackNetwork(VoronoiDiagram(golden_sites(200), unit), 0.02), {},
                       Box2d(kCorner, kCorner + Vec2d(1.0)), 0.0, 1.0);
    return std::make_unique<CrackedSurface>(ground, std::move(field), CrackedPatchSettings{0.1, 1e-9}, CrackedSurface::Looks{"clay", ""});
}

TEST(CrackMaps, pixels_equal_what_is_traced_at_their_centres)
{
    const auto surface = cracked();
    const HeightImage map = crack_map(surface->cracks(), 1.0 / 64.0), heights = cracked_heights(surface->cracks(), 1.0 / 64.0);
    ASSERT_EQ(map.width, 64);
    ASSERT_EQ(map.height, 64);
    EXPECT_EQ(heights.cell, 1.0 / 64.0);
    int torn = 0;
    for (int row = 0; row < 64; ++row) {
        for (int column = 0; column < 64; ++column) {
            Ray ray;
            ray.origin = Vec3d(kCorner.x + (column + 0.5) / 64.0, kCorner.y + (63 - row + 0.5) / 64.0, 2.0);
            ray.direction = Vec3d(0, 0, -1);
            const Hit hit = nearest_hit(*surface, ray);
            ASSERT_TRUE(std::isfinite(hit.t));
            EXPECT_NEAR(heights.at(column, row), 2.0 - hit.t, 1e-7) << column << ", " << row;
            const Interaction at = surface->interact(ray, hit);
            // Beyond psi + epsilon = 0.6 a crack has no depth, and so no clay.
            const bool clay = at.materials.index[0] == 1;
            EXPECT_EQ(map.at(column, row) == 1.0f && 2.0 - hit.t < 0.6, clay) << column << ", " << row;
            torn += clay;
        }
    }
    EXPECT_GT(torn, 400);
    EXPECT_LT(torn, 2500);
}

TEST(CrackMaps, cells_that_do_not_fit_are_left_out_and_too_many_are_an_error)
{
    const auto surface = cracked();
    EXPECT_EQ(crack_map(surface->cracks(), 0.3).width, 3);
    EXPECT_EQ(crack_map(surface->cracks(), 7.0).width, 1);
    try {
        crack_map(surface->cracks(), 1e-5);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the picture is too large, expected at most 134217728 pixels: a larger cell, got 100000 x 100000 of 1e-05 m");
    }
}

TEST(CrackMaps, the_diagram_draws_every_site_and_every_border)
{
    const auto surface = cracked();
    const std::string svg = crack_diagram(surface->cracks()).svg();
    // Dots are lines from a point to itself: 200 of them in the first path.
    const std::size_t first = svg.find("<path"), second = svg.find("<path", first + 1);
    const auto begins = std::count(svg.begin() + static_cast<std::ptrdiff_t>(first), svg.begin() + static_cast<std::ptrdiff_t>(second), 'M');
    EXPECT_EQ(begins, 200);
}

TEST(Drawing, a_pixel_is_covered_as_far_as_a_line_reaches)
{
    Drawing page(8.0, 4.0);
    page.rectangle({0.0, 0.0}, {2.0, 1.5}, {0, 0, 0});
    page.line({4.0, 2.5}, {8.0, 2.5}, {255, 0, 0}, 1.0);
    const std::vector<std::uint8_t> pixels = page.pixels();
    ASSERT_EQ(pixels.size(), 3u * 8u * 4u);
    const auto at = [&](int x, int y, int c) { return int{pixels[static_cast<std::size_t>(3 * (y * 8 + x) + c)]}; };
    EXPECT_EQ(at(0, 0, 0), 0);
    EXPECT_EQ(at(1, 1, 0), 128);  // half covered: 255 - 127.5, rounded away from zero
    EXPECT_EQ(at(2, 0, 0), 255);
    EXPECT_EQ(at(5, 2, 0), 255);
    EXPECT_EQ(at(5, 2, 1), 0);
    EXPECT_EQ(at(5, 1, 1), 255);
}

TEST(Drawing, svg_joins_lines_of_one_look_and_cuts_them_at_the_clip)
{
    Drawing page(10.0, 10.0);
    page.clip_to({0.0, 0.0}, {5.0, 5.0});
    page.line({1.0, 1.0}, {3.0, 1.0}, {0, 0, 0}, 1.0);
    page.line({3.0, 1.0}, {9.0, 1.0}, {0, 0, 0}, 1.0);
    page.line({6.0, 6.0}, {9.0, 9.0}, {0, 0, 0}, 1.0);
    page.text({1.0, 2.0}, "a < b & c", 8.0);
    EXPECT_EQ(page.svg(),
              "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"10\" viewBox=\"0 0 10 10\">\n"
              "<rect width=\"10\" height=\"10\" fill=\"#ffffff\"/>\n"
              "<path fill=\"none\" stroke=\"#000000\" stroke-width=\"1\" stroke-linecap=\"round\" d=\"M1.00 1.00L3.00 1.00L5.00 1.00\"/>\n"
              "<text x=\"1.00\" y=\"2.00\" font-family=\"sans-serif\" font-size=\"8\">a &lt; b &amp; c</text>\n"
              "</svg>\n");
}

}  // namespace
}  // namespace hoodoo
