// Rays against cracked ground: exact where cracks begin and end, certified for the heights between.
#pragma once

#include "terrain/fields/cracked_field.h"
#include "terrain/surface.h"

#include <vector>

namespace hoodoo
{

struct CrackedPatchSettings {
    double size = 1.0;       ///< side of a patch, about, metres
    double accuracy = 1e-7;  ///< metres along the ray: of a crossing of floor or top; walls are met exactly
};

/// The region of a cracked field in rectangles, each with its proved range of heights. The verbs are those of Surface, with the same contracts.
class CrackedPatches
{
public:
    /// Keeps a reference to the field. Throws Error (memory) when there would be more than 2^24 patches.
    CrackedPatches(const CrackedField& field, const CrackedPatchSettings& settings);

    std::uint32_t patch_count() const { return static_cast<std::uint32_t>(patches_.size()); }
    Box3d patch_bounds(std::uint32_t index) const;
    bool intersect(std::uint32_t index, const Ray& ray, Hit& hit) const;
    std::uint64_t memory_bytes() const { return patches_.capacity() * sizeof(Patch); }

    /// What a ray met at `t`, as intersect() reported it.
    struct Met {
        bool wall = false;
        Vec2d into{0.0};  ///< of a wall: the unit normal, towards the air in the crack
    };
    Met met(const Ray& ray, double t) const;

    double accuracy() const { return accuracy_; }
    /// Rounding of a coordinate of the region, metres.
    double rounding() const { return rounding_; }

private:
    struct Patch {
        float lo, hi;            ///< of the heights, above base_
        float slope, curvature;  ///< of the ground's height
    };
    Box2d area(std::uint32_t index) const;
    Patch measure(const Box2d& area) const;
    bool search(const Patch& patch, const Ray& ray, const CrackNetwork::Piece& piece, double& t, std::uint32_t& evaluations) const;
    /// Of a piece with one formula.
    bool search_smooth(const Patch& patch, const Ray& ray, const CrackNetwork::Piece& piece, double& t, std::uint32_t& evaluations) const;

    const CrackedField& field_;
    double accuracy_, rounding_, hair_, base_ = 0.0;
    int nx_ = 1, ny_ = 1;
    std::vector<Patch> patches_;
};

}  // namespace hoodoo
