// Voxels from files: what is read, and what files that lie, end early or hold something else are told.
#include "terrain/io/grid_file.h"
#include "terrain/io/voxel_file.h"
#include "tests/edits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace hoodoo
{
namespace
{

using testing::error_of;

const Source kHere{"scene", 0, 0, {}};

class VoxelFile : public ::testing::Test
{
protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string write(const std::string& name, const std::string& bytes) const
    {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }
    /// The error's text without its path, which is the first thing it says; "" if the file is read.
    std::string refusal(const std::string& name, const VoxelFileOptions& options = {}) const
    {
        try {
            read_voxel_file(path(name), options, kHere);
        } catch (const Error& error) {
            const std::string what = error.what(), place = path(name) + ": ";
            return what.starts_with(place) ? what.substr(place.size()) : what;
        }
        return {};
    }

private:
    std::filesystem::path folder_ = std::filesystem::temp_directory_path() / fmt::format("hoodoo_voxel_file_{}", ::getpid());
};

std::string little(std::uint64_t x, int bytes)
{
    std::string out;
    for (int k = 0; k < bytes; ++k) out += static_cast<char>(x >> (8 * k));
    return out;
}

template <class T>
std::string raw(const std::vector<T>& numbers)
{
    std::string out(numbers.size() * sizeof(T), '\0');
    std::memcpy(out.data(), numbers.data(), out.size());
    return out;
}

std::string npy(const std::string& type, const std::string& shape, const std::string& data, const std::string& order = "False")
{
    std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
    header.resize(117, ' ');
    header += '\n';
    return std::string("\x93NUMPY\x01\x00", 8) + little(header.size(), 2) + header + data;
}

struct Packed {
    std::string name, bytes;
    std::uint64_t size;  ///< that it claims to have
    int method = 0;
};

/// A zip archive as its format says it, byte by byte; check sums are 0.
std::string zip(const std::vector<Packed>& entries)
{
    std::string out, directory;
    for (const Packed& e : entries) {
        const std::string common = little(20, 2) + little(0, 2) + little(static_cast<std::uint64_t>(e.method), 2) + little(0, 8) +
                                   little(e.bytes.size(), 4) + little(e.size, 4) + little(e.name.size(), 2) + little(0, 2);
        directory += "PK\x01\x02" + little(20, 2) + common + little(0, 10) + little(out.size(), 4) + e.name;
        out += "PK\x03\x04" + common + e.name + e.bytes;
    }
    return out + directory + "PK\x05\x06" + little(0, 4) + little(entries.size(), 2) + little(entries.size(), 2) + little(directory.size(), 4) +
           little(out.size(), 4) + little(0, 2);
}

Packed stored(const std::string& name, const std::string& bytes)
{
    return {name, bytes, bytes.size()};
}

/// 2 x 2 x 3 densities: matter in the lower two of each column.
const std::vector<float> kColumns{1, 0.75f, 0, 1, 0.75f, 0, 1, 0.75f, 0, 1, 0.75f, 0.25f};

TEST_F(VoxelFile, numbers_of_every_type_are_read_the_same)
{
    const std::vector<std::int16_t> halves{4, 3, 0, 4, 3, 0, 4, 3, 0, 4, 3, 1};
    write("f4.npy", npy("<f4", "(2, 2, 3)", raw(kColumns)));
    write("f8.npy", npy("<f8", "(2, 2, 3)", raw(std::vector<double>(kColumns.begin(), kColumns.end()))));
    write("i2.npy", npy("<i2", "(2, 2, 3)", raw(halves)));
    std::string swapped = raw(halves);
    for (std::size_t k = 0; k < swapped.size(); k += 2) std::swap(swapped[k], swapped[k + 1]);
    write("big.npy", npy(">i2", "(2, 2, 3)", swapped));
    for (const char* name : {"f4.npy", "f8.npy", "i2.npy", "big.npy"}) {
        VoxelFileOptions options;
        const bool quarters = std::string(name).find('2') != std::string::npos || std::string(name) == "big.npy";
        options.iso = quarters ? 2.0 : 0.5;
        options.cell = 0.5;
        options.origin = Vec3d(10, 20, 30);
        const VoxelGrid grid = read_voxel_file(path(name), options, kHere);
        EXPECT_EQ(grid.values.size(), (Index3{4, 4, 5})) << "with a layer of air";
        EXPECT_EQ(grid.world(Vec3d(1.0)), Vec3d(10, 20, 30));
        // F = iso - density, in the file's unit; k is the third index.
        const float unit = quarters ? 4.0f : 1.0f;
        EXPECT_EQ(grid.at({1, 1, 1}), -0.5f * unit) << name;
        EXPECT_EQ(grid.at({1, 1, 2}), -0.25f * unit) << name;
        EXPECT_EQ(grid.at({1, 1, 3}), 0.5f * unit) << name;
        EXPECT_EQ(grid.at({2, 2, 3}), 0.25f * unit) << name;
        EXPECT_GT(grid.at({0, 1, 1}), 0.0f);
    }
}

TEST_F(VoxelFile, distances_are_metres_and_negative_in_matter)
{
    write("d.npy", npy("<f4", "(1, 1, 3)", raw(std::vector<float>{-1.5f, -0.5f, 0.5f})));
    VoxelFileOptions options;
    options.meaning = VoxelMeaning::distance;
    const VoxelGrid grid = read_voxel_file(path("d.npy"), options, kHere);
    EXPECT_EQ(grid.at({1, 1, 2}), -0.5f);
    EXPECT_EQ(grid.at({1, 1, 3}), 0.5f);
}

TEST_F(VoxelFile, arrays_that_are_no_voxels_are_refused)
{
    write("flat.npy", npy("<f4", "(3, 4)", raw(kColumns)));
    EXPECT_EQ(refusal("flat.npy"), "voxels are an array of three axes (x, y, z), expected three, got 2");
    write("none.npy", npy("<f4", "(3, 0, 4)", ""));
    EXPECT_EQ(refusal("none.npy"), "an axis of the voxels, expected 1 to 65536 samples, got 0");
    write("long.npy", npy("<i1", "(1, 1, 65537)", std::string(65537, '\0')));
    EXPECT_EQ(refusal("long.npy"), "an axis of the voxels, expected 1 to 65536 samples, got 65537");
    write("complex.npy", npy("<c8", "(2, 2, 3)", raw(kColumns) + raw(kColumns)));
    EXPECT_EQ(refusal("complex.npy"), "\"complex.npy\" has a type that is no plain number, got '<c8'");
    write("object.npy", npy("|O", "(2, 2, 3)", raw(kColumns)));
    EXPECT_EQ(refusal("object.npy"), "\"object.npy\" has a type that is no plain number, got '|O'");
    write("text.npy", "x,y,z\n1,2,3\n4,5,6\n");
    EXPECT_EQ(refusal("text.npy"), "\"text.npy\" is no NumPy array");
    write("empty.npy", "");
    EXPECT_EQ(refusal("empty.npy"), "\"empty.npy\" is no NumPy array");
    write("columns.npy", npy("<f4", "(2, 2, 3)", raw(kColumns), "True"));
    EXPECT_EQ(refusal("columns.npy"), "\"columns.npy\" is stored column by column (Fortran order); save it in C order");
    EXPECT_EQ(refusal("missing.npy"), "cannot read the voxels");
    write("voxels.txt", "1");
    EXPECT_EQ(refusal("voxels.txt"), "scene: a file of voxels, expected .npy, .npz or .vdb, got \".txt\"");
}

TEST_F(VoxelFile, numbers_that_are_not_finite_are_counted_and_placed)
{
    std::vector<float> bad = kColumns;
    bad[4] = std::numeric_limits<float>::quiet_NaN();
    bad[11] = std::numeric_limits<float>::infinity();
    write("nan.npy", npy("<f4", "(2, 2, 3)", raw(bad)));
    EXPECT_EQ(refusal("nan.npy"), "2 of the voxels are not finite, the first is (0, 1, 1), expected finite numbers");
}

TEST_F(VoxelFile, options_that_cannot_be_are_told_at_their_place)
{
    write("a.npy", npy("<f4", "(2, 2, 3)", raw(kColumns)));
    VoxelFileOptions options;
    options.iso = 0.0;
    EXPECT_EQ(refusal("a.npy", options),
              "scene: the level of a density: around the voxels there is air of density 0, expected an iso above 0, got 0");
    options = {};
    options.material_array = "m";
    EXPECT_EQ(refusal("a.npy", options), "scene: an array of materials stands in an .npz beside the voxels, expected a file .npz, got \".npy\"");
    options = {};
    options.cell = -1.0;
    EXPECT_EQ(refusal("a.npy", options), "the cell of a voxel grid, expected a finite number above 0 (metres), got -1");
}

TEST_F(VoxelFile, an_array_that_is_cut_anywhere_is_refused)
{
    const std::string whole = npy("<f4", "(2, 2, 3)", raw(kColumns));
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write("cut.npy", whole.substr(0, length));
        const std::string why = refusal("cut.npy");
        EXPECT_TRUE(why == "\"cut.npy\" is cut short" || (length < 12 && why == "\"cut.npy\" is no NumPy array")) << length << ": " << why;
    }
    write("cut.npy", whole);
    EXPECT_EQ(refusal("cut.npy"), "");
}

TEST_F(VoxelFile, a_bomb_is_refused_before_memory_is_asked_for)
{
    // 2^48 numbers that are not there, and 2^32 of them.
    write("huge.npy", npy("<f4", "(65536, 65536, 65536)", ""));
    EXPECT_EQ(refusal("huge.npy"), "\"huge.npy\" is too large, got (65536, 65536, 65536)");
    write("hollow.npy", npy("<f4", "(65536, 65536, 1)", "abcd"));
    EXPECT_EQ(refusal("hollow.npy"), "\"hollow.npy\" is cut short");
    // An archive whose entry promises a gigabyte from ten bytes: deflate cannot, it packs at most 1032 : 1.
    write("bomb.npz", zip({{"d.npy", "0123456789", 1u << 30, 8}}));
    EXPECT_EQ(refusal("bomb.npz"), "damaged archive: an entry promises more than it can hold, got 1073741824 bytes from 10");
    write("lie.npz", zip({{"d.npy", "0123456789", 11, 0}}));
    EXPECT_EQ(refusal("lie.npz"), "damaged archive: a stored entry has two sizes");
    write("odd.npz", zip({{"d.npy", "0123456789", 10, 12}}));
    EXPECT_EQ(refusal("odd.npz"), "an entry of the archive is packed in an unknown way, got method 12");
}

TEST_F(VoxelFile, an_archive_says_which_array_and_what_it_is_made_of)
{
    const std::string density = npy("<f4", "(2, 2, 3)", raw(kColumns));
    const std::vector<std::uint8_t> which{0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1};
    write("two.npz", zip({stored("d.npy", density), stored("m.npy", npy("|u1", "(2, 2, 3)", raw(which)))}));
    EXPECT_EQ(refusal("two.npz"), "scene: the archive has several arrays: say which one by `array`, expected one of: d, m");
    VoxelFileOptions options;
    options.array = "e";
    EXPECT_EQ(refusal("two.npz", options).substr(0, 47), "the archive has no array of this name, expected");
    options = {};
    options.material_array = "m";
    options.materials = {"bedrock", "sand"};
    const VoxelGrid grid = read_voxel_file(path("two.npz"), options, kHere);
    ASSERT_TRUE(grid.materials);
    EXPECT_EQ(grid.materials->at({1, 1, 1}), 0);
    EXPECT_EQ(grid.materials->at({1, 1, 2}), 1);
    EXPECT_EQ(grid.materials->at({2, 2, 3}), 1);
    options.materials = {"bedrock"};
    EXPECT_EQ(refusal("two.npz", options), "the material of voxel (0, 0, 1), expected a whole number from 0 to 0, for one of: bedrock, got 1");
    write("other.npz", zip({stored("d.npy", density), stored("m.npy", npy("|u1", "(3, 2, 2)", raw(which)))}));
    EXPECT_EQ(refusal("other.npz", options), "the array of materials has another shape than the voxels, expected 2 x 2 x 3, got 3 x 2 x 2");
}

TEST_F(VoxelFile, an_archive_that_is_damaged_is_refused_or_read_but_never_harms)
{
    const std::string whole = zip({stored("d.npy", npy("<f4", "(2, 2, 3)", raw(kColumns)))});
    write("whole.npz", whole);
    EXPECT_EQ(refusal("whole.npz"), "");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write("cut.npz", whole.substr(0, length));
        EXPECT_NE(refusal("cut.npz"), "") << length;
    }
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 0x55);
        write("flip.npz", flipped);
        refused += !refusal("flip.npz").empty();
    }
    // Head of the array, sizes, places, names: more than its numbers, which are all the same to read.
    EXPECT_GT(refused, 40);
}

