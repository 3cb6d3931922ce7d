// What every surface must obey, as functions with a verdict: applied to all rows of the catalogue, and to mutants that must fail.
#pragma once

#include "terrain/field.h"
#include "terrain/shape.h"

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo::testing
{

/// Empty: the law holds. Otherwise the first fault found, in words.
struct Verdict {
    std::string fault;
    bool holds() const { return fault.empty(); }
};

/// Rays that meet the surface in every way: aimed at its patches from all sides; along axes; starting next to a hit; and tangent to one
/// (|n . d| < 0.02). Two of ten are tangent, one starts at a hit, one is parallel to an axis.
std::vector<Ray> law_rays(const Surface& surface, std::uint64_t seed, int count);

/// Nearest hit over all patches, one by one; t is infinite on a miss.
Hit nearest_hit(const Surface& surface, const Ray& ray);

/// A hit of a patch lies in the patch's box.
Verdict bounds_contain_hits(const Surface& surface, const std::vector<Ray>& rays);

/// Nothing lies before the nearest hit: no change of side of the kind ray.crossing, certified by the field's slope bounds (or, without a field,
/// seen by dense sampling of contains(), in the middle share `trusted` of the bounds). And the hit is one: the surface is within its stated error.
Verdict nearest_is_nearest(const Surface& surface, const std::vector<Ray>& rays, double trusted = 1.0);

/// occluded() says what intersect() says, patch by patch.
Verdict occluded_agrees(const Surface& surface, const std::vector<Ray>& rays);

/// Normals have unit length; the geometric one is across the surface (gradient by finite differences, or neighbouring hits) and points to air; the
/// shading normal is in its hemisphere; material shares are positive and sum to 1.
Verdict normals_are_gradients(const Surface& surface, const std::vector<Ray>& rays);

/// A ray spawned at a hit, away from the surface, does not meet the same place again.
Verdict spawned_rays_leave(const Surface& surface, const std::vector<Ray>& rays);

/// Two surfaces, one moved by `shift`, answer alike about rays moved alike.
Verdict translation_moves_hits(const Surface& surface, const Surface& moved, const Vec3d& shift, const std::vector<Ray>& rays);

/// Two surfaces answer with the same bits.
Verdict same_bits(const Surface& a, const Surface& b, const std::vector<Ray>& rays);

/// No ray from inside a closed surface escapes. `count` rays.
Verdict closed_leaks_none(const Surface& surface, std::uint64_t seed, int count);

/// The slope bound bounds, and the range encloses. Segments and boxes of all sizes about the surface's patches.
Verdict field_bounds_hold(const Field& field, const Box3d& where, std::uint64_t seed, int count);

/// All patches' boxes in one.
Box3d surface_bounds(const Surface& surface);

}  // namespace hoodoo::testing
