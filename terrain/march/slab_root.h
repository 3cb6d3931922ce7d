// The second half of meeting a cluster: the exact first crossing of one slab, in double precision.
#pragma once

#include "terrain/march/cluster.h"

namespace hoodoo
{

/// A ray in the lattice frame of a tile (its first cell at the origin); t stays in metres.
struct SlabRay {
    Vec3d origin, direction;
    Vec3d inverse;               ///< 1 / direction; anything where direction is 0
    Vec2d domain_lo, domain_hi;  ///< crossings outside are not reported (half cells at the rim of a terrain)
    Crossing crossing;
};

/// First t in (t_lo, t_hi) at which the ray crosses F = delta inside the closed slab, in the sense of ray.crossing. Sets t and returns true.
/// If `exists` is enough, t is not computed.
bool first_crossing(const Slab& slab, const SlabRay& ray, double t_lo, double t_hi, bool exists, double& t);

}  // namespace hoodoo
