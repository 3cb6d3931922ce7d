// How the surface of one field is cut into patches and met by rays: what the intersectors have in common.
#pragma once

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
};

}  // namespace hoodoo
