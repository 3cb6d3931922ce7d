// An error-controlled integrator: the reference that fixed steps are compared with.
#pragma once

#include "terrain/fields/flow.h"

namespace hoodoo::testing
{

/// Follows p' = v(p, t) from time `t0` to `t1` (backwards if t1 < t0), local error below `tolerance`: the pair of order 5(4) of Dormand1980.
Vec3d follow(const Flow& flow, const Vec3d& p, double t0, double t1, double tolerance = 1e-13);

}  // namespace hoodoo::testing
