// A pinhole camera: a picture plane at distance one from the eye.
//
// With f forward, r right, u up and tangents tx, ty of half the field of view, the pixel coordinate (x, y) of a picture of w x h looks along
//     f + (2 x / w - 1) tx r + (1 - 2 y / h) ty u.
// A camera that moves while the shutter is open stands elsewhere for each ray: its path is a function of time (camera_path.h), never of two poses.
// Missing: lens, depth of field.

#include "renderer/scene/camera.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

namespace
{

Schema key_schema()
{
    using T = ParameterType;
    return {"key",
            "Where the camera is at one frame.",
            {
                {.name = "frame", .type = T::number, .doc = "The frame, which may lie between two.", .required = true},
                {.name = "eye", .type = T::vector, .doc = "Where the camera stands.", .required = true, .unit = "m", .min_count = 3, .max_count = 3},
                {.name = "target", .type = T::vector, .doc = "A point in the middle.", .required = true, .unit = "m", .min_count = 3, .max_count = 3},
                {.name = "up", .type = T::vector, .doc = "Upright in the picture; by default the camera's.", .min_count = 3, .max_count = 3},
                {.name = "fov",
                 .type = T::angle,
                 .doc = "Field of view, along the side that the camera's is; by default the camera's.",
                 .minimum = 0.0,
                 .maximum = 3.1241393610698496,
                 .above_minimum = true},
            }};
}

/// Throws Error (scene) if nothing can be seen from `pose`.
void check_pose(const Pose& pose, const Values& values)
{
    const Vec3d view = pose.target - pose.eye;
    if (!(view.length() > 0.0)) throw values.problem("target", "target and eye are the same point");
    if (!(pose.up.cross(view).length() > 1e-9 * pose.up.length() * view.length()) || !(pose.up.length() > 0.0))
        throw values.problem("up", "up is zero or lies along the view", "a direction across the view");
}

CameraPath read_path(const Values& values, double fps)
{
    const std::vector<Values>& tables = values.tables("key");
    Pose base;
    base.up = values.vec3("up");
    if (values.has("vfov") || values.has("hfov")) base.fov = values.number(values.has("vfov") ? "vfov" : "hfov");
    if (tables.empty()) {
        for (const char* name : {"eye", "target"})
            if (!values.has(name))
                throw Error(ErrorKind::scene,
                            Problem{values.where(), fmt::format("camera lacks the key \"{}\"", name), "a point, or [[camera.key]] tables", {}, {}});
        base.eye = values.vec3("eye");
        base.target = values.vec3("target");
        check_pose(base, values);
        return CameraPath(base);
    }
    for (const char* name : {"eye", "target"})
        if (values.has(name)) throw values.problem(name, fmt::format("{} and keys exclude each other", name), "one of them");
    std::vector<CameraPath::Key> keys;
    for (const Values& table : tables) {
        CameraPath::Key key{table.number("frame") / fps, base};
        key.pose.eye = table.vec3("eye");
        key.pose.target = table.vec3("target");
        if (table.has("up")) key.pose.up = table.vec3("up");
        if (table.has("fov")) key.pose.fov = table.number("fov");
        check_pose(key.pose, table);
        if (!keys.empty() && !(key.time > keys.back().time))
            throw table.problem("frame", "keys are out of order", "a later frame than the key before");
        keys.push_back(key);
    }
    const std::string& easing = values.text("easing");
    return {std::move(keys), easing == "spline" ? Easing::spline : easing == "ease" ? Easing::ease : Easing::linear};
}

}  // namespace

