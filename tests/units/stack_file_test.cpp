// Layers in deep EXRs: what comes back, what the header says, and files that are wrong in one column.
#include "terrain/io/stack_file.h"

#include "tests/counts.h"
#include "tests/stacks.h"
#include "tests/tables.h"
#include "terrain/surfaces/stack_source.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace hoodoo
{
namespace
{

class StackFile : public ::testing::Test
{
protected:
    StackFile()
        : folder_(std::filesystem::temp_directory_path() /
                  ("hoodoo_stack_file_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name())))
    {
        std::filesystem::create_directories(folder_);
    }
    ~StackFile() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

private:
    std::filesystem::path folder_;
};

std::string bytes_of(const std::string& path)
{
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

struct Sample {
    float z, back;
    unsigned material;
};

/// A deep file of 2 x 3 columns of 1 m in steps of 0.5 m, written without the code under test. `samples` are those of the pixel (1, row).
struct HandMade {
    std::vector<Sample> samples = {};
    int row = 0;
    double cell = 1.0;
    int version = 1;
    std::string last_material = "bedrock", lacks = {};
    Imf::PixelType material_type = Imf::UINT;

    void write(const std::string& path) const
    {
        Imf::Header header(2, 3);
        header.setType(Imf::DEEPSCANLINE);
        header.compression() = Imf::ZIPS_COMPRESSION;
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
        header.channels().insert("ZBack", Imf::Channel(Imf::FLOAT));
        header.channels().insert("material", Imf::Channel(material_type));
        if (lacks != "hoodoo:stack") header.insert("hoodoo:stack", Imf::IntAttribute(version));
        if (lacks != "hoodoo:cell") header.insert("hoodoo:cell", Imf::DoubleAttribute(cell));
        header.insert("hoodoo:unit", Imf::DoubleAttribute(0.5));
        header.insert("hoodoo:origin", Imf::V3dAttribute(Imath::V3d(10, 20, 30)));
        header.insert("hoodoo:materials", Imf::StringVectorAttribute(Imf::StringVector{"sand", last_material}));
        Imf::DeepScanLineOutputFile file(path.c_str(), header);
        for (int y = 0; y < 3; ++y) {
            std::array<unsigned, 2> counts{0, y == row ? static_cast<unsigned>(samples.size()) : 0};
            std::vector<float> z, back;
            std::vector<unsigned> material;
            for (const Sample& sample : samples) {
                z.push_back(sample.z);
                back.push_back(sample.back);
                material.push_back(sample.material);
            }
            std::array<char*, 2> zs{nullptr, reinterpret_cast<char*>(z.data())}, backs{nullptr, reinterpret_cast<char*>(back.data())},
                materials{nullptr, reinterpret_cast<char*>(material.data())};
            Imf::DeepFrameBuffer buffer;
            buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 0));
            buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(zs.data()), sizeof(char*), 0, 4));
            buffer.insert("ZBack", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(backs.data()), sizeof(char*), 0, 4));
            buffer.insert("material", Imf::DeepSlice(material_type, reinterpret_cast<char*>(materials.data()), sizeof(char*), 0, 4));
            file.setFrameBuffer(buffer);
            file.writePixels(1);
        }
    }
};

std::string refusal(const std::string& path)
{
    try {
        read_stack_file(path, {"scene.toml", 3, 9, {}});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::file);
        std::string text = error.what();
        for (std::size_t at; (at = text.find(path)) != std::string::npos;) text.replace(at, path.size(), "F");
        return text;
    }
    return "nothing was refused";
}

TEST_F(StackFile, holds_layers_from_the_bottom_up_with_the_north_on_top)
{
    HandMade{{{0.0f, 2.0f, 1}, {3.0f, 3.5f, 0}, {3.5f, 4.0f, 1}}, 0}.write(path("a.exr"));
    const auto stack = read_stack_file(path("a.exr"), {});
    EXPECT_EQ(stack->size(), Vec2i(2, 3));
    EXPECT_EQ(stack->cell(), 1.0);
    EXPECT_EQ(stack->unit(), 0.5);
    EXPECT_EQ(stack->origin(), Vec3d(10, 20, 30));
    // Row 0 is j = 2. In steps of 0.5 m: bedrock to 4, air to 6, sand to 7, bedrock to 8.
    using enum Material;
    EXPECT_EQ(stack->column(1, 2), (std::vector<Layer>{{bedrock, 4}, {air, 6}, {sand, 7}, {bedrock, 8}}));
    EXPECT_EQ(stack->layer_count(), 4u);
}

