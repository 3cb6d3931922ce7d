// What every height over the plane must obey, as a function with a verdict.
#pragma once

#include "terrain/fields/height.h"
#include "tests/support/surface_laws.h"

namespace hoodoo::testing
{

/// The slope bound bounds, the range and the gradient's range enclose, the gradient is one (against differences, away from creases), and its change
/// stays below the bound of the curvature. Areas of all sizes about `where`, the part of the domain to look at.
Verdict height_bounds_hold(const Height& height, const Box2d& where, std::uint64_t seed, int count);

}  // namespace hoodoo::testing
