// Materials that turn into others by slope, altitude and maps.
#include "renderer/shading/mask.h"
#include "terrain/io/raster.h"
#include "tests/tables.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

const ColorConverter kAsWritten = [](const ColorValue& c) { return Vec3f(c.rgb); };

/// A flat colour that tells which look was asked.
class Plain final : public Look
{
public:
    Plain(float albedo, float roughness, const Vec3d& normal) : a_{Vec3f(albedo), roughness, normal, 0.0f} {}
    Appearance appearance(const Interaction&, double) const override { return a_; }

private:
    Appearance a_;
};

std::unique_ptr<Look> plain(const std::string& name)
{
    if (name == "sand") return std::make_unique<Plain>(0.8f, 1.0f, Vec3d(0.6, 0.0, 0.8));
    return std::make_unique<Plain>(0.2f, 0.0f, Vec3d(0, 0, 1));
}

Values material(std::initializer_list<Node> masks)
{
    std::vector<Problem> problems;
    const Values values = check(material_schema(), table({{"mask", tables(masks)}}), problems);
    for (const Problem& p : problems) ADD_FAILURE() << p.text();
    return values;
}

Appearance seen(const Values& values, const Vec3d& p, const Vec3d& n = Vec3d(0, 0, 1), const Vec2d& uv = Vec2d(0.0))
{
    Interaction at;
    at.position = p;
    at.uv = uv;
    at.geometric_normal = at.shading_normal = n.normalized();
    return with_masks(plain("rock"), values, {}, plain)->appearance(at, 0.1);
}

/// A map of 3 x 2 pixels of 10 m in a file of this process.
std::string map_file(std::vector<float> values, double cell = 10.0)
{
    static int n = 0;
    const std::string path = (std::filesystem::temp_directory_path() / fmt::format("hoodoo_mask_{}_{}.exr", ::getpid(), n++)).string();
    write_raster(path, {3, 2, cell, {"wetness"}, {std::move(values)}});
    return path;
}

