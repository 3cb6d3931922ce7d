// What a ray meets on a height grid, found without its walk: every triangle, and every place where the ground bends, in 80-bit numbers.
#pragma once

#include "terrain/fields/heightgrid.h"
#include "tests/support/surface_laws.h"

namespace hoodoo::testing
{

/// Whether `t` (infinite: a miss) is the nearest crossing of the kind ray.crossing: the ground is met at t within the rounding of heights; no
/// triangle that the ray certainly passes through lies before t; and between any two places before t where the ray is certainly above and certainly
/// below the ground, none of the wanted kind is left out.
Verdict is_nearest_on_grid(const HeightGrid& grid, const Ray& ray, double t);

/// A rugged grid of the type: noise, a plateau (equal heights), walls and a slope; `columns` x `rows` nodes.
HeightGrid rugged_grid(SampleType type, int columns, int rows, const Vec3d& origin);

/// Ray number n: of ten, two tangent to a triangle, one starts at the ground, one in a line of the lattice or along an axis, one through a node or
/// along an edge exactly; the others aim at the ground from all sides. Half ask for any crossing.
Ray grid_ray(const HeightGrid& grid, std::uint64_t seed, std::uint64_t n);

}  // namespace hoodoo::testing
