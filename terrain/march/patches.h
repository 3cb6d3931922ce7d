// How the surface of one field is cut into patches and met by rays: what the intersectors have in common.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/surface.h"

namespace hoodoo
{

/// One body of matter, cut into tiles of patches. The verbs are those of Surface, with the same contracts.
class PatchIntersector
{
public:
    virtual ~PatchIntersector() = default;
    virtual std::uint32_t tile_count() const = 0;
    virtual std::uint32_t patch_count(std::uint32_t tile) const = 0;
    virtual Box3d patch_bounds(PatchId patch) const = 0;
    virtual bool intersect(PatchId patch, const Ray& ray, Hit& hit) const = 0;
    virtual bool occluded(PatchId patch, const Ray& ray) const = 0;
    /// Proved: at the reported t, |f| is at most this (f of the field the patches were made from).
    virtual double value_error() const = 0;
    virtual std::uint64_t memory_bytes() const = 0;
    /// Follows an edit of the field's stack: makes the tiles anew that read one of the columns, exactly as a new intersector would, and returns them,
    /// ascending. What the field is made of besides (kernel, border, grid) must not have changed. Not while other threads use the intersector.
    virtual std::vector<std::uint32_t> rebuild(const ColumnSet& changed) = 0;
};

}  // namespace hoodoo
