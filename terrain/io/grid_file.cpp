// A field's samples as an array, a picture or a volume. NumPy's format: a head of text, padded to 64 bytes, then the numbers as they lie in memory.
// Missing: compression of arrays, half floats.
#include "terrain/io/grid_file.h"

#include "terrain/error.h"
#include "terrain/io/atomic_file.h"
#include "terrain/io/raster.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace hoodoo
{

namespace
{

static_assert(std::endian::native == std::endian::little, "arrays are written as '<f8'");

void write_npy(const std::string& path, const SampledGrid& grid)
{
    const auto& n = grid.count;
    const std::string shape = n[2] == 1 ? fmt::format("({}, {})", n[0], n[1]) : fmt::format("({}, {}, {})", n[0], n[1], n[2]);
    std::string head = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape);
    // Magic, version and length are 10 bytes; a line end closes the head.
    head.resize((head.size() + 1 + 10 + 63) / 64 * 64 - 10 - 1, ' ');
    head += '\n';
    const std::array<unsigned char, 10> magic{
        0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, static_cast<unsigned char>(head.size() & 255), static_cast<unsigned char>(head.size() >> 8)};
    write_atomically(
        path,
        [&](ByteSink& sink) {
            sink.write(magic.data(), magic.size());
            sink.write(head.data(), head.size());
            sink.write(grid.values.data(), grid.values.size() * sizeof(double));
        },
        [](const std::string&) {});
}

void write_exr(const std::string& path, const SampledGrid& grid)
{
    const auto& n = grid.count;
    if (n[2] > 1000)
        throw Error(ErrorKind::file,
                    Problem{{path, 0, 0, {}}, "too many heights for the channels of an EXR", "at most 1000", fmt::format("{}", n[2]), {}});
    Raster raster{n[0], n[1], std::abs(grid.step.x - grid.step.y) < 1e-9 * grid.step.x ? grid.step.x : 0.0, {}, {}, grid.place};
    const auto index = [&](int i, int j, int k) {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(n[1]) + static_cast<std::size_t>(j)) * static_cast<std::size_t>(n[2]) +
               static_cast<std::size_t>(k);
    };
    for (int k = 0; k < n[2]; ++k) {
        raster.names.push_back(n[2] == 1 ? "Y" : fmt::format("z{:04}", k));
        std::vector<float>& channel = raster.channels.emplace_back();
        for (int j = n[1] - 1; j >= 0; --j)
            for (int i = 0; i < n[0]; ++i) channel.push_back(static_cast<float>(grid.values[index(i, j, k)]));
    }
    write_raster(path, raster);
}

}  // namespace

void write_grid_file(const std::string& path, const SampledGrid& grid)
{
    if (path.ends_with(".npy")) return write_npy(path, grid);
    if (path.ends_with(".exr")) return write_exr(path, grid);
    if (path.ends_with(".vdb")) return write_vdb_grid(path, grid);
    throw Error(ErrorKind::file,
                Problem{{path, 0, 0, {}}, "the ending of a grid's file", ".npy, .exr or .vdb", path.substr(path.find_last_of('.') + 1), {}});
}

}  // namespace hoodoo
