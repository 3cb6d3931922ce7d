// Image textures: filtering, periodicity, colour encoding, hidden repetition, normal maps on each plane, and files that are traps.
#include "renderer/shading/look.h"
#include "renderer/shading/texture.h"

#include "terrain/math/hash.h"
#include "tests/counts.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

using namespace hoodoo;

using hoodoo::testing::count;

namespace
{

/// An uncompressed TIFF of 8 bits, written by hand so that the tests do not lean on the library they test: little-endian, one strip, three channels.
std::string tiff(int width, int height, const std::function<std::array<int, 3>(int x, int y)>& pixel)
{
    std::string bytes = "II*";
    const auto put16 = [&](unsigned v) { bytes += {static_cast<char>(v & 255), static_cast<char>(v >> 8 & 255)}; };
    const auto put32 = [&](unsigned v) { put16(v & 65535), put16(v >> 16); };
    bytes += '\0';
    const auto pixels = static_cast<unsigned>(3 * width * height);
    put32(8 + pixels + 6);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int c : pixel(x, y)) bytes += static_cast<char>(c);
    for (int c = 0; c < 3; ++c) put16(8);  // bits a sample
    const auto w = static_cast<unsigned>(width), h = static_cast<unsigned>(height);
    const std::vector<std::array<unsigned, 4>> tags = {{256, 4, 1, w}, {257, 4, 1, h}, {258, 3, 3, 8 + pixels}, {259, 3, 1, 1},     {262, 3, 1, 2},
                                                       {273, 4, 1, 8}, {277, 3, 1, 3}, {278, 4, 1, h},          {279, 4, 1, pixels}};
    put16(static_cast<unsigned>(tags.size()));
    for (const auto& [tag, type, count, value] : tags) put16(tag), put16(type), put32(count), put32(value);
    put32(0);
    return bytes;
}

class TextureFile : public ::testing::Test
{
protected:
    void SetUp() override
    {
        folder_ = std::filesystem::temp_directory_path() /
                  ("hoodoo_texture_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& bytes) const
    {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return (folder_ / name).string();
    }

    std::string error_of(const std::string& path) const
    {
        try {
            const Texture texture(path, {}, {"scene.toml", 3, 5, {}});
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::file);
            return error.what();
        }
        return "no error";
    }

    std::unique_ptr<Look> look_with(std::vector<std::pair<std::string, std::string>> entries, double scale = 1.0) const
    {
        Node::Table table;
        const auto add = [&](const std::string& key, decltype(Node::value) value) {
            Node node;
            node.value = std::move(value);
            table.emplace_back(key, node);
        };
        for (const auto& [key, value] : entries) add(key, value);
        add("scale", scale);
        add("variation", 0.0);
        add("stochastic", false);
        Node node;
        node.value = std::move(table);
        std::vector<Problem> problems;
        const Values values = check(material_schema(), node, problems);
        for (const Problem& p : problems) ADD_FAILURE() << p.text();
        return make_look("tested", values, [](const ColorValue& c) { return Vec3f(c.rgb); }, {});
    }

    std::filesystem::path folder_;
};

Interaction place(const Vec3d& p, const Vec3d& n)
{
    Interaction at;
    at.position = at.texture_point = p;
    at.geometric_normal = at.shading_normal = n;
    return at;
}

/// Four quarters, from the upper left: red, green, blue, white.
std::string quarters()
{
    return tiff(64, 64, [](int x, int y) -> std::array<int, 3> {
        if (y < 32) return x < 32 ? std::array<int, 3>{255, 0, 0} : std::array<int, 3>{0, 255, 0};
        return x < 32 ? std::array<int, 3>{0, 0, 255} : std::array<int, 3>{255, 255, 255};
    });
}

}  // namespace

TEST_F(TextureFile, the_image_stands_upright_and_repeats)
{
    const Texture texture(write("a.tif", quarters()), {.stochastic = false}, {});
    for (const Vec2d& repeat : {Vec2d(0, 0), Vec2d(3, -7), Vec2d(1e6, 1e6)}) {
        EXPECT_LT((texture.lookup(Vec2d(0.25, 0.75) + repeat, 0.0) - Vec3f(1, 0, 0)).length(), 1e-3f)
            << repeat;  // v upwards: the first row is the top
        EXPECT_LT((texture.lookup(Vec2d(0.75, 0.75) + repeat, 0.0) - Vec3f(0, 1, 0)).length(), 1e-3f);
        EXPECT_LT((texture.lookup(Vec2d(0.25, 0.25) + repeat, 0.0) - Vec3f(0, 0, 1)).length(), 1e-3f);
        EXPECT_LT((texture.lookup(Vec2d(0.75, 0.25) + repeat, 0.0) - Vec3f(1, 1, 1)).length(), 1e-3f);
    }
}

