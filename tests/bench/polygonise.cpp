// A convolution surface polygonised by OpenVDB (dual contouring of samples), for comparison only.

#include "tests/bench/polygonise.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>

namespace hoodoo::bench
{

TriangleMesh polygonise(const ConvolutionField& field, const PatchIntersector& patches, double spacing)
{
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(1.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    auto samples = grid->getAccessor();

    // Sample around every box that can hold surface, two samples wide, so that each crossing cell has all its corners.
    const auto sample = [&](const openvdb::Coord& c) {
        if (!samples.isValueOn(c)) samples.setValue(c, static_cast<float>(field.value(Vec3d(c.x() * spacing, c.y() * spacing, c.z() * spacing))));
    };
    for (std::uint32_t tile = 0; tile < patches.tile_count(); ++tile) {
        for (std::uint32_t i = 0; i < patches.patch_count(tile); ++i) {
            const Box3d box = patches.patch_bounds({tile, i});
            const auto lo = [&](int k) { return static_cast<int>(std::floor(box.min[k] / spacing)) - 1; };
            const auto hi = [&](int k) { return static_cast<int>(std::ceil(box.max[k] / spacing)) + 1; };
            for (int x = lo(0); x <= hi(0); ++x)
                for (int y = lo(1); y <= hi(1); ++y)
                    for (int z = lo(2); z <= hi(2); ++z) sample({x, y, z});
        }
    }
    openvdb::tools::signedFloodFill(grid->tree());

    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, triangles, quads, 0.0);

    TriangleMesh mesh;
    mesh.vertices.reserve(points.size());
    for (const auto& p : points)
        mesh.vertices.emplace_back(p.x() * static_cast<float>(spacing), p.y() * static_cast<float>(spacing), p.z() * static_cast<float>(spacing));
    for (const auto& t : triangles) mesh.triangles.push_back({t.x(), t.z(), t.y()});
    for (const auto& q : quads) {
        mesh.triangles.push_back({q.x(), q.z(), q.y()});
        mesh.triangles.push_back({q.x(), q.w(), q.z()});
    }
    return mesh;
}

}  // namespace hoodoo::bench