TEST_F(StackFile, of_another_program_may_have_heights_between_the_steps_and_touching_samples_of_one_material)
{
    HandMade{{{0.1f, 2.1f, 1}, {2.1f, 3.9f, 1}}, 1}.write(path("a.exr"));
    EXPECT_EQ(read_stack_file(path("a.exr"), {})->column(1, 1), (std::vector<Layer>{{Material::bedrock, 8}}));
}

TEST_F(StackFile, says_in_its_header_what_other_programs_need)
{
    const auto stack = testing::random_stack(7, {5, 4}, 0.3, 0.01, 900, Vec3d(4e6, -1.5, 0.1));
    write_stack_file(path("a.exr"), *stack);
    const Imf::DeepScanLineInputFile file(path("a.exr").c_str());
    const Imf::Header& header = file.header();
    EXPECT_EQ(header.typedAttribute<Imf::DoubleAttribute>("hoodoo:cell").value(), 0.3);
    EXPECT_EQ(header.typedAttribute<Imf::DoubleAttribute>("hoodoo:unit").value(), 0.01);
    EXPECT_EQ(header.typedAttribute<Imf::V3dAttribute>("hoodoo:origin").value(), Vec3d(4e6, -1.5, 0.1));
    EXPECT_EQ(header.typedAttribute<Imf::StringVectorAttribute>("hoodoo:materials").value(),
              (Imf::StringVector{"air", "water", "sand", "bedrock", "rock", "soil"}));
    for (const char* name : {"A", "Z", "ZBack", "material"}) EXPECT_NE(header.channels().findChannel(name), nullptr) << name;
    EXPECT_EQ(header.dataWindow().max, Imath::V2i(4, 3));
}

