// Layers in a fixed order: to columns and back, sand that slides to rest, shores, materials, and maps that cannot be.

#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/fields/height.h"
#include "terrain/io/stack_file.h"
#include "terrain/math/hash.h"
#include "terrain/stack/layer_maps.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace hoodoo
{
namespace
{

LayerMaps random_maps(double unit)
{
    LayerMaps maps;
    maps.size = {23, 17};
    maps.cell = 2.0;
    maps.origin = {100.0, -50.0};
    for (int k = 0; k < 23 * 17; ++k) {
        const auto draw = [&](int salt, int most) { return static_cast<double>(hash_cell(11, k, salt) % static_cast<std::uint64_t>(most)); };
        maps.bedrock.push_back((draw(0, 900) - 300.0) * unit);
        maps.sand.push_back(k % 3 == 0 ? 0.0 : draw(1, 40) * unit);
        maps.water.push_back(k % 5 != 0 ? 0.0 : draw(2, 70) * unit);
    }
    return maps;
}

TEST(Layers, maps_in_whole_units_become_columns_and_come_back_exactly)
{
    for (const double unit : {0.125, 0.01, 1.0 / 3.0}) {
        const LayerMaps maps = random_maps(unit), back = from_stack(to_stack(maps, unit), {});
        EXPECT_EQ(back.size, maps.size);
        EXPECT_EQ(back.origin, maps.origin);
        for (std::size_t k = 0; k < maps.bedrock.size(); ++k) {
            ASSERT_EQ(back.bedrock[k], maps.bedrock[k]) << k << " unit " << unit;
            ASSERT_EQ(back.sand[k], maps.sand[k]) << k;
            ASSERT_EQ(back.water[k], maps.water[k]) << k;
        }
    }
}

TEST(Layers, columns_in_the_fixed_order_become_maps_and_come_back_exactly)
{
    MaterialStack stack({3, 2}, 1.5, 0.25, Vec3d(7, 8, 2.0));
    stack.set_column(0, 0, std::vector<Layer>{{Material::bedrock, 5}, {Material::sand, 9}, {Material::water, 12}});
    stack.set_column(1, 0, std::vector<Layer>{{Material::sand, 3}});
    stack.set_column(2, 0, std::vector<Layer>{{Material::bedrock, 4}, {Material::water, 6}});
    stack.set_column(0, 1, std::vector<Layer>{{Material::water, 2}});
    const LayerMaps maps = from_stack(stack, {});
    EXPECT_EQ(maps.bedrock, (std::vector<double>{2.0 + 1.25, 2.0, 3.0, 2.0, 2.0, 2.0}));
    EXPECT_EQ(maps.sand, (std::vector<double>{1.0, 0.75, 0.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(maps.water, (std::vector<double>{0.75, 0.0, 0.5, 0.5, 0.0, 0.0}));
    const MaterialStack back = to_stack(maps, 0.25);
    EXPECT_EQ(back.origin(), stack.origin());
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 3; ++i) EXPECT_EQ(back.column(i, j), stack.column(i, j)) << i << ", " << j;
}

std::string message(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        return error.problems()[0].text().substr(0, error.problems()[0].text().find('\n'));
    }
    return "accepted";
}

TEST(Layers, columns_of_another_order_are_refused_by_name)
{
    MaterialStack stack({2, 2}, 1.0, 0.5);
    stack.set_column(1, 0, std::vector<Layer>{{Material::bedrock, 2}, {Material::air, 4}, {Material::bedrock, 6}});
    EXPECT_EQ(message([&] {
                  from_stack(stack, {"a.exr", 0, 0, {}});
              }),
              "a.exr: layers of another order, expected bedrock, sand, water from the bottom up, got air in column (1, 0)");
    stack.set_column(1, 0, std::vector<Layer>{{Material::sand, 4}, {Material::bedrock, 6}});
    EXPECT_EQ(message([&] {
                  from_stack(stack, {"a.exr", 0, 0, {}});
              }),
              "a.exr: layers of another order, expected bedrock, sand, water from the bottom up, got bedrock in column (1, 0)");
    LayerMaps maps = random_maps(0.5);
    maps.sand[25] = -1.0;
    EXPECT_EQ(message([&] { to_stack(maps, 0.5); }), "the thickness of a layer, expected 0 or more, got -1 m in column (2, 1)");
    maps.sand[25] = std::nan("");
    EXPECT_EQ(message([&] { to_stack(maps, 0.5); }), "a layer's map, expected finite numbers, got column (2, 1)");
    EXPECT_EQ(message([&] { to_stack(random_maps(0.5), 0.01); }).substr(0, 57), "the layers are too high for this unit, expected at least ");
}

// -- As a terrain ------------------------------------------------------------------------------------------------------

class LayersRow : public ::testing::Test
{
protected:
    LayersRow() : folder_(std::filesystem::temp_directory_path() / fmt::format("hoodoo_layers_{}", ::getpid()))
    {
        std::filesystem::create_directories(folder_);
    }
    ~LayersRow() override { std::filesystem::remove_all(folder_); }

    /// Row 0 is the north.
    std::string map(const std::string& name, int width, const std::vector<float>& numbers) const
    {
        const std::string path = (folder_ / name).string();
        OIIO::ImageSpec spec(width, static_cast<int>(numbers.size()) / width, 1, OIIO::TypeDesc::FLOAT);
        const auto out = OIIO::ImageOutput::create(path);
        EXPECT_TRUE(out && out->open(path, spec));
        EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, numbers.data()));
        EXPECT_TRUE(out->close());
        return path;
    }

    static Values values_of(const std::string& text)
    {
        SceneBudget budget;
        std::vector<Problem> problems;
        const Node table = parse_toml(text, "<text>", budget, problems);
        Values values = check(find_in_catalogue("layers")->schema, table, problems);
        if (!problems.empty()) throw Error(ErrorKind::scene, problems);
        return values;
    }
    static std::unique_ptr<Surface> make(const std::string& text)
    {
        Shape shape = find_in_catalogue("layers")->make(values_of(text), BuildContext{});
        return std::move(std::get<std::unique_ptr<Surface>>(shape));
    }

    std::filesystem::path folder_;
};

Interaction straight_down(const Surface& surface, double x, double y, double from)
{
    Ray ray;
    ray.origin = Vec3d(x, y, from);
    ray.direction = Vec3d(0, 0, -1);
    Hit hit;
    hit.t = kInfinity;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
        for (std::uint32_t k = 0; k < surface.patch_count(tile); ++k) surface.intersect({tile, k}, ray, hit);
    return std::isfinite(hit.t) ? surface.interact(ray, hit) : Interaction{};
}

TEST_F(LayersRow, a_ray_from_above_meets_water_then_sand_or_rock)
{
    // A basin: 1 m in the middle column, 3 m around; half a metre of sand in the north-west; water up to 2 m.
    const std::string rock = map("rock.exr", 5, {3, 3, 3, 3, 3, 3, 1, 1, 1, 3, 3, 1, 1, 1, 3, 3, 3, 3, 3, 3});
    const std::string sand = map("sand.exr", 5, {0.5f, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    const auto surface = make(fmt::format("bedrock = \"{}\"\nsand = \"{}\"\nwater_level = 2.0\ncell = 2.0\ncover = 0.25\n", rock, sand));
    // Samples at 1, 3, 5, 7, 9 and 1, 3, 5, 7.
    const Interaction lake = straight_down(*surface, 5.0, 4.0, 10.0);
    EXPECT_NEAR(lake.position.z, 2.0, 1e-6);
    EXPECT_EQ(surface->materials()[lake.materials.index[0]], "water");
    EXPECT_NEAR(straight_down(*surface, 5.0, 4.0, 1.9).position.z, 1.0, 1e-6);  // from within the water: its bed
    const Interaction beach = straight_down(*surface, 1.0, 7.0, 10.0);
    EXPECT_NEAR(beach.position.z, 3.5, 1e-6);
    ASSERT_EQ(beach.materials.count, 1u);
    EXPECT_EQ(surface->materials()[beach.materials.index[0]], "sand");
    // Half way to a column without sand it is 0.25 m thick: as much as covers; three quarters of the way, 0.125 m: half of it shows.
    const Interaction thin = straight_down(*surface, 1.0, 5.5, 10.0);
    ASSERT_EQ(thin.materials.count, 2u);
    EXPECT_NEAR(thin.materials.weight[0], 0.5, 1e-6);
    // The shore lies where the ground passes 2 m, half way between samples of 1 and 3 m, not at a sample.
    EXPECT_EQ(surface->materials()[straight_down(*surface, 2.2, 4.0, 10.0).materials.index[0]], "water");
    EXPECT_EQ(surface->materials()[straight_down(*surface, 1.8, 4.0, 10.0).materials.index[0]], "bedrock");
    EXPECT_TRUE(surface->contains({5, 4, 1.5}));
    EXPECT_FALSE(surface->contains({5, 4, 2.1}));
    EXPECT_EQ(surface->info().columns, 20u);
}

TEST_F(LayersRow, sand_that_settles_is_what_the_columns_settle_to)
{
    std::vector<float> rock(15 * 15, 1.0f), sand(15 * 15, 0.0f);
    sand[7 * 15 + 7] = 6.0f;
    const auto surface = make(fmt::format("bedrock = \"{}\"\nsand = \"{}\"\ncell = 0.5\nsettle = true\nunit = 0.01\nrepose_sand = \"30 deg\"\n",
                                          map("rock.exr", 15, rock), map("sand.exr", 15, sand)));
    double sum = 0.0, highest = 0.0;
    for (int j = 0; j < 15; ++j)
        for (int i = 0; i < 15; ++i) {
            const double h = surface->height()->height({0.25 + 0.5 * i, 0.25 + 0.5 * j}) - 1.0;
            sum += h;
            highest = std::max(highest, h);
            // No step steeper than repose over a cell, rounded to a unit (0.29 m at 30 degrees over 0.5 m).
            if (i == 0) continue;
            EXPECT_LE(std::abs(h + 1.0 - surface->height()->height({0.25 + 0.5 * (i - 1), 0.25 + 0.5 * j})), 0.29 + 1e-6);
        }
    EXPECT_NEAR(sum, 6.0, 1e-4);  // all of it is still there; heights are floats
    EXPECT_LT(highest, 1.5);
    EXPECT_GT(highest, 0.5);
}

TEST_F(LayersRow, layers_are_baked_to_columns_and_read_from_them)
{
    const std::string rock = map("rock.exr", 3, {1, 2, 3, 4, 5, 6}), sand = map("sand.exr", 3, {0, 0.5f, 0, 1, 0, 0});
    const std::string text = fmt::format("bedrock = \"{}\"\nsand = \"{}\"\ncell = 2.0\norigin = [4, 6]\nunit = 0.25\n", rock, sand);
    const auto stack = find_in_catalogue("layers")->stack(values_of(text), BuildContext{});
    const std::string file = (folder_ / "baked.exr").string();
    write_stack_file(file, *stack);
    const auto a = make(text), b = make(fmt::format("stack = \"{}\"\n", file));
    for (const Vec2d& p : {Vec2d(5, 7), Vec2d(7, 9), Vec2d(8.3, 7.9), Vec2d(9, 9)}) EXPECT_EQ(a->height()->height(p), b->height()->height(p));
    EXPECT_EQ(stack->column(1, 1), (std::vector<Layer>{{Material::bedrock, 4}, {Material::sand, 6}}));
    EXPECT_EQ(message([&] { make(fmt::format("stack = \"{}\"\ncell = 1.0\n", file)); }),
              "<text>:2:8: `cell` beside `stack`, expected one of them: the file says all layers");
}

TEST_F(LayersRow, maps_that_cannot_be_are_refused_in_words)
{
    const std::string rock = map("rock.exr", 3, {1, 2, 3, 4, 5, 6}), other = map("other.exr", 2, {1, 2, 3, 4}),
                      negative = map("negative.exr", 3, {0, 0, 0, 0, -2, 0});
    EXPECT_EQ(message([&] { make("cell = 1.0\n"); }), "<text>:1:1: layers without bedrock, expected bedrock = \"FILE\", or stack = \"FILE.exr\"");
    EXPECT_EQ(message([&] { make(fmt::format("bedrock = \"{}\"\n", rock)); }),
              "<text>:1:11: how large its pixels are nobody says, expected cell (metres), or an image that says it");
    EXPECT_EQ(message([&] { make(fmt::format("bedrock = \"{}\"\nsand = \"{}\"\ncell = 1.0\n", rock, other)); }),
              "<text>:2:8: the size of a layer's map, expected 3 x 2 like the bedrock, got 2 x 2");
    EXPECT_EQ(message([&] { make(fmt::format("bedrock = \"{}\"\nsand = \"{}\"\ncell = 1.0\n", rock, negative)); }),
              "<text>:2:8: a number of a layer's map, expected a thickness, 0 or more, got -2 m at column 1, row 1");
}

}  // namespace
}  // namespace hoodoo