/// A grid of 6^3 distances to a level plane half way up, as `hoodoo sample` writes it; its bytes, none in a build without OpenVDB.
std::string vdb_file(const std::string& path, double turn = 0.0)
{
    SampledGrid grid;
    grid.count = {6, 6, 6};
    grid.origin = Vec3d(3, 4, 5);
    grid.step = Vec3d(0.5, 0.5, 0.5 + turn);
    for (int n = 0; n < 216; ++n) grid.values.push_back(0.5 * (n % 6) - 1.25);
    try {
        write_grid_file(path, grid);
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()), "this build has no OpenVDB: .vdb cannot be written");
        return {};
    }
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(VoxelFile, a_vdb_keeps_its_cell_and_place)
{
    if (vdb_file(path("a.vdb")).empty()) GTEST_SKIP();
    VoxelFileOptions options;
    options.meaning = VoxelMeaning::distance;
    const VoxelGrid grid = read_voxel_file(path("a.vdb"), options, kHere);
    EXPECT_EQ(grid.cell, 0.5);
    // The plane lies half way between the third and the fourth sample; both keep their numbers.
    for (const int k : {2, 3}) {
        const Vec3d q = grid.local(Vec3d(4.5, 5.5, 5.0 + 0.5 * k));
        const Index3 sample{static_cast<int>(std::lround(q.x)), static_cast<int>(std::lround(q.y)), static_cast<int>(std::lround(q.z))};
        EXPECT_NEAR((Vec3d(sample[0], sample[1], sample[2]) - q).length(), 0.0, 1e-12);
        EXPECT_EQ(grid.at(sample), k == 2 ? -0.25f : 0.25f);
    }
}

