// A scene that was edited is the scene that was loaded with those edits.
#include "renderer/edit.h"
#include "tests/edits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

namespace hoodoo
{
namespace
{

const std::string kScene = R"(version = 1
seed = 4
[camera]
eye = [-9, 6, 17]
target = [14, 14, 3]
hfov = "60 deg"
[film]
width = 40
height = 32
[render]
spp = 4
[light.sun]
type = "sky"
elevation = "40 deg"
azimuth = "200 deg"
[terrain.ground]
type = "convolution"
columns = [56, 48]
cell = 0.5
unit = 0.002
sigma_cells = 1.0
rock_size = 0.8
rock_detail = 2
[[terrain.ground.layer]]
shape = "fractal"
height = 4.0
relief = 2.0
wavelength = 20.0
)";

struct Edit {
    std::string tool, text;
    Node parameters;
};

/// Sand, rocks where there were none, a pit, water in it, a heap on the rocks.
std::vector<Edit> edits()
{
    using testing::list, testing::table;
    return {
        {"deposit", "points = [[8, 8, 6], [18, 12, 6]]\nradius = [3]\nmaterial = \"rock\"\namount = \"0.6 m\"",
         table({{"points", list({{8., 8., 6.}, {18., 12., 6.}})}, {"radius", {3.}}, {"material", "rock"}, {"amount", 0.6}})},
        {"sculpt", "target = [14, 16, 5]\nradius = 4\nstrokes = 3\nscatter = 1.5\nmode = \"carve\"",
         table({{"target", {14., 16., 5.}}, {"radius", 4.}, {"strokes", 3.}, {"scatter", 1.5}, {"mode", "carve"}})},
        {"fill", "seed = [14, 16, 4.2]\nlevel = 4.4", table({{"seed", {14., 16., 4.2}}, {"level", 4.4}})},
        {"sculpt", "target = [10, 9, 6]\nradius = 2", table({{"target", {10., 9., 6.}}, {"radius", 2.}})},
    };
}

/// Of the channels that both have, the first pixel that differs; empty: none.
std::string difference(const Image& a, const Image& b)
{
    int compared = 0;
    for (const Channel& channel : a.channels) {
        const Channel* other = b.find(channel.name);
        if (!other || channel.name == "cost.Y") continue;  // the trees are others, what is met is not
        ++compared;
        if (std::memcmp(channel.pixels.data(), other->pixels.data(), channel.pixels.size() * sizeof(float)) != 0) return channel.name;
    }
    return compared >= 8 ? "" : "channels";
}

TEST(EditScene, makes_the_pictures_of_a_scene_loaded_with_its_edits)
{
    LoadedScene living = load_scene(kScene, true, {}, 0, {}, {}, true);
    std::string text = kScene;
    Image before = render(living, {});
    EXPECT_EQ(living.scene->objects()[0].info.rocks.instances, 0u);
    for (const Edit& edit : edits()) {
        const ColumnSet changed = edit_scene(living, "", edit.tool, edit.parameters);
        EXPECT_FALSE(changed.empty()) << edit.tool;
        text += fmt::format("[[terrain.ground.edit]]\ntool = \"{}\"\n{}\n", edit.tool, edit.text);
        const Image now = render(living, {});
        EXPECT_EQ(difference(now, render(load_scene(text, true, {}, 0, {}, {}, true), {})), "") << edit.tool;
        EXPECT_EQ(difference(now, render(load_scene(text, true), {})), "") << edit.tool;
        EXPECT_NE(difference(now, before), "") << edit.tool << ": a scene that follows nothing would not be noticed";
        before = now;
    }
    const SurfaceInfo info = living.scene->objects()[0].info, fresh = load_scene(text, true).scene->objects()[0].info;
    EXPECT_GT(info.rocks.instances, 50u);
    EXPECT_EQ(info.rocks.instances, fresh.rocks.instances);
    EXPECT_EQ(info.layers, fresh.layers);
}

TEST(EditScene, changes_the_name_that_pictures_carry)
{
    LoadedScene living = load_scene(kScene, true, {}, 0, {}, {}, true), other = load_scene(kScene, true, {}, 0, {}, {}, true);
    const std::string before = picture_key(living.description, {});
    edit_scene(living, "ground", edits()[1].tool, edits()[1].parameters);
    EXPECT_NE(picture_key(living.description, {}), before);
    edit_scene(other, "ground", edits()[1].tool, edits()[1].parameters);
    EXPECT_EQ(picture_key(living.description, {}), picture_key(other.description, {}));
}

TEST(EditScene, refuses_what_cannot_be_edited)
{
    const Node stroke = testing::table({{"target", {14., 16., 5.}}, {"radius", 4.}});
    LoadedScene still = load_scene(kScene, true);
    EXPECT_EQ(testing::error_of([&] { edit_scene(still, "", "sculpt", stroke); }),
              "<text>:16:1: this scene was not loaded for edits, expected a scene loaded with editable = true\n    [terrain.ground]\n    ^");
    LoadedScene living = load_scene(kScene + "[terrain.sea]\ntype = \"plane\"\n", true, {}, 0, {}, {}, true);
    EXPECT_EQ(testing::error_of([&] { edit_scene(living, "", "sculpt", stroke); }),
              "<text>: the scene has 2 terrains: say which, expected one of ground, sea");
    EXPECT_EQ(testing::error_of([&] { edit_scene(living, "sea", "sculpt", stroke); }),
              "<text>:29:1: the terrain \"sea\" cannot be edited, expected type = \"convolution\", and no other terrain that stands on it\n    "
              "[terrain.sea]\n    ^");
    const Image before = render(living, {});
    EXPECT_NE(testing::error_of([&] { edit_scene(living, "ground", "sculpt", testing::table({{"target", {14., 16., 5.}}, {"radius", -4.}})); }), "");
    EXPECT_NE(testing::error_of([&] { edit_scene(living, "ground", "sculpt", testing::table({{"target", {900., 16., 5.}}, {"radius", 4.}})); }), "");
    EXPECT_EQ(difference(before, render(living, {})), "");
}

TEST(EditScene, says_so_if_the_camera_is_buried)
{
    LoadedScene living =
        load_scene(kScene, true, {{}, {{"camera.eye", "[14, 14, 9]"}, {"camera.target", "[20, 20, 3]"}}, {}, {}, {}}, 0, {}, {}, true);
    const Node heap = testing::table({{"points", testing::list({{14., 14., 9.}})}, {"radius", {2.}}, {"mode", "add"}});
    const std::string error = testing::error_of([&] { edit_scene(living, "", "sweep", heap); });
    EXPECT_NE(error.find("the camera stands inside the terrain \"ground\""), std::string::npos) << error;
}

}  // namespace
}  // namespace hoodoo
