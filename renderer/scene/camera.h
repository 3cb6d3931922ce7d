// The pinhole camera: pixels and times -> rays, and the matrices that a picture's header states.
#pragma once

#include "renderer/scene/camera_path.h"
#include "terrain/schema.h"

#include <Imath/ImathMatrix.h>

namespace hoodoo
{

/// Schema of the [camera] table: eye, target, up, hfov or vfov, or [[camera.key]] poses; the shutter.
const Schema& camera_schema();

/// When a frame is: the time of its beginning in seconds, and how many there are a second.
struct FrameTime {
    double seconds = 0.0;
    double fps = 24.0;
};

/// World space is right-handed with z up. Camera space, as EXR files from RenderMan have it: x to the right, y up in the picture, z forward, so that
/// z is the distance along the view axis (left-handed). Immutable, thread-safe.
class Camera
{
public:
    /// Throws Error (scene) at the value's position if eye and target coincide, `up` is along the view, both fields of view are given, keys are out
    /// of order, or the shutter is told twice.
    explicit Camera(const Values& values, const FrameTime& frame = {});
    /// For code: looks from `eye` to `target`; `fov` in radians, of the picture's width if `horizontal`, else of its height.
    Camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov, bool horizontal);

    /// The ray through `film` (pixels from the top left corner of a picture of `size` pixels, y downwards) at `time` in [0, 1] of the shutter.
    /// Its footprint is the cone of one pixel. Crossing::entering, for an eye in air; the Scene knows where the eye is.
    Ray ray(const Vec2d& film, const Vec2i& size, double time) const;

    /// Where a point is seen at `time`: on the film, in pixels, as ray() counts them. Not finite unless it lies in front of the eye.
    Vec2d project(const Vec3d& p, const Vec2i& size, double time) const;

    /// At a time in [0, 1] of the shutter.
    Vec3d eye(double time = 0.0) const { return view(time).eye; }
    Vec3d forward(double time = 0.0) const { return view(time).forward; }  ///< unit
    double shutter_open() const { return shutter_open_; }                  ///< seconds after the frame's own time
    double shutter_close() const { return shutter_close_; }
    bool moves() const { return moves_; }  ///< while the shutter is open

    /// Distance of `p` from the eye along the view axis, metres: the Z channel.
    double depth(const Vec3d& p, double time) const
    {
        const View v = view(time);
        return (p - v.eye).dot(v.forward);
    }

    /// When the shutter opens. Row vectors times matrix, as Imath has it.
    Imath::M44f world_to_camera() const;
    /// To x, y in [0, 1] from the top left corner after division by w; z / w is 0 at one metre and 1 at infinity.
    Imath::M44f world_to_ndc(const Vec2i& size) const;

    /// Where the eye stands in the scene file, for an Error about it.
    const Source& where() const { return where_; }

private:
    struct View {
        Vec3d eye, right, up, forward;
        double tangent;  ///< of half the field of view
    };
    static View look(const Pose& pose);
    View view(double time) const
    {
        return moves_ ? look(path_.at(frame_seconds_ + shutter_open_ + time * (shutter_close_ - shutter_open_))) : still_;
    }
    Imath::M44d view_matrix() const;
    Vec2d half_extent(double tangent, const Vec2i& size) const;  ///< tangents of half the field of view, horizontal and vertical

    CameraPath path_;
    bool horizontal_ = true, moves_ = false;
    double frame_seconds_ = 0.0, shutter_open_ = 0.0, shutter_close_ = 0.0;
    View still_;  ///< when the shutter opens
    Source where_;
};

}  // namespace hoodoo