std::string error_of(const Values& values)
{
    try {
        with_masks(plain("rock"), values, {}, plain);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Mask, slope_is_the_angle_of_the_geometric_normal)
{
    const Values values = material({table({{"by", "slope"}, {"into", "sand"}, {"from", "40 deg"}, {"to", "20 deg"}})});
    EXPECT_FLOAT_EQ(seen(values, Vec3d(0.0)).albedo.x, 0.8f) << "flat";
    EXPECT_FLOAT_EQ(seen(values, Vec3d(0.0), Vec3d(1, 0, 1)).albedo.x, 0.2f) << "45 degrees";
    // Half way, at 30 degrees: everything is mixed evenly.
    const Appearance half = seen(values, Vec3d(0.0), Vec3d(0.5, 0.0, std::sqrt(0.75)));
    EXPECT_NEAR(half.albedo.x, 0.5f, 1e-6);
    EXPECT_NEAR(half.roughness, 0.5f, 1e-6);
    EXPECT_NEAR((half.normal - Vec3d(0.3, 0.0, 0.9).normalized()).length(), 0.0, 1e-12);
    EXPECT_FLOAT_EQ(seen(values, Vec3d(0.0), Vec3d(0, 0, -1)).albedo.x, 0.2f) << "a ceiling is steep";
}

TEST(Mask, altitude_is_a_height)
{
    const Values values = material({table({{"by", "altitude"}, {"into", "sand"}, {"from", 100.0}, {"to", 200.0}})});
    EXPECT_FLOAT_EQ(seen(values, Vec3d(5, 5, 99)).albedo.x, 0.2f);
    EXPECT_FLOAT_EQ(seen(values, Vec3d(5, 5, 201)).albedo.x, 0.8f);
    // A quarter of the way: 3/16 - 2/64.
    EXPECT_NEAR(seen(values, Vec3d(5, 5, 125)).albedo.x, 0.2f + 0.6f * 0.15625f, 1e-6);
}

TEST(Mask, a_map_is_read_at_its_pixels_centres_and_between)
{
    // North on top: 1 in the north-west, 0 elsewhere but 2 in the south-east.
    const std::string path = map_file({1, 0, 0, 0, 0, 2});
    const Values values =
        material({table({{"by", "map"}, {"into", "sand"}, {"from", 0.0}, {"to", 2.0}, {"map", path}, {"origin", {100.0, 1000.0}}})});
    const auto share = [&](double x, double y) { return (seen(values, Vec3d(100 + x, 1000 + y, 0)).albedo.x - 0.2) / 0.6; };
    EXPECT_NEAR(share(5, 15), 0.5, 1e-6);
    EXPECT_NEAR(share(25, 5), 1.0, 1e-6);
    EXPECT_NEAR(share(15, 15), 0.0, 1e-6);
    EXPECT_NEAR(share(20, 5), 0.5, 1e-6) << "between 0 and 2";
    EXPECT_NEAR(share(-40, 90), 0.5, 1e-6) << "beyond its edge the map goes on";
    std::filesystem::remove(path);
}

TEST(Mask, a_map_under_uv_follows_the_surface_and_repeats)
{
    // Pixels of 2 x 3 units in a span of 6: 0, 1, 2 from west to east, in both rows.
    const std::string path = map_file({0, 1, 2, 0, 1, 2});
    const Values values = material({table(
        {{"by", "map"}, {"into", "sand"}, {"from", 0.0}, {"to", 2.0}, {"map", path}, {"projection", "uv"}, {"span", 6.0}, {"origin", {1.0, 0.0}}})});
    const auto share = [&](double u) { return (seen(values, Vec3d(u * 77, 5, 3), Vec3d(0, 0, 1), Vec2d(u, 2.0)).albedo.x - 0.2) / 0.6; };
    EXPECT_NEAR(share(2.0), 0.0, 1e-6) << "the first pixel's centre, wherever the point lies";
    EXPECT_NEAR(share(4.0), 0.5, 1e-6);
    EXPECT_NEAR(share(6.0), 1.0, 1e-6);
    EXPECT_NEAR(share(7.0), 0.5, 1e-6) << "half-way from the last to the first of the next";
    EXPECT_NEAR(share(4.0 - 60.0), 0.5, 1e-6) << "ten repeats away";
    std::filesystem::remove(path);
}

TEST(Mask, masks_into_one_material_are_multiplied)
{
    const Values values = material({table({{"by", "slope"}, {"into", "sand"}, {"from", "40 deg"}, {"to", "20 deg"}}),
                                    table({{"by", "altitude"}, {"into", "sand"}, {"from", 200.0}, {"to", 100.0}})});
    EXPECT_FLOAT_EQ(seen(values, Vec3d(0.0)).albedo.x, 0.8f) << "flat and low";
    EXPECT_FLOAT_EQ(seen(values, Vec3d(0, 0, 300)).albedo.x, 0.2f) << "flat but high";
    EXPECT_NEAR(seen(values, Vec3d(0, 0, 150), Vec3d(0.5, 0.0, std::sqrt(0.75))).albedo.x, 0.35f, 1e-6) << "half of half";
}

TEST(Mask, a_material_without_masks_keeps_its_look)
{
    std::unique_ptr<Look> look = plain("rock");
    const Look* before = look.get();
    EXPECT_EQ(with_masks(std::move(look), material({}), {}, plain).get(), before);
}

TEST(Mask, errors_name_what_is_wrong)
{
    EXPECT_EQ(error_of(material({table({{"by", "altitude"}, {"into", "sand"}, {"from", 3.0}, {"to", 3.0}})})),
              "a mask that goes from a value to itself, expected two values that differ, got 3 twice");
    const std::string path = map_file({0, 0, 0, 0, 0, 0});
    const auto mask = [&](const std::string& file, const char* channel) {
        return material({table({{"by", "map"}, {"into", "sand"}, {"from", 0.0}, {"to", 1.0}, {"map", file}, {"channel", channel}})});
    };
    EXPECT_EQ(error_of(mask(path, "wetnes")),
              path + ": the map has no such channel, expected one of wetness, got \"wetnes\" (did you mean \"wetness\")");
    EXPECT_EQ(error_of(mask("/nowhere.exr", "wetness")), "/nowhere.exr: cannot read the map, expected a regular file, got No such file or directory");
    const std::string unsized = map_file({0, 0, 0, 0, 0, 0}, 0.0);
    EXPECT_EQ(error_of(mask(unsized, "wetness")),
              "the map does not say how large its pixels are, expected a `cell` in the mask, or an image with hoodoo:cell");
    const std::string broken = map_file({0, std::nanf(""), 0, 0, 0, 0});
    EXPECT_EQ(error_of(mask(broken, "wetness")), "a sample of the map is no number, expected finite samples, got nan");
    for (const std::string& file : {path, unsized, broken}) std::filesystem::remove(file);
}

}  // namespace
}  // namespace hoodoo