TEST_F(StackFile, that_is_wrong_in_one_column_is_refused_with_that_column)
{
    struct Case {
        HandMade file;
        const char* says;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Case cases[] = {
        {{{{0, 2, 1}, {1.5, 3, 0}}, 0}, "column (1, 2): its samples overlap, expected a sample from 2 m on, got 1.5 to 3"},
        {{{{2, 3, 1}, {0, 1, 0}}, 1},
         "column (1, 1): its samples are unordered, expected samples from the bottom up, got 0 to 1 after a sample that ends at 3"},
        {{{{2, 1, 1}}, 2}, "column (1, 0): a sample, expected Z below ZBack, both from 0 to 4095.5 m, got 2 to 1"},
        {{{{2, 2, 1}}, 2}, "column (1, 0): a sample, expected Z below ZBack, both from 0 to 4095.5 m, got 2 to 2"},
        {{{{-1, 2, 1}}, 2}, "column (1, 0): a sample, expected Z below ZBack, both from 0 to 4095.5 m, got -1 to 2"},
        {{{{0, 4096, 1}}, 2}, "column (1, 0): a sample, expected Z below ZBack, both from 0 to 4095.5 m, got 0 to 4096"},
        {{{{0, nan, 1}}, 2}, "column (1, 0): a sample, expected Z below ZBack, both from 0 to 4095.5 m, got 0 to nan"},
        {{{{0, 1, 2}}, 2}, "column (1, 0): its material, expected less than 2, got 2"},
        {{std::vector<Sample>(8192, {0, 1, 1}), 2}, "column (1, 0): number of samples, expected at most 8191, got 8192"},
    };
    for (const Case& c : cases) {
        c.file.write(path("a.exr"));
        EXPECT_EQ(refusal(path("a.exr")), std::string("scene.toml:3:9: the stack \"F\" cannot be read: ") + c.says);
    }
}

TEST_F(StackFile, whose_header_says_too_little_is_refused)
{
    const auto says = [&](HandMade file, const std::string& text) {
        file.write(path("a.exr"));
        EXPECT_EQ(refusal(path("a.exr")), "scene.toml:3:9: the stack \"F\" cannot be read: " + text);
    };
    for (const char* name : {"hoodoo:stack", "hoodoo:cell"}) {
        says({.lacks = name},
             "its header lacks " + std::string(name) +
                 ", expected a file that hoodoo bake wrote: hoodoo:stack, hoodoo:cell, hoodoo:unit, hoodoo:origin, hoodoo:materials");
    }
    says({.cell = -1.0}, "hoodoo:cell, expected a positive length in metres, got -1");
    says({.version = 2}, "hoodoo:stack, expected 1, got 2");
    says({.last_material = "cheese"}, "hoodoo:materials, expected air, water, sand, bedrock, rock or soil, got \"cheese\"");
    says({.material_type = Imf::FLOAT}, "its channels, expected Z and ZBack of floats, material of unsigned integers, got another type of material");
}

TEST_F(StackFile, that_is_cut_off_or_damaged_or_something_else_is_refused)
{
    write_stack_file(path("a.exr"), *testing::random_stack(3, {70, 40}, 1.0, 0.1, 800));
    const std::string whole = bytes_of(path("a.exr"));
    EXPECT_EQ(refusal(path("absent.exr")), "scene.toml:3:9: the stack \"F\" cannot be read: No such file or directory");
    EXPECT_EQ(refusal(std::filesystem::temp_directory_path().string()), "scene.toml:3:9: the stack \"F\" cannot be read: Is a directory");
    std::ofstream(path("text.exr")) << "a text";
    EXPECT_EQ(refusal(path("text.exr")), "scene.toml:3:9: the stack \"F\" cannot be read: it is no deep EXR");

    // Cut in the middle of the rows: row 20 of 40 at the earliest is lost, so the message names a row whose j is below 20.
    std::ofstream(path("cut.exr"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    EXPECT_NE(refusal(path("cut.exr")).find("cannot be read: columns (0, "), std::string::npos) << refusal(path("cut.exr"));
    std::string damaged = whole;
    for (std::size_t k = whole.size() / 2; k < whole.size() / 2 + 200; ++k) damaged[k] = static_cast<char>(damaged[k] ^ 0x5a);
    std::ofstream(path("bad.exr"), std::ios::binary) << damaged;
    EXPECT_NE(refusal(path("bad.exr")).find("cannot be read: columns (0, "), std::string::npos) << refusal(path("bad.exr"));
}

TEST_F(StackFile, with_any_byte_changed_is_read_or_refused_and_nothing_else)
{
    write_stack_file(path("a.exr"), *testing::random_stack(3, {9, 7}, 1.0, 0.1, 800));
    const std::string whole = bytes_of(path("a.exr"));
    int refused = 0;
    for (int k = 0, n = testing::count(400, 20000); k < n; ++k) {
        std::string bytes = whole;
        const std::uint64_t h = hash_combine(11, static_cast<std::uint64_t>(k));
        bytes[h % bytes.size()] = static_cast<char>(h >> 48);
        if (k % 7 == 0) bytes.resize(h % bytes.size());
        std::ofstream(path("b.exr"), std::ios::binary) << bytes;
        try {
            read_stack_file(path("b.exr"), {});
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::file);
            ++refused;
        }
    }
    EXPECT_GT(refused, testing::count(100, 5000));
}

TEST_F(StackFile, takes_the_place_of_grid_and_layers_in_a_scene_and_edits_follow)
{
    const auto make = [](const Node& parameters) {
        const Schema schema{"stack", "", stack_parameters()};
        std::vector<Problem> problems;
        const Values values = check(schema, parameters, problems);
        if (!problems.empty()) throw Error(ErrorKind::scene, problems);
        return make_stack(values, {});
    };
    const Node edit = testing::table({{"tool", "sweep"}, {"points", testing::list({{4.0, 4.0, 5.0}})}, {"radius", {2.0}}});
    const Node layers = testing::tables({testing::table({{"shape", "flat"}, {"top", 5.0}})});
    const auto baked = make(testing::table({{"columns", {8.0, 8.0}}, {"cell", 1.0}, {"unit", 0.25}, {"layer", layers}}));
    write_stack_file(path("a.exr"), *baked);
    const auto whole =
        make(testing::table({{"columns", {8.0, 8.0}}, {"cell", 1.0}, {"unit", 0.25}, {"layer", layers}, {"edit", testing::tables({edit})}}));
    const auto edited = make(testing::table({{"stack", path("a.exr")}, {"edit", testing::tables({edit})}}));
    for (int k = 0; k < 64; ++k) EXPECT_EQ(edited->column(k % 8, k / 8), whole->column(k % 8, k / 8));
    EXPECT_NE(edited->column(4, 4), baked->column(4, 4));

    const auto message = [&](const Node& parameters) -> std::string {
        try {
            make(parameters);
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was refused";
    };
    EXPECT_NE(message(testing::table({{"stack", path("a.exr")}, {"cell", 1.0}}))
                  .find("`cell` beside `stack`, expected one of them: the file says the grid and the layers"),
              std::string::npos);
    EXPECT_NE(message(testing::table({{"stack", path("a.exr")}, {"layer", layers}})).find("`layer` beside `stack`"), std::string::npos);
    EXPECT_NE(message(testing::table({{"columns", {8.0, 8.0}}, {"cell", 1.0}}))
                  .find("a terrain without layers, expected [[layer]] tables, or stack = \"FILE.exr\""),
              std::string::npos);
}

}  // namespace
}  // namespace hoodoo
