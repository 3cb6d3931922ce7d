// Cross sections of swept tools: closed smooth curves in a plane.
#pragma once

#include "terrain/math/vec.h"

#include <span>
#include <vector>

namespace hoodoo
{

/// Corners of a closed cross section, metres: x to the right when one looks along the skeleton, y along the frame's normal. Profiles that are
/// interpolated have the same number of corners.
using Profile2 = std::vector<Vec2d>;

/// The closed uniform Catmull-Rom spline through at least 3 control points, as `corners` corners evenly spaced in its parameter. Linear in the
/// control points: corners of a mean are means of corners.
Profile2 closed_spline(std::span<const Vec2d> control, int corners);

/// An ellipse around the skeleton, half as wide as `width` to each side, as a polygon of its area.
Profile2 ellipse(double width, double height, int corners);

/// Mean distance of the corners from the skeleton.
double mean_radius(std::span<const Vec2d> profile);

}  // namespace hoodoo
