// The water of a stack as a body of its own: flat on top at the height of its layers, closed below and at its sides, met by rays exactly.
#pragma once

#include "terrain/stack/convolution.h"
#include "terrain/surface.h"

#include <array>
#include <vector>

namespace hoodoo
{

/// Boxes over columns with water, and over the columns of ground beside them as far as a kernel reaches: there the smooth ground falls away from the
/// columns it is made of, and the water follows it, so that shore and lake bed are closed without a gap. Where the ground's field is negative there
/// is no interface: the ground's own surface is met there. Immutable; the field must outlive it.
class WaterPatches
{
public:
    explicit WaterPatches(const ConvolutionField& ground);

    bool empty() const { return boxes_.empty(); }
    std::uint32_t tile_count() const { return static_cast<std::uint32_t>(tile_begins_.size()) - 1; }
    std::uint32_t patch_count(std::uint32_t tile) const { return tile_begins_[tile + 1] - tile_begins_[tile]; }

    /// As those of Surface, with the same contracts.
    Box3d patch_bounds(PatchId patch) const;
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const;
    bool contains(const Vec3d& p) const;

    /// Place and normal of a hit: t, position and its error, both normals, texture point. The rest is the surface's.
    Interaction interact(const Ray& ray, const Hit& hit) const;

    std::uint64_t memory_bytes() const;

private:
    /// Columns [i0, i1) x [j0, j1) with the same water, heights in units.
    struct Box {
        std::int32_t i0, j0, i1, j1, bottom, top;
    };
    /// One end of a ray's way through a box: through the face across `axis`, at its lower (side 0) or upper (side 1) end.
    struct End {
        double t;
        int axis, side;
    };
    struct Way {
        End in, out;
    };
    struct WetRun;
    class Builder;

    Way way_through(const Box& box, const Ray& ray) const;
    bool is_interface(const Box& box, const Ray& ray, const End& end) const;
    bool wet(int i, int j, double z) const;
    const Box& box_of(PatchId patch) const { return boxes_[tile_begins_[patch.tile] + patch.index]; }

    const ConvolutionField& ground_;
    std::vector<Box> boxes_;
    std::vector<std::uint32_t> tile_begins_{0};
    std::vector<std::uint32_t> column_begins_;  ///< into runs_, one a column and one more; empty without water
    std::vector<Run> runs_;                     ///< of each column, as the boxes over it
};

}  // namespace hoodoo
