// The files' contents are functions of hashes and sines: the same on every machine.
#include "tests/support/terrain_files.h"

#include "terrain/math/hash.h"
#include "terrain/math/vec.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <unistd.h>
#include <vector>

namespace hoodoo::testing
{

const std::string& mesh_path()
{
    static const std::string path = [] {
        // An icosahedron, each face split in four, twice; then pushed in and out by a hash of the direction.
        const double g = 0.5 * (1.0 + std::sqrt(5.0));
        std::vector<Vec3d> v{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                             {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
        std::vector<std::array<int, 3>> f{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
        for (int level = 0; level < 2; ++level) {
            std::vector<std::array<int, 3>> finer;
            std::map<std::pair<int, int>, int> middles;
            const auto middle = [&](int a, int b) {
                const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(v.size()));
                if (fresh) v.push_back((v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)]) * 0.5);
                return at->second;
            };
            for (const auto& [a, b, c] : f) {
                const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
                finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
            }
            f = std::move(finer);
        }
        const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("hoodoo_law_mesh_{}.ply", ::getpid());
        std::ofstream out(file);
        out << "ply\nformat ascii 1.0\nelement vertex " << v.size() << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
            << f.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
        for (std::size_t k = 0; k < v.size(); ++k) {
            const Vec3d p = v[k].normalized() * (4.0 + unit_real(hash_cell(5, static_cast<std::int64_t>(k), 0)));
            out << static_cast<float>(p.x) << ' ' << static_cast<float>(p.y) << ' ' << static_cast<float>(p.z) << '\n';
        }
        for (const auto& [a, b, c] : f) out << "3 " << a << ' ' << b << ' ' << c << '\n';
        return file.string();
    }();
    return path;
}

const std::string& voxel_path()
{
    static const std::string path = [] {
        const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("hoodoo_law_voxels_{}.npy", ::getpid());
        std::ofstream out(file, std::ios::binary);
        std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (13, 12, 11), }";
        header.resize(117, ' ');
        header += '\n';
        out << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(header.size()) << '\0' << header;
        for (int i = 0; i < 13; ++i)
            for (int j = 0; j < 12; ++j)
                for (int k = 0; k < 11; ++k) {
                    const double x = i - 6.0, y = j - 5.5, z = k - 5.0, ring = std::hypot(std::hypot(x, y) - 3.5, z) - 1.8;
                    const double wave = 0.5 * std::sin(1.3 * x) * std::cos(1.1 * y + 0.7 * z);
                    auto value = static_cast<float>(std::clamp(0.5 - 0.4 * (ring + wave), 0.0, 1.0));
                    if ((i * 7 + j * 5 + k * 3) % 9 == 0 && std::abs(value - 0.5f) < 0.3f) value = 0.5f;
                    out.write(reinterpret_cast<const char*>(&value), sizeof value);
                }
        return file.string();
    }();
    return path;
}

const std::string& heights_path()
{
    static const std::string path = [] {
        const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("hoodoo_law_heights_{}.tif", ::getpid());
        OIIO::ImageSpec spec(37, 43, 1, OIIO::TypeDesc::UINT16);
        std::vector<std::uint16_t> samples;
        for (int row = 0; row < spec.height; ++row) {
            for (int column = 0; column < spec.width; ++column) {
                const double wave = std::sin(0.4 * column) * std::cos(0.33 * row), noise = unit_real(hash_cell(6, column, row));
                samples.push_back(static_cast<std::uint16_t>(column > 20 && row > 25 ? 40000 : 20000 + 9000 * wave + 5000 * noise));
            }
        }
        const auto out = OIIO::ImageOutput::create(file.string());
        out->open(file.string(), spec);
        out->write_image(OIIO::TypeDesc::UINT16, samples.data());
        out->close();
        return file.string();
    }();
    return path;
}

const std::string& layer_path(const std::string& layer)
{
    static const std::map<std::string, std::string> paths = [] {
        std::map<std::string, std::string> made;
        std::vector<float> bedrock, sand, water;
        for (int row = 0; row < 29; ++row) {
            for (int column = 0; column < 37; ++column) {
                const double rock = 2.0 + 1.2 * std::sin(0.35 * column) * std::cos(0.4 * row) + 0.4 * unit_real(hash_cell(7, column, row));
                const double drift = std::max(0.0, 0.5 * std::sin(0.9 * column + 0.3 * row)), level = column < 18 ? 1.7 : 2.1;
                bedrock.push_back(static_cast<float>(rock));
                sand.push_back(static_cast<float>(drift));
                water.push_back(std::max(0.0f, static_cast<float>(level) - bedrock.back() - sand.back()));
            }
        }
        for (const auto& [name, numbers] : {std::pair("bedrock", bedrock), std::pair("sand", sand), std::pair("water", water)}) {
            made[name] = (std::filesystem::temp_directory_path() / fmt::format("hoodoo_law_{}_{}.exr", name, ::getpid())).string();
            OIIO::ImageSpec spec(37, 29, 1, OIIO::TypeDesc::FLOAT);
            const auto out = OIIO::ImageOutput::create(made[name]);
            out->open(made[name], spec);
            out->write_image(OIIO::TypeDesc::FLOAT, numbers.data());
            out->close();
        }
        return made;
    }();
    return paths.at(layer);
}

}  // namespace hoodoo::testing