TEST_F(TextureFile, wide_footprints_average_linear_numbers)
{
    // Fine stripes of black and white average to one half; if the file is in sRGB, black and 188 average to half of the linear value of 188, which is
    // ((188/255 + 0.055) / 1.055)^2.4 = 0.5029, so 0.2514: averaging the codes first would give ((94/255 + .055) / 1.055)^2.4 = 0.1119.
    const auto stripes = [](int white) {
        return tiff(64, 64, [white](int x, int) { return std::array<int, 3>{x % 2 * white, x % 2 * white, x % 2 * white}; });
    };
    const Texture linear(write("a.tif", stripes(255)), {.stochastic = false}, {});
    const Texture srgb(write("b.tif", stripes(188)), {.encoding = TextureEncoding::srgb, .stochastic = false}, {});
    for (const double footprint : {0.1, 0.3, 1.0, 50.0})
        for (int i = 0; i < 20; ++i) {
            const Vec2d at(unit_real(hash_cell(1, i, 0)), unit_real(hash_cell(1, i, 1)));
            EXPECT_NEAR(linear.lookup(at, footprint).x, 0.5f, 0.01f) << footprint;
            EXPECT_NEAR(srgb.lookup(at, footprint).x, 0.2514f, 0.005f) << footprint;
        }
    EXPECT_NEAR(srgb.mean().y, 0.2514f, 0.001f);
}

TEST_F(TextureFile, levels_that_a_tool_averaged_in_srgb_are_made_anew)
{
    // maketx averages the codes: its coarser levels of these stripes hold 94, which is 0.1119 and not 0.2514.
    const std::string path = write("a.tif", tiff(64, 64, [](int x, int) { return std::array<int, 3>{x % 2 * 188, x % 2 * 188, x % 2 * 188}; }));
    const std::string tiled = (folder_ / "a.tx").string();
    if (std::system(("maketx --wrap periodic " + path + " -o " + tiled + " > /dev/null 2>&1").c_str()) != 0)
        GTEST_SKIP() << "needs maketx of openimageio-tools";
    const Texture texture(tiled, {.encoding = TextureEncoding::srgb, .stochastic = false}, {});
    for (const double footprint : {0.1, 0.3, 0.9}) EXPECT_NEAR(texture.lookup(Vec2d(0.31, 0.64), footprint).x, 0.2514f, 0.005f) << footprint;
}

TEST_F(TextureFile, hex_tiling_keeps_mean_and_variance_and_forgets_the_period)
{
    // White noise of period one repeat. With the plain image the correlation at a lag of one repeat is 1; with hashed tiles it is that of chance.
    const std::string path = write("a.tif", tiff(64, 64, [](int x, int y) {
                                       const int v = static_cast<int>(255 * unit_real(hash_cell(3, x / 4, y / 4)));
                                       return std::array<int, 3>{v, v, v};
                                   }));
    for (const bool stochastic : {false, true}) {
        const Texture texture(path, {.stochastic = stochastic, .seed = 7}, {});
        double mean = 0.0, square = 0.0, product = 0.0;
        constexpr int n = 20000;
        for (int i = 0; i < n; ++i) {
            const Vec2d at(40.0 * unit_real(hash_cell(2, i, 0)), 40.0 * unit_real(hash_cell(2, i, 1)));
            const double here = texture.lookup(at, 0.0).x, there = texture.lookup(at + Vec2d(1.0, 0.0), 0.0).x;
            mean += here / n;
            square += here * here / n;
            product += here * there / n;
        }
        const double m = texture.mean().x, variance = square - mean * mean, correlation = (product - mean * mean) / variance;
        EXPECT_NEAR(mean, m, 0.02);
        // Uniform in [0, 1], interpolated between pixels of four equal ones: a little under 1/12.
        EXPECT_NEAR(variance, 1.0 / 12.0, 0.02);
        if (stochastic)
            EXPECT_LT(std::abs(correlation), 0.05);
        else
            EXPECT_GT(correlation, 0.99);
    }
}

TEST_F(TextureFile, triplanar_projects_the_planes_that_face_the_surface)
{
    const auto look = look_with({{"albedo_texture", write("a.tif", quarters())}, {"colorspace", "acescg"}}, 10.0);
    // Upper right quarter of each plane is green: (y, z), (x, z), (x, y) at three quarters of a repeat of 10 m.
    EXPECT_LT((look->appearance(place({2.0, 7.5, 7.5}, {1, 0, 0}), 0.0).albedo - Vec3f(0, 1, 0)).length(), 1e-3f);
    EXPECT_LT((look->appearance(place({7.5, 2.0, 7.5}, {0, -1, 0}), 0.0).albedo - Vec3f(0, 1, 0)).length(), 1e-3f);
    EXPECT_LT((look->appearance(place({7.5, 7.5, 2.0}, {0, 0, 1}), 0.0).albedo - Vec3f(0, 1, 0)).length(), 1e-3f);
    // Upper left, negative side: not mirrored.
    EXPECT_LT((look->appearance(place({-7.5, -2.5, 2.0}, {0, 0, 1}), 0.0).albedo - Vec3f(1, 0, 0)).length(), 1e-3f);
    // At 45 degrees half of red, (y, z), and half of blue, (x, y).
    EXPECT_LT((look->appearance(place({2.5, 2.5, 7.5}, Vec3d(1, 0, 1).normalized()), 0.0).albedo - Vec3f(0.5f, 0, 0.5f)).length(), 1e-3f);
}

