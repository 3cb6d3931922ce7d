// The tops of a layer stack's columns as a height over the plane: what stands on heights can stand on layers.
#pragma once

#include "terrain/fields/heightgrid.h"
#include "terrain/stack/material_stack.h"
#include "terrain/surface.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// Nothing of it is met by rays; it has a height and looks. The top of a column is that of its highest solid layer (water does not count), at the
/// column's middle; between middles there are two triangles, as in every height grid.
class ColumnGround final : public Surface
{
public:
    /// Throws Error (scene) for fewer than 2 x 2 columns.
    explicit ColumnGround(const MaterialStack& stack);

    std::uint32_t patch_count(std::uint32_t) const override { return 0; }
    Box3d patch_bounds(PatchId) const override { return {}; }
    bool intersect(PatchId, const Ray&, Hit&) const override { return false; }
    Interaction interact(const Ray&, const Hit&) const override { return {}; }
    /// The materials of the four columns about the point, by their shares of it.
    void dress(Interaction& at) const override;
    bool contains(const Vec3d& p) const override { return p.z <= grid_.height({p.x, p.y}); }
    std::vector<std::string> materials() const override { return names_; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override { return info_; }
    const Height* height() const override { return &grid_; }

private:
    HeightGrid grid_;
    SurfaceInfo info_;
    std::vector<std::string> names_;
    std::vector<std::uint8_t> seen_;  ///< number in names_ of each column's top material, row by row
};

}  // namespace hoodoo
