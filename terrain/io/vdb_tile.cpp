// OpenVDB's polygoniser (dual, after Ju2002: a point in each cell that the surface crosses, a quadrilateral around each edge that it crosses).
// Uniform: adaptivity would make seams between tiles. With vdb_voxels.cpp the only includer of OpenVDB in the library.
#include "terrain/io/vdb_tile.h"

#include "terrain/error.h"

#ifdef HOODOO_OPENVDB

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>

namespace hoodoo
{

LatticeMesh lattice_surface(std::span<const LatticeBlock> sampled, std::span<const std::array<int, 3>> solid)
{
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(1.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    using Leaf = openvdb::FloatTree::LeafNodeType;
    static_assert(Leaf::DIM == 8);
    for (const std::array<int, 3>& c : solid) grid->tree().addTile(Leaf::LEVEL + 1, {c[0], c[1], c[2]}, -1.0f, false);
    for (const LatticeBlock& block : sampled) {
        Leaf* leaf = grid->tree().touchLeaf({block.corner[0], block.corner[1], block.corner[2]});
        std::copy(block.values.begin(), block.values.end(), leaf->buffer().data());
        leaf->setValuesOn();
    }

    openvdb::tools::VolumeToMesh polygoniser(0.0, 0.0, false);
    polygoniser(*grid);
    LatticeMesh mesh;
    mesh.points.reserve(polygoniser.pointListSize());
    for (std::size_t i = 0; i < polygoniser.pointListSize(); ++i) {
        const openvdb::Vec3s& p = polygoniser.pointList()[i];
        mesh.points.emplace_back(p.x(), p.y(), p.z());
    }
    // OpenVDB turns the other way round.
    for (std::size_t i = 0; i < polygoniser.polygonPoolListSize(); ++i) {
        const openvdb::tools::PolygonPool& pool = polygoniser.polygonPoolList()[i];
        for (std::size_t k = 0; k < pool.numQuads(); ++k) {
            const openvdb::Vec4I& q = pool.quad(k);
            mesh.quads.push_back({q[0], q[3], q[2], q[1]});
        }
        for (std::size_t k = 0; k < pool.numTriangles(); ++k) {
            const openvdb::Vec3I& t = pool.triangle(k);
            mesh.quads.push_back({t[0], t[2], t[1], t[1]});
        }
    }
    return mesh;
}

}  // namespace hoodoo

#else

namespace hoodoo
{

LatticeMesh lattice_surface(std::span<const LatticeBlock>, std::span<const std::array<int, 3>>)
{
    throw Error(ErrorKind::internal, "this build has no polygoniser: it was made without OpenVDB (HOODOO_OPENVDB)");
}

}  // namespace hoodoo

#endif