TEST_F(TextureFile, normal_maps_tilt_the_right_way_on_every_side)
{
    // The map leans right (n_x > 0) and, in another file, up (n_y > 0): 0.6, 0, 0.8. On a face the normal must lean along the texture's first
    // (second) axis, whatever the sign of the face.
    const auto map = [](int r, int g) { return tiff(16, 16, [=](int, int) { return std::array<int, 3>{r, g, 230}; }); };  // 204: 0.6, 230: 0.804
    const auto right = look_with({{"normal_texture", write("r.tif", map(204, 128))}, {"procedural", "plain"}});
    const auto up = look_with({{"normal_texture", write("u.tif", map(128, 204))}, {"procedural", "plain"}});
    for (const double side : {1.0, -1.0}) {
        const Vec3d x(side, 0, 0), y(0, side, 0), z(0, 0, side);
        EXPECT_LT((right->appearance(place(Vec3d(0.3), x), 0.0).normal - (x * 0.8 + Vec3d(0, 0.6, 0))).length(), 0.02);
        EXPECT_LT((right->appearance(place(Vec3d(0.3), y), 0.0).normal - (y * 0.8 + Vec3d(0.6, 0, 0))).length(), 0.02);
        EXPECT_LT((right->appearance(place(Vec3d(0.3), z), 0.0).normal - (z * 0.8 + Vec3d(0.6, 0, 0))).length(), 0.02);
        EXPECT_LT((up->appearance(place(Vec3d(0.3), x), 0.0).normal - (x * 0.8 + Vec3d(0, 0, 0.6))).length(), 0.02);
        EXPECT_LT((up->appearance(place(Vec3d(0.3), y), 0.0).normal - (y * 0.8 + Vec3d(0, 0, 0.6))).length(), 0.02);
        EXPECT_LT((up->appearance(place(Vec3d(0.3), z), 0.0).normal - (z * 0.8 + Vec3d(0, 0.6, 0))).length(), 0.02);
    }
}

TEST_F(TextureFile, roughness_is_the_raw_number_of_its_image)
{
    const auto look = look_with({{"roughness_texture", write("a.tif", tiff(8, 8, [](int, int) { return std::array<int, 3>{51, 51, 51}; }))}});
    EXPECT_NEAR(look->appearance(place(Vec3d(0.0), Vec3d(0, 0, 1)), 0.0).roughness, 0.2f, 1e-3f);
}

TEST_F(TextureFile, a_normal_map_by_uv_is_refused)
{
    const std::string path = write("a.tif", quarters());
    EXPECT_THROW(look_with({{"normal_texture", path}, {"projection", "uv"}}), Error);
}

TEST_F(TextureFile, bad_files_are_errors_with_the_position_in_the_scene)
{
    EXPECT_NE(error_of((folder_ / "absent.png").string()).find("scene.toml:3:5: image \""), std::string::npos);
    EXPECT_NE(error_of(write("a.gif", "GIF89a")).find("unknown format"), std::string::npos);
    EXPECT_NE(error_of(write("a.png", "no png at all")), "no error");
    EXPECT_NE(error_of(write("empty.exr", "")), "no error");
    EXPECT_NE(error_of(folder_.string() + "/../"), "no error");
    const std::string good = quarters();
    for (int i = 1; i < 20; ++i)
        error_of(write("cut.tif", good.substr(0, good.size() * static_cast<std::size_t>(i) / 20)));  // any answer but a signal
    EXPECT_NE(error_of(write("half.tif", good.substr(0, good.size() / 2))), "no error");
}

TEST_F(TextureFile, a_flipped_byte_is_an_error_or_another_picture_and_never_a_crash)
{
    const std::string good = quarters();
    int errors = 0;
    const int rounds = count(200, 1000);
    for (int i = 0; i < rounds; ++i) {
        // Half of the flips hit the directory at the end, where the sizes are.
        const std::uint64_t h = hash_cell(8, i, 0);
        const std::size_t directory = good.size() - 120;
        const std::size_t at = i % 2 ? directory + h % 120 : h % good.size();
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ (1 + (h >> 32) % 255));
        errors += error_of(write("flipped.tif", bytes)) != "no error";
    }
    EXPECT_GT(errors, 10);
    EXPECT_LT(errors, rounds);
}

TEST_F(TextureFile, bombs_are_refused_before_anything_is_allocated)
{
    // A header that claims 16384 x 16384 x 3 bytes in a file of 200, and one that claims more than any image may have.
    std::string bomb = tiff(4, 4, [](int, int) { return std::array<int, 3>{1, 2, 3}; });
    const auto claim = [&](unsigned size) {
        std::string bytes = bomb;
        const std::size_t directory = 8 + 48 + 6 + 2;
        for (const std::size_t at : {directory + 8, directory + 12 + 8})
            for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(size >> (8 * k) & 255);
        return bytes;
    };
    EXPECT_NE(error_of(write("a.tif", claim(16384))).find("claims more pixels than its bytes can hold"), std::string::npos)
        << error_of(write("a.tif", claim(16384)));
    const std::string huge = error_of(write("b.tif", claim(1000000)));
    EXPECT_NE(huge, "no error");
}