TEST_F(VoxelFile, a_vdb_that_is_no_solid_of_cubes_is_refused)
{
    if (vdb_file(path("stretched.vdb"), 0.25).empty()) GTEST_SKIP();
    EXPECT_EQ(refusal("stretched.vdb"), "the grid's transform turns or stretches, expected cubes along the axes");
    VoxelFileOptions options;
    options.array = "filed";
    vdb_file(path("a.vdb"));
    EXPECT_EQ(refusal("a.vdb", options), "the file has no grid of this name, expected one of: field, got \"filed\" (did you mean \"field\")");
    // A type's name of the same length: the same bytes as whole numbers.
    std::string whole_numbers = vdb_file(path("a.vdb"));
    const std::string real = "Tree_float_", whole = "Tree_int32_";
    const std::size_t at = whole_numbers.find(real);
    ASSERT_NE(at, std::string::npos);
    write("whole.vdb", whole_numbers.replace(at, real.size(), whole));
    EXPECT_EQ(refusal("whole.vdb"), "the grid does not hold real numbers, expected a grid of float or double, got int32");
}

TEST_F(VoxelFile, a_vdb_that_is_cut_or_damaged_is_refused_or_read_but_never_harms)
{
    const std::string whole = vdb_file(path("whole.vdb"));
    if (whole.empty()) GTEST_SKIP();
    for (std::size_t length = 0; length < whole.size(); length += 97) {
        write("cut.vdb", whole.substr(0, length));
        EXPECT_TRUE(refusal("cut.vdb").starts_with("cannot read the voxels, ")) << length << " of " << whole.size() << ": " << refusal("cut.vdb");
    }
    for (std::size_t at = 0; at < whole.size(); at += 997) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 0x55);
        write("flip.vdb", flipped);
        refusal("flip.vdb");
    }
    write("text.vdb", "this is no grid at all, but longer than any magic number at its beginning");
    EXPECT_EQ(refusal("text.vdb"), "cannot read the voxels, got IoError: not a VDB file");
    write("empty.vdb", "");
    EXPECT_EQ(refusal("empty.vdb"), "cannot read the voxels, expected a whole file, got one that ends early");
    EXPECT_EQ(refusal("missing.vdb"), "cannot read the voxels");
}

}  // namespace
}  // namespace hoodoo
