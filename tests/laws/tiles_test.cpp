// One picture, however it is cut and by how many threads it is made; and what a sample tells of its first hit.
#include "tests/support/lit_scenes.h"

#include <gtest/gtest.h>

#include <immintrin.h>

#include <cstring>

namespace hoodoo
{
namespace
{

using testing::lit_parts;
using testing::PlainLook;
using testing::shoot;
using testing::Shot;

/// Rough ground with bent normals under a clear sky and a disc of a sun: every part of the path has its say.
Scene landscape()
{
    const Vec3d sun = compass_direction(0.5, 1.0);
    const auto table = std::make_shared<const SkyTable>(AtmosphereParameters{}, sun, [](const Vec3d& c) { return Vec3f(c); });
    TriangleMesh mesh = testing::ground(20.0f);
    for (float i = -3; i <= 3; ++i) {  // steps that shade each other
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3f& v : {Vec3f(i, -5, 0), Vec3f(i, 5, 0), Vec3f(i, 5, 2), Vec3f(i, -5, 2)}) mesh.vertices.push_back(v);
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    const Camera camera(Vec3d(2, -12, 6), Vec3d(0, 0, 1), Vec3d(0, 0, 1), 1.0, true);
    return Scene(lit_parts(camera, std::move(mesh), {DiscSun(sun, table->sun_irradiance(), 0.00925), ClearSky(table), ConstantSky(Vec3f(0.1f))},
                           std::make_unique<PlainLook>(0.7f, 0.2, 0.5f)),
                 {});
}

/// Whether two pictures have the same bits where both have pixels.
bool same_bits(const Image& whole, const Image& part)
{
    for (const Channel& channel : part.channels) {
        const Channel* other = whole.find(channel.name);
        if (!other) return false;
        for (int y = part.data.y0; y < part.data.y1; ++y) {
            const float* a = &channel.pixels[static_cast<std::size_t>(y - part.data.y0) * static_cast<std::size_t>(part.data.width())];
            const float* b = &other->pixels[static_cast<std::size_t>(y - whole.data.y0) * static_cast<std::size_t>(whole.data.width()) +
                                            static_cast<std::size_t>(part.data.x0 - whole.data.x0)];
            if (std::memcmp(a, b, sizeof(float) * static_cast<std::size_t>(part.data.width())) != 0) return false;
        }
    }
    return true;
}

Shot picture()
{
    Shot shot;
    shot.width = 50, shot.height = 38, shot.data = {0, 50, 0, 38};
    shot.samples = 20;
    shot.replicates = 2;
    return shot;
}

TEST(Tiles, threads_and_tile_sizes_do_not_change_a_bit)
{
    const Scene scene = landscape();
    const Image one = shoot(scene, picture());
    for (const int threads : {1, 2, 3}) {
        for (const int size : {7, 32}) {
            Shot shot = picture();
            shot.threads = threads, shot.tile_size = size;
            EXPECT_TRUE(same_bits(one, shoot(scene, shot))) << threads << " threads, tiles of " << size;
        }
    }
}

TEST(Tiles, a_crop_equals_the_same_pixels_of_the_full_picture)
{
    const Scene scene = landscape();
    Shot shot = picture();
    const Image full = shoot(scene, shot);
    shot.data = {11, 33, 5, 30};
    EXPECT_TRUE(same_bits(full, shoot(scene, shot)));
}

TEST(Tiles, another_seed_is_another_picture_so_the_comparison_can_fail)
{
    const Scene scene = landscape();
    Shot shot = picture();
    const Image one = shoot(scene, shot);
    shot.path.seed = 1;
    EXPECT_FALSE(same_bits(one, shoot(scene, shot)));
}

TEST(Tiles, the_callers_floating_point_state_is_left_alone)
{
    const Scene scene = landscape();
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before & ~0x8040u);
    Shot shot = picture();
    shot.threads = 2;
    shoot(scene, shot);
    EXPECT_EQ(_mm_getcsr() & 0x8040u, 0u);
    _mm_setcsr(before);
}

TEST(Tiles, progress_reaches_one_and_cancel_stops)
{
    const Scene scene = landscape();
    FilmLayout layout;
    layout.width = 64, layout.height = 64, layout.data = {0, 64, 0, 64}, layout.samples = 1;
    layout.materials = scene.material_names();
    TileSettings tiles;
    tiles.threads = 2, tiles.tile_size = 16;
    std::vector<double> seen;
    tiles.progress = [&](double fraction) { seen.push_back(fraction); };
    Film film(layout);
    EXPECT_TRUE(trace_tiles(scene, {}, tiles, film));
    ASSERT_EQ(seen.size(), 16u);
    EXPECT_EQ(seen.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));

    const std::atomic<bool> cancel{true};
    tiles.cancel = &cancel;
    seen.clear();
    EXPECT_FALSE(trace_tiles(scene, {}, tiles, film));
    EXPECT_TRUE(seen.empty());
}

