// Motion over the picture, against numbers derived from the pinhole: x / z times half the width over the tangent of half the field of view.
#include "renderer/transport/motion.h"

#include "renderer/scene/read.h"
#include "renderer/scene/scene.h"
#include "renderer/transport/path.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

Interaction seen_at(const Vec3d& p, const Vec3d& velocity)
{
    Interaction at;
    at.position = p;
    at.velocity = velocity;
    return at;
}

TEST(Motion, a_point_before_a_still_camera_moves_by_its_velocity_over_its_depth)
{
    // Looks along +y, hfov 90 deg: tangent 1, so a metre at a depth of 10 m is 100 / 10 = 10 pixels of a picture 200 wide; up is -y.
    const Camera camera(Vec3d(0.0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), kPi / 2, true);
    const Vec2f moved = picture_motion(camera, seen_at({1, 10, 2}, {0.5, 0, -0.25}), 0.3, {200, 100});
    EXPECT_FLOAT_EQ(moved.x, 5.0f);
    EXPECT_FLOAT_EQ(moved.y, 2.5f);
    // Towards the eye: from a depth of 12 (at the opening) to 8 (at the closing), seen half way; x = 2 m: 100 * (2 / 8 - 2 / 12) = 8.3333.
    EXPECT_NEAR(picture_motion(camera, seen_at({2, 10, 0}, {0, -4, 0}), 0.5, {200, 100}).x, 100.0 * (2.0 / 8.0 - 2.0 / 12.0), 1e-4);
}

TEST(Motion, is_nothing_where_nothing_moves_and_where_the_eye_is_passed)
{
    const Camera camera(Vec3d(0.0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), kPi / 2, true);
    EXPECT_EQ(picture_motion(camera, seen_at({1, 10, 2}, Vec3d(0.0)), 0.5, {200, 100}), Vec2f(0.0f));
    EXPECT_EQ(picture_motion(camera, seen_at({1, 1, 0}, {0, -4, 0}), 0.5, {200, 100}), Vec2f(0.0f));
    EXPECT_EQ(picture_motion(camera, seen_at({1, 10, 2}, {1, 0, 0}), 0.5, {0, 0}), Vec2f(0.0f));
}

TEST(Motion, a_point_projects_to_the_pixel_whose_ray_meets_it)
{
    const Camera camera(Vec3d(1, 2, 3), Vec3d(4, 9, 1), Vec3d(0, 0, 1), 0.8, false);
    const Vec2d film(37.25, 81.5);
    const Vec2d back = camera.project(camera.ray(film, {160, 90}, 0.0).at(7.0), {160, 90}, 0.0);
    EXPECT_NEAR(back.x, film.x, 1e-9);
    EXPECT_NEAR(back.y, film.y, 1e-9);
}

/// The motion of the middle pixel of a scene 200 x 100 that is looked at straight down from 10 m.
Vec2f middle_motion(const std::string& camera, const std::string& terrain)
{
    const std::string text =
        "version = 1\n[film]\nwidth = 200\nheight = 100\nfps = 10\n[camera]\nup = [0, 1, 0]\nhfov = \"90 deg\"\n" + camera + terrain;
    const Scene scene(read_scene(text, true, {}), {});
    PathSettings settings;
    settings.size = {200, 100};
    std::vector<float> shares(scene.material_names().size());
    return trace_path(scene, settings, scene.camera().ray({100, 50}, settings.size, 0.5), Sampler(1, 0, {100, 50}, 0), shares).motion;
}

TEST(Motion, still_ground_moves_under_a_camera_that_flies)
{
    // 2 m in a frame of 0.1 s, the shutter open for half of it: 1 m to +x at a height of 10 m moves the ground 100 / 10 = 10 pixels to the left.
    const Vec2f moved = middle_motion(
        "shutter_angle = \"180 deg\"\n[[camera.key]]\nframe = 0\neye = [0, 0, 10]\ntarget = [0, 0, 0]\n[[camera.key]]\nframe = 10\n"
        "eye = [20, 0, 10]\ntarget = [20, 0, 0]\n",
        "[terrain.ground]\ntype = \"plane\"\n");
    EXPECT_NEAR(moved.x, -10.0, 1e-3);
    EXPECT_NEAR(moved.y, 0.0, 1e-3);
}

TEST(Motion, of_a_wave_is_its_surface_across_itself)
{
    // A swell rises under the camera: no motion to the side where it is level. On its flank the surface z = a cos(k x - w t) of slope s = -a k sin()
    // moves across itself by w a sin() n_z n: to the side -w a sin() s / (1 + s^2) in a second.
    const std::string sea =
        "[terrain.sea]\ntype = \"breaking_wave\"\nripples = 0\nextent = 40\n[[terrain.sea.swell]]\nwavelength = 10\nheight = 0.4\nheading_deg = "
        "0\nphase_deg = 90\n";
    const Vec2f moved = middle_motion("eye = [0, 0, 10]\ntarget = [0, 0, 0]\nshutter_close = \"20 ms\"\n", sea);
    // phase + k x - w t at x = 0, t = 0.01 s.
    const double k = 2.0 * kPi / 10.0, w = std::sqrt(9.81 * k), angle = kPi / 2 - w * 0.01, height = 0.2 * std::cos(angle);
    const double slope = -0.2 * k * std::sin(angle), rise = 0.2 * w * std::sin(angle);
    const Vec2d velocity = Vec2d(-slope, 1.0) * (rise / (1.0 + slope * slope)) * 0.02;  // x and z, in the time the shutter is open
    const double before = 100.0 * (-0.5 * velocity.x) / (10.0 - height + 0.5 * velocity.y);
    const double after = 100.0 * (0.5 * velocity.x) / (10.0 - height - 0.5 * velocity.y);
    EXPECT_NEAR(moved.x, after - before, 1e-4);
    EXPECT_GT(std::abs(moved.x), 0.01);
    EXPECT_NEAR(moved.y, 0.0, 1e-6);
}

}  // namespace
}  // namespace hoodoo
