// Slices of numbers become values of an implicit function: F = iso - density, or F = distance - iso, in single precision. What is equal over a whole
// block is forgotten while the file is read, the rest of what the surface does not need at the end (VoxelGrid::trim), so memory follows the surface
// but for the current slices. Missing: arrays in Fortran order; more than one solid in a file.
#include "terrain/io/voxel_file.h"

#include "terrain/io/npz.h"
#include "terrain/io/numpy_header.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace hoodoo
{

namespace
{

constexpr std::uint64_t kMostSamples = 1ull << 36;  // an .npy of 2^36 bytes is 64 GiB: read slice by slice
constexpr int kPruneEvery = 32;                     // slices

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

Index3 size_of(const std::string& path, const std::vector<std::size_t>& shape)
{
    if (shape.size() != 3) refuse(path, "voxels are an array of three axes (x, y, z)", "three", fmt::format("{}", shape.size()));
    for (const std::size_t n : shape)
        if (n < 1 || n > 65536) refuse(path, "an axis of the voxels", "1 to 65536 samples", fmt::format("{}", n));
    return {static_cast<int>(shape[0]), static_cast<int>(shape[1]), static_cast<int>(shape[2])};
}

void read_materials(VoxelGrid& grid, const Index3& size, const NumpyArray& array, const std::string& path, const VoxelFileOptions& options)
{
    if (size_of(path, array.shape) != size)
        refuse(path, "the array of materials has another shape than the voxels", fmt::format("{} x {} x {}", size[0], size[1], size[2]),
               fmt::format("{} x {} x {}", array.shape[0], array.shape[1], array.shape[2]));
    grid.materials.emplace(grid.values.size(), std::uint8_t{0});
    std::size_t n = 0;
    for (int i = 1; i <= size[0]; ++i)
        for (int j = 1; j <= size[1]; ++j)
            for (int k = 1; k <= size[2]; ++k) {
                const double m = array.values[n++];
                if (!(m >= 0.0 && m < static_cast<double>(options.materials.size())) || m != std::floor(m))
                    refuse(
                        path, fmt::format("the material of voxel ({}, {}, {})", i - 1, j - 1, k - 1),
                        fmt::format("a whole number from 0 to {}, for one of: {}", options.materials.size() - 1, fmt::join(options.materials, ", ")),
                        fmt::format("{:.6g}", m));
                grid.materials->set({i, j, k}, static_cast<std::uint8_t>(m));
            }
    grid.materials->prune();
}

VoxelGrid read_npz(const std::string& path, const VoxelFileOptions& options, const Source& where)
{
    const NpzFile file(path);
    std::string name = options.array;
    if (name.empty()) {
        std::vector<std::string> others;
        for (const std::string& n : file.names())
            if (n != options.material_array) others.push_back(n);
        if (others.size() != 1)
            throw Error(
                ErrorKind::scene,
                Problem{
                    where, "the archive has several arrays: say which one by `array`", fmt::format("one of: {}", fmt::join(others, ", ")), {}, {}});
        name = others.front();
    }
    const NumpyArray array = file.read(name);
    const Index3 size = size_of(path, array.shape);
    const double* from = array.values.data();
    VoxelGrid grid = voxels_from_slices(size, options, path, where, [&](std::vector<double>& slice) {
        std::copy(from, from + slice.size(), slice.begin());
        from += slice.size();
    });
    if (!options.material_array.empty()) read_materials(grid, size, file.read(options.material_array), path, options);
    return grid;
}

VoxelGrid read_npy(const std::string& path, const VoxelFileOptions& options, const Source& where)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<unsigned char> bytes(kMostNumpyHeader);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (file.bad() || (file.gcount() == 0 && !std::filesystem::exists(path))) refuse(path, "cannot read the voxels");
    const std::string name = std::filesystem::path(path).filename().string();
    const NumpyHeader header = read_numpy_header(path, name, bytes.data(), static_cast<std::size_t>(file.gcount()), kMostSamples);
    const Index3 size = size_of(path, header.shape);
    std::error_code failed;
    const std::uintmax_t on_disk = std::filesystem::file_size(path, failed);
    if (failed || on_disk - header.data < header.count * header.width) refuse(path, "\"" + name + "\" is cut short");
    file.clear();
    file.seekg(static_cast<std::streamoff>(header.data));
    return voxels_from_slices(size, options, path, where, [&](std::vector<double>& slice) {
        bytes.resize(slice.size() * header.width);
        if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) refuse(path, "cannot read the voxels");
        header.convert(bytes.data(), slice);
    });
}

}  // namespace

VoxelGrid voxels_from_slices(const Index3& size, const VoxelFileOptions& options, const std::string& path, const Source& where,
                             const std::function<void(std::vector<double>&)>& next_slice)
{
    const bool distance = options.meaning == VoxelMeaning::distance;
    const double iso = options.iso.value_or(distance ? 0.0 : 0.5), cell = options.cell.value_or(1.0);
    if (!distance && !(iso > 0.0))
        throw Error(
            ErrorKind::scene,
            Problem{where, "the level of a density: around the voxels there is air of density 0", "an iso above 0", fmt::format("{:.6g}", iso), {}});
    VoxelGrid grid(size, cell, options.origin.value_or(Vec3d(0.0)), static_cast<float>(distance ? cell : iso));
    grid.names = options.materials;
    std::vector<double> slice(static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]));
    std::uint64_t bad = 0;
    Index3 first_bad{};
    for (int i = 1; i <= size[0]; ++i) {
        next_slice(slice);
        std::size_t n = 0;
        for (int j = 1; j <= size[1]; ++j)
            for (int k = 1; k <= size[2]; ++k) {
                const auto value = static_cast<float>(distance ? slice[n] - iso : iso - slice[n]);
                ++n;
                if (std::isfinite(value)) {
                    grid.set({i, j, k}, value);
                } else if (bad++ == 0) {
                    first_bad = {i - 1, j - 1, k - 1};
                }
            }
        if (i % kPruneEvery == 0) grid.values.prune();
    }
    if (bad > 0)
        refuse(path, fmt::format("{} of the voxels are not finite, the first is ({}, {}, {})", bad, first_bad[0], first_bad[1], first_bad[2]),
               "finite numbers");
    grid.trim();
    return grid;
}

VoxelGrid read_voxel_file(const std::string& path, const VoxelFileOptions& options, const Source& where)
{
    const std::string extension = std::filesystem::path(path).extension().string();
    if (!options.material_array.empty() && extension != ".npz")
        throw Error(ErrorKind::scene,
                    Problem{where, "an array of materials stands in an .npz beside the voxels", "a file .npz", "\"" + extension + "\"", {}});
    if (extension == ".npz") return read_npz(path, options, where);
    if (extension == ".npy") return read_npy(path, options, where);
    if (extension == ".vdb") return read_vdb_voxels(path, options, where);
    throw Error(ErrorKind::scene, Problem{where, "a file of voxels", ".npy, .npz or .vdb", "\"" + extension + "\"", {}});
}

}  // namespace hoodoo
