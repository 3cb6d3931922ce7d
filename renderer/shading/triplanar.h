// A plane texture on any surface: three projections along the axes, blended by how much the surface faces each (maths A10).
#pragma once

#include "terrain/math/vec.h"

#include <array>

namespace hoodoo
{

/// Shares of the projections along x, y, z; each in [0, 1], their sum is 1. `n` need not be a unit vector, but not zero; exponent >= 1.
Vec3d triplanar_weights(const Vec3d& n, double exponent);

/// The same without the shares too small to be seen, so that most surfaces pay for one or two projections: shares under 1% are 0,
/// the others lose 1% (so that the blend stays continuous) and are scaled to the sum 1.
Vec3d triplanar_lookup_weights(const Vec3d& n, double exponent);

/// World axes of the texture plane that is projected along `axis`: (y, z), (x, z), (x, y).
constexpr std::array<std::array<int, 2>, 3> kTriplanarAxes = {{{1, 2}, {0, 2}, {0, 1}}};

/// Coordinates of `p` in that plane, metres, not mirrored anywhere: `second` grows with z on upright planes, so textures stand upright.
inline Vec2d triplanar_coordinates(const Vec3d& p, int axis)
{
    return {p[static_cast<unsigned>(kTriplanarAxes[static_cast<std::size_t>(axis)][0])],
            p[static_cast<unsigned>(kTriplanarAxes[static_cast<std::size_t>(axis)][1])]};
}

/// Slopes of a height map over that plane (height per metre along its two axes) as a gradient in world space. Needs no tangent frame and no
/// sign of the normal: heights grow along the normal, whichever way it points.
inline Vec3d triplanar_gradient(const Vec2d& slopes, int axis)
{
    Vec3d g(0.0);
    g[static_cast<unsigned>(kTriplanarAxes[static_cast<std::size_t>(axis)][0])] = slopes.x;
    g[static_cast<unsigned>(kTriplanarAxes[static_cast<std::size_t>(axis)][1])] = slopes.y;
    return g;
}

/// The normal of a surface of unit normal `n` raised along it by a height of gradient `g` (per metre): n minus the tangential part of g.
/// If the result would turn away from the unit `geometric` normal by more than about 87 degrees, it is bent back to there.
Vec3d bumped_normal(const Vec3d& n, const Vec3d& g, const Vec3d& geometric);

}  // namespace hoodoo
