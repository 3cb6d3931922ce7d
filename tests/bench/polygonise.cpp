// A convolution surface as the mesh that `hoodoo mesh` writes: the baseline.
#include "tests/bench/polygonise.h"

#include "terrain/io/polygonise.h"

namespace hoodoo::bench
{

TriangleMesh polygonise(const ConvolutionField& field, const PatchIntersector& patches, double spacing)
{
    PolygoniseOptions options;
    options.spacing = spacing;
    for (std::uint32_t tile = 0; tile < patches.tile_count(); ++tile)
        for (std::uint32_t i = 0; i < patches.patch_count(tile); ++i) options.region.extendBy(patches.patch_bounds({tile, i}));
    TriangleMesh mesh;
    hoodoo::polygonise(field, options, [&](const MeshPart& part) {
        for (const Vec3d& p : part.vertices) mesh.vertices.emplace_back(p);
        mesh.triangles.insert(mesh.triangles.end(), part.triangles.begin(), part.triangles.end());
    });
    return mesh;
}

}  // namespace hoodoo::bench