const Schema& camera_schema()
{
    using T = ParameterType;
    static const Schema schema{
        "camera",
        "A pinhole camera. Z is up.",
        {
            {.name = "eye",
             .type = T::vector,
             .doc = "Where the camera stands: in air. Required without keys.",
             .unit = "m",
             .min_count = 3,
             .max_count = 3},
            {.name = "target",
             .type = T::vector,
             .doc = "A point in the middle of the picture. Required without keys.",
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
            {.name = "shutter_close", .type = T::duration, .doc = "When the shutter closes; by default it is open for no time at all."},
            {.name = "shutter_angle",
             .type = T::angle,
             .doc = "How long the shutter is open, 360 deg being the whole of a frame; instead of shutter_close.",
             .minimum = 0.0,
             .maximum = 6.283185307179587},
            {.name = "easing",
             .type = T::choice,
             .doc = "The way between keys: spline passes them smoothly, ease rests at each, linear has corners.",
             .fallback = std::string("spline"),
             .choices = {"spline", "ease", "linear"}},
            {.name = "key",
             .type = T::tables,
             .doc = "Poses of a camera that moves; instead of eye and target.",
             .min_count = 0,
             .max_count = 10000,
             .items = {key_schema()}},
        }};
    return schema;
}

Camera::Camera(const Values& values, const FrameTime& frame)
    : path_(read_path(values, frame.fps)),
      frame_seconds_(frame.seconds),
      where_(values.tables("key").empty() ? values.where("eye") : values.tables("key")[0].where("eye"))
{
    if (values.has("hfov") && values.has("vfov")) throw values.problem("vfov", "hfov and vfov exclude each other", "one of them");
    horizontal_ = !values.has("vfov");
    shutter_open_ = shutter_close_ = values.number("shutter_open");
    if (values.has("shutter_close") && values.has("shutter_angle"))
        throw values.problem("shutter_angle", "shutter_angle and shutter_close exclude each other", "one of them");
    if (values.has("shutter_close")) shutter_close_ = values.number("shutter_close");
    if (values.has("shutter_angle")) shutter_close_ += values.number("shutter_angle") / 6.283185307179587 / frame.fps;
    if (shutter_close_ < shutter_open_) throw values.problem("shutter_close", "the shutter closes before it opens");
    still_ = look(path_.at(frame_seconds_ + shutter_open_));
    moves_ = path_.moves(frame_seconds_ + shutter_open_, frame_seconds_ + shutter_close_);
}

Camera::Camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov, bool horizontal)
    : path_(Pose{eye, target, up, fov}), horizontal_(horizontal), still_(look(path_.at(0.0)))
{
}

Camera::View Camera::look(const Pose& pose)
{
    View v;
    v.eye = pose.eye;
    v.forward = (pose.target - pose.eye).normalized();
    v.right = v.forward.cross(pose.up).normalized();
    v.up = v.right.cross(v.forward);
    v.tangent = std::tan(0.5 * pose.fov);
    return v;
}

Vec2d Camera::half_extent(double tangent, const Vec2i& size) const
{
    const double aspect = static_cast<double>(size.x) / static_cast<double>(size.y);
    return horizontal_ ? Vec2d(tangent, tangent / aspect) : Vec2d(tangent * aspect, tangent);
}

Ray Camera::ray(const Vec2d& film, const Vec2i& size, double time) const
{
    const View v = view(time);
    const Vec2d extent = half_extent(v.tangent, size);
    const Vec3d across = v.right * ((2.0 * film.x / size.x - 1.0) * extent.x), upwards = v.up * ((1.0 - 2.0 * film.y / size.y) * extent.y);
    const Vec3d along = v.forward + across + upwards;
    const double length = along.length();
    Ray ray;
    ray.origin = v.eye;
    ray.direction = along / length;
    ray.time = time;
    ray.footprint_spread = 2.0 * extent.x / (size.x * length);  // a pixel's width, seen from the eye at the distance `length`
    ray.crossing = Crossing::entering;
    return ray;
}

Vec2d Camera::project(const Vec3d& p, const Vec2i& size, double time) const
{
    const View v = view(time);
    const Vec2d extent = half_extent(v.tangent, size);
    const Vec3d from = p - v.eye;
    const double depth = from.dot(v.forward);
    if (!(depth > 0.0)) return Vec2d(kInfinity);
    return {0.5 * size.x * (1.0 + from.dot(v.right) / (depth * extent.x)), 0.5 * size.y * (1.0 - from.dot(v.up) / (depth * extent.y))};
}

Imath::M44d Camera::view_matrix() const
{
    const View& v = still_;
    Imath::M44d m;
    for (int k = 0; k < 3; ++k) m[k][0] = v.right[k], m[k][1] = v.up[k], m[k][2] = v.forward[k];
    m[3][0] = -v.eye.dot(v.right), m[3][1] = -v.eye.dot(v.up), m[3][2] = -v.eye.dot(v.forward);
    return m;
}

Imath::M44f Camera::world_to_camera() const
{
    return Imath::M44f(view_matrix());
}

Imath::M44f Camera::world_to_ndc(const Vec2i& size) const
{
    const Vec2d extent = half_extent(still_.tangent, size);
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
