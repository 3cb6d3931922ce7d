// Rocks on a terrain that is warped go with it.
#include "renderer/render.h"
#include "terrain/field.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

/// Uneven ground with a bed of rocks on it, alone or turned by a quarter about an axis that is not upright.
std::string scene(bool warped)
{
    std::string text = R"(version = 1
[camera]
eye = [-40, 0, 40]
target = [8, 8, 2]
[terrain.ground]
type = "convolution"
columns = [32, 32]
cell = 0.5
rock_size = 1.1
rock_detail = 3
[[terrain.ground.layer]]
shape = "fractal"
height = 3.0
relief = 1.5
wavelength = 12.0
[[terrain.ground.layer]]
shape = "flat"
thickness = 0.8
material = "rock"
)";
    if (warped)
        text +=
            "[terrain.turned]\ntype = \"warped\"\nbase = \"ground\"\nintensity = 1.5707963267948966\npatch = 1.0\n"
            "[[terrain.turned.flow]]\nkind = \"rotation\"\ncentre = [8, 8, 2]\naxis = [0.2, 0.1, 1]\n";
    return text;
}

TEST(WarpedRocks, lie_where_the_ground_under_them_went)
{
    const LoadedScene still = load_scene(scene(false), true), turned = load_scene(scene(true), true);
    ASSERT_EQ(turned.scene->shapes().size(), 1u);
    const Instances *before = instances_of(still.scene->shapes()[0]), *after = instances_of(turned.scene->shapes()[0]);
    ASSERT_NE(before, nullptr);
    ASSERT_NE(after, nullptr);
    ASSERT_EQ(before->instances.size(), after->instances.size());
    ASSERT_GT(before->instances.size(), 100u);
    const Field& ground = *std::get<std::unique_ptr<Surface>>(still.scene->shapes()[0])->field();
    const Field& warped = *std::get<std::unique_ptr<Surface>>(turned.scene->shapes()[0])->field();
    double farthest = 0.0;
    for (std::size_t k = 0; k < before->instances.size(); ++k) {
        // As deep in the warped ground as it was in the ground at rest; and the rotation carried it with the other rocks as one body.
        const Vec3d p = before->instances[k].position, q = after->instances[k].position;
        EXPECT_NEAR(warped.value(q), ground.value(p), 1e-6);
        EXPECT_NEAR((q - after->instances[0].position).length(), (p - before->instances[0].position).length(), 1e-6);
        EXPECT_EQ(before->instances[k].id, after->instances[k].id);
        farthest = std::max(farthest, (p - q).length());
    }
    EXPECT_GT(farthest, 8.0);  // a rock left where it was would not move
    // A ray down onto a rock meets it, with the material that the base calls rock.
    int met = 0;
    for (const Instance& rock : after->instances) {
        Ray ray;
        ray.origin = rock.position + Vec3d(0, 0, 30);
        ray.direction = Vec3d(0, 0, -1);
        const TraceHit hit = turned.scene->tracer().intersect(ray);
        if (!hit.valid || hit.instance == kNoInstance) continue;
        const Interaction at = turned.scene->tracer().interact(ray, hit);
        EXPECT_EQ(turned.scene->material_names()[turned.scene->objects()[0].materials[at.materials.index[0]]], "rock");
        ++met;
    }
    EXPECT_GT(met, 50);
}

}  // namespace
}  // namespace hoodoo
