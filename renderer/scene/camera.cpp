// A pinhole camera: a picture plane at distance one from the eye.
//
// With f forward, r right, u up and tangents tx, ty of half the field of view, the pixel coordinate (x, y) of a picture of w x h looks along
//     f + (2 x / w - 1) tx r + (1 - 2 y / h) ty u.
// Missing: lens, depth of field, moving cameras (rays carry their time already).

#include "renderer/scene/camera.h"

#include <cmath>

namespace hoodoo
{

const Schema& camera_schema()
{
    using T = ParameterType;
    static const Schema schema{
        "camera",
        "A pinhole camera. Z is up.",
        {
            {.name = "eye",
             .type = T::vector,
             .doc = "Where the camera stands: in air.",
             .required = true,
             .unit = "m",
             .min_count = 3,
             .max_count = 3},
            {.name = "target",
             .type = T::vector,
             .doc = "A point in the middle of the picture.",
             .required = true,
             .unit = "m",
             .min_count = 3,
             .max_count = 3},
            {.name = "up",
             .type = T::vector,
             .doc = "A direction that is upright in the picture.",
             .fallback = std::vector<double>{0.0, 0.0, 1.0},
             .min_count = 3,
             .max_count = 3},
            {.name = "hfov",
             .type = T::angle,
             .doc = "Field of view across the picture's width. Without hfov and vfov: 50 deg.",
             .minimum = 0.0,
             .maximum = 3.1241393610698496,
             .above_minimum = true},
            {.name = "vfov",
             .type = T::angle,
             .doc = "Field of view across the picture's height; excludes hfov.",
             .minimum = 0.0,
             .maximum = 3.1241393610698496,
             .above_minimum = true},
            {.name = "shutter_open", .type = T::duration, .doc = "When the shutter opens, after the frame's time.", .fallback = 0.0},
            {.name = "shutter_close", .type = T::duration, .doc = "When the shutter closes.", .fallback = 0.0},
        }};
    return schema;
}

Camera::Camera(const Values& values) : eye_(values.vec3("eye")), where_(values.where("eye"))
{
    if (values.has("hfov") && values.has("vfov")) throw values.problem("vfov", "hfov and vfov exclude each other", "one of them");
    const Vec3d target = values.vec3("target"), up = values.vec3("up"), view = target - eye_;
    if (!(view.length() > 0.0)) throw values.problem("target", "target and eye are the same point");
    if (!(up.cross(view).length() > 1e-9 * up.length() * view.length()) || !(up.length() > 0.0))
        throw values.problem("up", "up is zero or lies along the view", "a direction across the view");

    horizontal_ = !values.has("vfov");
    const double fov = values.has("vfov") ? values.number("vfov") : values.has("hfov") ? values.number("hfov") : 0.8726646259971648;
    half_fov_tangent_ = std::tan(0.5 * fov);
    shutter_open_ = values.number("shutter_open");
    shutter_close_ = values.number("shutter_close");
    if (shutter_close_ < shutter_open_) throw values.problem("shutter_close", "the shutter closes before it opens");
    look(target, up);
}

Camera::Camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov, bool horizontal)
    : eye_(eye), half_fov_tangent_(std::tan(0.5 * fov)), horizontal_(horizontal)
{
    look(target, up);
}

void Camera::look(const Vec3d& target, const Vec3d& up)
{
    forward_ = (target - eye_).normalized();
    right_ = forward_.cross(up).normalized();
    up_ = right_.cross(forward_);
}

Vec2d Camera::half_extent(const Vec2i& size) const
{
    const double aspect = static_cast<double>(size.x) / static_cast<double>(size.y);
    return horizontal_ ? Vec2d(half_fov_tangent_, half_fov_tangent_ / aspect) : Vec2d(half_fov_tangent_ * aspect, half_fov_tangent_);
}

Ray Camera::ray(const Vec2d& film, const Vec2i& size, double time) const
{
    const Vec2d extent = half_extent(size);
    const Vec3d across = right_ * ((2.0 * film.x / size.x - 1.0) * extent.x), upwards = up_ * ((1.0 - 2.0 * film.y / size.y) * extent.y);
    const Vec3d along = forward_ + across + upwards;
    const double length = along.length();
    Ray ray;
    ray.origin = eye_;
    ray.direction = along / length;
    ray.time = time;
    ray.footprint_spread = 2.0 * extent.x / (size.x * length);  // a pixel's width, seen from the eye at the distance `length`
    ray.crossing = Crossing::entering;
    return ray;
}

Imath::M44d Camera::view_matrix() const
{
    Imath::M44d m;
    for (int k = 0; k < 3; ++k) m[k][0] = right_[k], m[k][1] = up_[k], m[k][2] = forward_[k];
    m[3][0] = -eye_.dot(right_), m[3][1] = -eye_.dot(up_), m[3][2] = -eye_.dot(forward_);
    return m;
}

Imath::M44f Camera::world_to_camera() const
{
    return Imath::M44f(view_matrix());
}

Imath::M44f Camera::world_to_ndc(const Vec2i& size) const
{
    const Vec2d extent = half_extent(size);
    // x / w = 1/2 + X / (2 tx Z), y / w = 1/2 - Y / (2 ty Z), z / w = 1 - 1 m / Z.
    Imath::M44d p;
    p.makeIdentity();
    p[0][0] = 0.5 / extent.x;
    p[1][1] = -0.5 / extent.y;
    p[2][0] = 0.5, p[2][1] = 0.5, p[2][2] = 1.0, p[2][3] = 1.0;
    p[3][2] = -1.0, p[3][3] = 0.0;
    return Imath::M44f(view_matrix() * p);
}

}  // namespace hoodoo
