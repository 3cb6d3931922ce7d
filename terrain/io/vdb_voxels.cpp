// OpenVDB's grids as voxels: leaves value by value, tiles as blocks. Its leaves are 8 x 8 x 8 as our blocks are, and are laid over them.
// A level set says metres, negative inside; anything else is taken for a density. Where it says nothing there is its background: air. Missing: grids
// of half floats in memory, of integers, masks; points; transforms that turn or stretch.
#include "terrain/io/voxel_file.h"

#ifdef HOODOO_OPENVDB

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <new>
#include <stdexcept>

namespace hoodoo
{

namespace
{

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {}, std::string nearest = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), std::move(nearest)});
}

/// Reads the file as a stream that throws at its end: OpenVDB by itself goes on with whatever it finds there.
openvdb::GridBase::Ptr open_grid(const std::string& path, const std::string& wanted)
{
    openvdb::initialize();
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(path, "cannot read the voxels");
    file.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(file, false).getGrids();
    std::vector<std::string> names;
    for (const auto& grid : *grids) names.push_back(grid->getName());
    if (wanted.empty() && names.size() != 1)
        refuse(path, "the file has several grids: say which one by `array`", fmt::format("one of: {}", fmt::join(names, ", ")));
    const auto found = wanted.empty() ? names.begin() : std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
        refuse(path, "the file has no grid of this name", fmt::format("one of: {}", fmt::join(names, ", ")), '"' + wanted + '"',
               nearest_name(wanted, names));
    return (*grids)[static_cast<std::size_t>(found - names.begin())];
}

template <class Grid>
VoxelGrid convert(const Grid& grid, const std::string& path, const VoxelFileOptions& options, const Source& where)
{
    const bool distance =
        options.meaning == VoxelMeaning::distance || (options.meaning == VoxelMeaning::automatic && grid.getGridClass() == openvdb::GRID_LEVEL_SET);
    const double iso = options.iso.value_or(distance ? 0.0 : 0.5);
    const openvdb::Vec3d voxel = grid.voxelSize();
    const openvdb::Vec3d zero = grid.indexToWorld(openvdb::Vec3d(0.0)), x = grid.indexToWorld(openvdb::Vec3d(1, 0, 0)) - zero,
                         y = grid.indexToWorld(openvdb::Vec3d(0, 1, 0)) - zero, z = grid.indexToWorld(openvdb::Vec3d(0, 0, 1)) - zero;
    const double s = voxel.x();
    if (!(s > 0.0) || (x - openvdb::Vec3d(s, 0, 0)).length() > 1e-6 * s || (y - openvdb::Vec3d(0, s, 0)).length() > 1e-6 * s ||
        (z - openvdb::Vec3d(0, 0, s)).length() > 1e-6 * s)
        refuse(path, "the grid's transform turns or stretches", "cubes along the axes");
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty()) refuse(path, "the grid is empty");

    // Sample b of ours is voxel b + base of theirs, with base a multiple of 8 and room for our rim.
    Index3 base, inner;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        base[at] = ((box.min()[k] - 1) >> 3) * 8;
        const long long n = static_cast<long long>(box.max()[k]) - base[at];
        if (n > 65536) refuse(path, "an axis of the voxels", "1 to 65536 samples", fmt::format("{}", n));
        inner[at] = static_cast<int>(n);
    }
    const double cell = options.cell.value_or(s);
    const Vec3d theirs = options.origin.value_or(Vec3d(zero.x(), zero.y(), zero.z()));
    const auto value_of = [&](double v) { return static_cast<float>(distance ? (v - iso) * (cell / s) : iso - v); };
    const float air = value_of(static_cast<double>(grid.background()));
    if (!(air > 0.0f))
        throw Error(ErrorKind::scene, Problem{where,
                                              "the background of the grid would be matter",
                                              distance ? "an iso below it" : "an iso above it",
                                              fmt::format("{:.6g} with iso {:.6g}", static_cast<double>(grid.background()), iso),
                                              {}});
    VoxelGrid voxels(inner, cell, theirs + Vec3d(base[0] + 1, base[1] + 1, base[2] + 1) * cell, air);
    voxels.names = options.materials;
    std::uint64_t bad = 0;
    const openvdb::CoordBBox room({base[0] + 1, base[1] + 1, base[2] + 1}, {base[0] + inner[0], base[1] + inner[1], base[2] + inner[2]});
    for (auto it = grid.cbeginValueAll(); it; ++it) {
        const float value = value_of(static_cast<double>(*it));
        bad += !std::isfinite(value);
        openvdb::CoordBBox part = it.getBoundingBox();
        part.intersect(room);
        if (part.empty() || value == air) continue;
        const auto ours = [&](const openvdb::Coord& c) { return Index3{c[0] - base[0], c[1] - base[1], c[2] - base[2]}; };
        const Index3 lo = ours(part.min()), hi = ours(part.max());
        for (int bi = lo[0] / 8; bi <= hi[0] / 8; ++bi)
            for (int bj = lo[1] / 8; bj <= hi[1] / 8; ++bj)
                for (int bk = lo[2] / 8; bk <= hi[2] / 8; ++bk) {
                    const Index3 b{bi, bj, bk};
                    const auto whole = [&](std::size_t k) { return lo[k] <= 8 * b[k] && hi[k] >= 8 * b[k] + 7; };
                    if (whole(0) && whole(1) && whole(2)) {
                        voxels.values.set_block(b, value);
                        continue;
                    }
                    for (int i = std::max(lo[0], 8 * bi); i <= std::min(hi[0], 8 * bi + 7); ++i)
                        for (int j = std::max(lo[1], 8 * bj); j <= std::min(hi[1], 8 * bj + 7); ++j)
                            for (int k = std::max(lo[2], 8 * bk); k <= std::min(hi[2], 8 * bk + 7); ++k) voxels.set({i, j, k}, value);
                }
    }
    if (bad > 0) refuse(path, fmt::format("{} of the voxels are not finite", bad), "finite numbers");
    voxels.trim();
    return voxels;
}

}  // namespace

VoxelGrid read_vdb_voxels(const std::string& path, const VoxelFileOptions& options, const Source& where)
{
    try {
        const openvdb::GridBase::Ptr grid = open_grid(path, options.array);
        if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return convert(*floats, path, options, where);
        if (const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid)) return convert(*doubles, path, options, where);
        refuse(path, "the grid does not hold real numbers", "a grid of float or double", grid->valueType());
    } catch (const openvdb::Exception& error) {
        refuse(path, "cannot read the voxels", {}, error.what());
    } catch (const std::ios_base::failure&) {
        refuse(path, "cannot read the voxels", "a whole file", "one that ends early");
    } catch (const std::length_error&) {
        refuse(path, "cannot read the voxels", "a whole file", "one that is damaged");
    } catch (const std::bad_alloc&) {
        refuse(path, "cannot read the voxels", "a whole file", "one that is damaged, or larger than memory");
    }
}

}  // namespace hoodoo

#else

namespace hoodoo
{

VoxelGrid read_vdb_voxels(const std::string&, const VoxelFileOptions&, const Source&)
{
    throw Error(ErrorKind::internal, "this build reads no .vdb files: it was made without OpenVDB (HOODOO_OPENVDB)");
}

}  // namespace hoodoo

#endif
