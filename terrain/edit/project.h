// From a point near a surface to a point on it: how edit tools are aimed.
#pragma once

#include "terrain/field.h"

#include <optional>

namespace hoodoo
{

/// The first change of side of `field` along `direction` (unit) from `from`, at most `reach` metres away. `slope` bounds the field's change per metre
/// along any direction. Grazes shorter than a fiftieth of 1 / slope may be passed over.
std::optional<Vec3d> first_crossing(const Field& field, const Vec3d& from, const Vec3d& direction, double slope, double reach);

/// A point of the surface near `from`: the nearest crossing along 26 directions (axes and diagonals), then along the normals found there until it
/// comes no nearer. A foot point of `from`, not always the nearest of several. Looks up to `reach` metres far; `first_reach` is where it begins.
std::optional<Vec3d> project(const Field& field, const Vec3d& from, double slope, double first_reach, double reach);

}  // namespace hoodoo
