// The pinhole: where pixels look, and that the matrices of the header say the same as the rays.
#include "renderer/scene/camera.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

Node number(double x)
{
    return Node{x, {}, {}};
}
Node vector(double x, double y, double z)
{
    return Node{Node::Array{number(x), number(y), number(z)}, {}, {}};
}

/// A [camera] table with the entries given.
Values camera_values(Node::Table table)
{
    std::vector<Problem> problems;
    const Values values = check(camera_schema(), Node{std::move(table), {}, {}}, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    return values;
}

std::string problem_of(Node::Table table)
{
    try {
        Camera camera(camera_values(std::move(table)));
        return "none";
    } catch (const Error& error) {
        return error.problems().front().what;
    }
}

TEST(Camera, the_middle_of_the_picture_is_the_target_and_corners_follow_the_field_of_view)
{
    const Camera camera(Vec3d(1, 2, 3), Vec3d(1, 7, 3), Vec3d(0, 0, 1), kPi / 2, true);
    const Vec2i size(200, 100);
    const Ray middle = camera.ray(Vec2d(100, 50), size, 0.25);
    EXPECT_EQ(middle.origin, Vec3d(1, 2, 3));
    EXPECT_NEAR((middle.direction - Vec3d(0, 1, 0)).length(), 0.0, 1e-15);
    EXPECT_EQ(middle.time, 0.25);
    EXPECT_EQ(middle.crossing, Crossing::entering);
    // hfov 90 deg: the left edge is 45 degrees off; the top edge, at half the height, atan(1/2).
    EXPECT_NEAR((camera.ray(Vec2d(0, 50), size, 0).direction - Vec3d(-1, 1, 0).normalized()).length(), 0.0, 1e-15);
    EXPECT_NEAR((camera.ray(Vec2d(100, 0), size, 0).direction - Vec3d(0, 1, 0.5).normalized()).length(), 0.0, 1e-15);
}

TEST(Camera, a_vertical_field_of_view_spans_the_height)
{
    const Camera camera(Vec3d(0.0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), kPi / 2, false);
    EXPECT_NEAR((camera.ray(Vec2d(100, 0), Vec2i(200, 100), 0).direction - Vec3d(0, 1, 1).normalized()).length(), 0.0, 1e-15);
    EXPECT_NEAR((camera.ray(Vec2d(200, 50), Vec2i(200, 100), 0).direction - Vec3d(2, 1, 0).normalized()).length(), 0.0, 1e-15);
}

TEST(Camera, the_footprint_is_the_width_of_a_pixel)
{
    const Camera camera(Vec3d(0.0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), kPi / 2, true);
    const Vec2i size(1000, 1000);
    const Ray a = camera.ray(Vec2d(500, 500), size, 0), b = camera.ray(Vec2d(501, 500), size, 0);
    EXPECT_NEAR(a.footprint(10.0), (a.at(10.0) - b.at(10.0)).length(), 1e-4 * a.footprint(10.0));
}

TEST(Camera, matrices_say_the_same_as_rays)
{
    const Camera camera(Vec3d(10, -20, 30), Vec3d(12, 5, 20), Vec3d(0.1, 0, 1), 0.8, true);
    const Vec2i size(640, 360);
    for (const Vec2d& film : {Vec2d(0.5, 0.5), Vec2d(320, 180), Vec2d(600, 33)}) {
        const Vec3d p = camera.ray(film, size, 0).at(17.0);
        Imath::V3f seen, ndc;
        camera.world_to_camera().multVecMatrix(Imath::V3f(p), seen);
        camera.world_to_ndc(size).multVecMatrix(Imath::V3f(p), ndc);
        EXPECT_NEAR(seen.z, camera.depth(p, 0.0), 1e-5);
        EXPECT_NEAR(ndc.x, film.x / size.x, 1e-5);
        EXPECT_NEAR(ndc.y, film.y / size.y, 1e-5);
        EXPECT_NEAR(ndc.z, 1.0 - 1.0 / camera.depth(p, 0.0), 1e-5);
    }
}

/// Keys at 0, 1, 3 seconds along x.
std::vector<CameraPath::Key> keys_along_x()
{
    const auto key = [](double time, double x) { return CameraPath::Key{time, Pose{Vec3d(x, 0, 0), Vec3d(x, 1, 0), Vec3d(0, 0, 1), 0.8}}; };
    return {key(0, 0), key(1, 2), key(3, 3)};
}

TEST(CameraPath, goes_through_its_keys_and_holds_its_ends)
{
    for (const Easing easing : {Easing::spline, Easing::ease, Easing::linear}) {
        const CameraPath path(keys_along_x(), easing);
        for (const CameraPath::Key& key : keys_along_x()) EXPECT_NEAR(path.at(key.time).eye.x, key.pose.eye.x, 1e-15);
        EXPECT_EQ(path.at(-5).eye.x, 0.0);
        EXPECT_EQ(path.at(5).eye.x, 3.0);
    }
}

TEST(CameraPath, eases_as_it_is_told)
{
    const auto speed = [](Easing easing, double t) {
        const CameraPath path(keys_along_x(), easing);
        return (path.at(t + 1e-6).eye.x - path.at(t - 1e-6).eye.x) / 2e-6;
    };
    EXPECT_NEAR(speed(Easing::linear, 0.25), 2.0, 1e-6);
    EXPECT_NEAR(speed(Easing::ease, 1.0), 0.0, 1e-4);
    EXPECT_NEAR(speed(Easing::ease, 0.5), 3.0, 1e-4);                                         // 6 u (1 - u) times 2
    EXPECT_NEAR(speed(Easing::spline, 1.0), 1.0, 1e-4);                                       // (3 - 0) / (3 - 0): the neighbours' quotient
    EXPECT_NEAR(speed(Easing::spline, 1.0 - 1e-3), speed(Easing::spline, 1.0 + 1e-3), 2e-2);  // C1
}

TEST(CameraPath, knows_when_it_stands)
{
    auto keys = keys_along_x();
    keys[1].pose = keys[0].pose;
    EXPECT_FALSE(CameraPath(keys, Easing::linear).moves(0.0, 1.0));
    EXPECT_TRUE(CameraPath(keys, Easing::linear).moves(0.5, 1.5));
    EXPECT_TRUE(CameraPath(keys, Easing::spline).moves(0.0, 1.0));  // it starts towards the third key
    EXPECT_FALSE(CameraPath(keys, Easing::linear).moves(2.0, 2.0));
    EXPECT_FALSE(CameraPath(keys, Easing::spline).moves(3.0, 9.0));
}

TEST(Camera, contradictions_are_named)
{
    const auto eye = std::pair{std::string("eye"), vector(0, 0, 5)};
    EXPECT_EQ(problem_of({eye, {"target", vector(0, 9, 5)}}), "none");
    EXPECT_EQ(problem_of({eye, {"target", vector(0, 0, 5)}}), "target and eye are the same point");
    EXPECT_EQ(problem_of({eye, {"target", vector(0, 0, 9)}}), "up is zero or lies along the view");
    EXPECT_EQ(problem_of({eye, {"target", vector(0, 9, 5)}, {"hfov_deg", number(40)}, {"vfov_deg", number(40)}}), "hfov and vfov exclude each other");
    EXPECT_EQ(problem_of({eye, {"target", vector(0, 9, 5)}, {"shutter_open", number(0.5)}, {"shutter_close", number(0.25)}}),
              "the shutter closes before it opens");
}

}  // namespace
}  // namespace hoodoo
