// How far what a sample sees moves over the picture while the shutter is open.
#pragma once

#include "renderer/scene/camera.h"
#include "terrain/surface.h"

namespace hoodoo
{

/// Pixels from the shutter's opening to its closing, x to the right, y downwards: the point is taken along its own velocity from `time`, when it was
/// seen, to both ends, and projected by the camera of each. 0 where it passes the eye's plane, and for a picture of no size.
inline Vec2f picture_motion(const Camera& camera, const Interaction& at, double time, const Vec2i& size)
{
    if (size.x <= 0 || size.y <= 0 || (!camera.moves() && at.velocity == Vec3d(0.0))) return Vec2f(0.0f);
    const Vec2d opening = camera.project(at.position - at.velocity * time, size, 0.0);
    const Vec2d moved = camera.project(at.position + at.velocity * (1.0 - time), size, 1.0) - opening;
    return std::isfinite(moved.x) && std::isfinite(moved.y) ? Vec2f(moved) : Vec2f(0.0f);
}

}  // namespace hoodoo
