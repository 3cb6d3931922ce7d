// The pinhole camera: pixels and times -> rays, and the matrices that a picture's header states.
#pragma once

#include "terrain/schema.h"

#include <Imath/ImathMatrix.h>

namespace hoodoo
{

/// Schema of the [camera] table: eye, target, up, hfov or vfov, shutter_open, shutter_close.
const Schema& camera_schema();

/// World space is right-handed with z up. Camera space, as EXR files from RenderMan have it: x to the right, y up in the picture, z forward, so that
/// z is the distance along the view axis (left-handed). Immutable, thread-safe.
class Camera
{
public:
    /// Throws Error (scene) at the value's position if eye and target coincide, `up` is along the view, or both fields of view are given.
    explicit Camera(const Values& values);
    /// For code: looks from `eye` to `target`; `fov` in radians, of the picture's width if `horizontal`, else of its height.
    Camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov, bool horizontal);

    /// The ray through `film` (pixels from the top left corner of a picture of `size` pixels, y downwards) at `time` in [0, 1] of the shutter.
    /// Its footprint is the cone of one pixel. Crossing::entering: eyes are in air (Scene's constructor checks it).
    Ray ray(const Vec2d& film, const Vec2i& size, double time) const;

    const Vec3d& eye() const { return eye_; }
    const Vec3d& forward() const { return forward_; }      ///< unit
    double shutter_open() const { return shutter_open_; }  ///< seconds after the frame's own time
    double shutter_close() const { return shutter_close_; }

    /// Distance of `p` from the eye along the view axis, metres: the Z channel.
    double depth(const Vec3d& p) const { return (p - eye_).dot(forward_); }

    /// Row vectors times matrix, as Imath has it.
    Imath::M44f world_to_camera() const;
    /// To x, y in [0, 1] from the top left corner after division by w; z / w is 0 at one metre and 1 at infinity.
    Imath::M44f world_to_ndc(const Vec2i& size) const;

    /// Where the eye stands in the scene file, for an Error about it.
    const Source& where() const { return where_; }

private:
    void look(const Vec3d& target, const Vec3d& up);
    Imath::M44d view_matrix() const;
    Vec2d half_extent(const Vec2i& size) const;  ///< tangents of half the field of view, horizontal and vertical

    Vec3d eye_{0.0}, right_{1, 0, 0}, up_{0, 0, 1}, forward_{0, 1, 0};
    double half_fov_tangent_ = 1.0;
    bool horizontal_ = true;
    double shutter_open_ = 0.0, shutter_close_ = 0.0;
    Source where_;
};

}  // namespace hoodoo