TEST(Tiles, no_ray_is_refused_and_no_sample_dropped)
{
    const Scene scene = landscape();
    FilmLayout layout;
    layout.width = 50, layout.height = 38, layout.data = {0, 50, 0, 38}, layout.samples = 16;
    layout.materials = scene.material_names();
    Film film(layout);
    trace_tiles(scene, PathSettings{}, TileSettings{}, film);
    EXPECT_EQ(film.dropped_samples(), 0u);
    EXPECT_EQ(scene.tracer().refused_rays(), 0u);
}

TEST(Path, a_sample_tells_of_its_first_hit)
{
    const Camera camera(Vec3d(0, 0, 10), Vec3d(0, 0, 0), Vec3d(0, 1, 0), 0.5, true);
    const Scene scene(lit_parts(camera, testing::ground(), {ConstantSky(Vec3f(2.0f))}, std::make_unique<PlainLook>(0.25f)), {});
    Sampler sampler(1, 0, Vec2i(0, 0), 0);
    sampler.start(0);
    std::vector<float> shares(1);
    const Ray down = camera.ray(Vec2d(8, 8), Vec2i(16, 16), 0.0);
    const PixelSample hit = trace_path(scene, {}, down, sampler, shares);
    EXPECT_EQ(hit.alpha, 1.0f);
    EXPECT_FLOAT_EQ(hit.z, 10.0f);
    EXPECT_EQ(hit.object, 1u);
    EXPECT_EQ(hit.albedo, Vec3f(0.25f));
    EXPECT_EQ(hit.geometric_normal, Vec3f(0, 0, 1));
    ASSERT_EQ(hit.materials.size(), 1u);
    EXPECT_EQ(hit.materials[0], 1.0f);
    EXPECT_FLOAT_EQ(hit.radiance.x, 0.5f);

    Ray up = down;
    up.direction = Vec3d(0, 0, 1);
    const PixelSample miss = trace_path(scene, {}, up, sampler, shares);
    EXPECT_EQ(miss.alpha, 0.0f);
    EXPECT_TRUE(std::isinf(miss.z));
    EXPECT_EQ(miss.object, 0u);
    EXPECT_EQ(miss.radiance, Vec3f(2.0f));
}

TEST(Path, both_sides_of_a_mesh_are_lit)
{
    const Camera camera(Vec3d(0, 0, -10), Vec3d(0, 0, 0), Vec3d(0, 1, 0), 0.5, true);
    const Scene scene(lit_parts(camera, testing::ground(), {ConstantSky(Vec3f(2.0f))}, std::make_unique<PlainLook>(0.25f, 0.3)), {});
    EXPECT_NEAR(testing::mean(shoot(scene, {}), "R"), 0.5, 1e-6);
}

TEST(Scene, a_camera_inside_matter_is_an_error)
{
    const Camera camera(Vec3d(0, 0, -3), Vec3d(0, 0, 0), Vec3d(0, 1, 0), 0.5, true);
    try {
        const Scene scene(lit_parts(camera, std::make_unique<testing::Cave>(0.5), {}, std::make_unique<PlainLook>(0.25f)), {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::scene);
        EXPECT_STREQ(error.what(), "the camera stands inside the terrain \"thing\", expected an eye in air or water");
    }
}

TEST(Scene, materials_are_blended_by_their_shares)
{
    const Camera camera(Vec3d(0, 0, 10), Vec3d(0, 0, 0), Vec3d(0, 1, 0), 0.5, true);
    TriangleMesh a = testing::ground(), b = testing::ground();
    b.material = "moss";
    SceneParts parts = lit_parts(camera, std::move(a), {}, std::make_unique<PlainLook>(0.2f));
    parts.objects.push_back({"other", "test", {}, {}});
    parts.shapes.push_back(std::move(b));
    parts.looks["moss"] = std::make_unique<PlainLook>(0.6f, 0.0, 1.0f);
    const Scene scene(std::move(parts), {});
    EXPECT_EQ(scene.material_names(), (std::vector<std::string>{"wall", "moss"}));
    Interaction at;
    at.materials.add(0, 1.0f);
    EXPECT_EQ(scene.appearance(0, at, 0.1).albedo, Vec3f(0.2f));
    EXPECT_EQ(scene.appearance(1, at, 0.1).albedo, Vec3f(0.6f));
    at.materials = {};
    at.materials.add(0, 0.25f);
    at.materials.add(0, 0.75f);
    EXPECT_NEAR(scene.appearance(1, at, 0.1).albedo.x, 0.6f, 1e-6);
    EXPECT_NEAR(scene.appearance(1, at, 0.1).roughness, 1.0f, 1e-6);
}

}  // namespace
}  // namespace hoodoo
