#include "renderer/scene/read.h"
#include "terrain/math/hash.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

using namespace hoodoo;
namespace fs = std::filesystem;

namespace
{

const std::string camera = "[camera]\neye = [0, 0, 2]\ntarget = [0, 10, 2]\n";
const std::string minimal = "version = 1\n" + camera;

/// A folder of its own for each test, gone afterwards.
class SceneRead : public ::testing::Test
{
protected:
    void SetUp() override
    {
        std::string name = (fs::temp_directory_path() / "hoodoo_read_XXXXXX").string();
        folder = fs::canonical(::mkdtemp(name.data()));
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string write(const std::string& name, const std::string& text) const
    {
        const fs::path path = folder / name;
        fs::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << text;
        return path.string();
    }

    fs::path folder;
};

Description from_text(const std::string& text, const SceneOverrides& overrides = {})
{
    return read_scene(text, true, overrides);
}

/// The error's text and kind, or "no error".
struct Failure {
    std::string text = "no error";
    ErrorKind kind = ErrorKind::internal;
};

template <class Call>
Failure failure_of(Call call)
{
    try {
        call();
    } catch (const Error& error) {
        return {error.what(), error.kind()};
    }
    return {};
}

std::string error_of(const std::string& text, const SceneOverrides& overrides = {})
{
    return failure_of([&] { from_text(text, overrides); }).text;
}

bool says(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_F(SceneRead, the_smallest_scene_has_all_defaults)
{
    const Description scene = from_text(minimal);
    EXPECT_EQ(scene.film.integer("width"), 1024);
    EXPECT_EQ(scene.film.integer("height"), 576);
    EXPECT_EQ(scene.film.text("filter"), "blackman-harris");
    EXPECT_FALSE(scene.film.has("filter_width"));
    EXPECT_EQ(scene.render.integer("spp"), 64);
    EXPECT_EQ(scene.render.integer("max_depth"), 8);
    EXPECT_EQ(scene.camera.vec3("target"), Vec3d(0, 10, 2));
    EXPECT_EQ(scene.file, "<text>");
    EXPECT_EQ(scene.seed, 0u);
}

TEST_F(SceneRead, nodes_are_named_typed_and_seeded_from_the_scenes_seed_and_their_name)
{
    const Description scene = from_text("version = 1\nseed = 7\n" + camera +
                                        "[terrain.floor]\ntype = \"plane\"\n[terrain.wall]\ntype = \"plane\"\nseed = 3\n"
                                        "[material.sand]\n[light.sun]\ntype = \"sun\"\nelevation = \"30 deg\"\n");
    ASSERT_EQ(scene.terrains.size(), 2u);
    EXPECT_EQ(scene.terrains[0].name, "floor");
    EXPECT_EQ(scene.terrains[0].type, "plane");
    EXPECT_EQ(scene.terrains[0].seed, hash_name(7, "floor"));
    EXPECT_EQ(scene.terrains[1].seed, 3u);
    EXPECT_EQ(scene.materials.at(0).name, "sand");
    EXPECT_NEAR(scene.lights.at(0).values.number("elevation"), 0.52359877559829887, 1e-15);  // pi / 6
    SceneOverrides other;
    other.seed = 8;
    EXPECT_EQ(from_text(minimal + "[terrain.floor]\ntype = \"plane\"\n", other).terrains[0].seed, hash_name(8, "floor"));
}

TEST_F(SceneRead, all_problems_are_reported_at_once_in_the_order_of_the_file)
{
    const std::string text =
        error_of("version = 1\ncolour = 3\n" + camera + "hfov = 40\n[film]\nwidht = 3\nheight = 0\n[terrain.a]\ntype = \"plan\"\n[terrain.b]\n");
    EXPECT_EQ(text.substr(0, text.find('\n')), "<text>:2:1: unknown key \"colour\" in the scene");
    const std::vector<std::string> parts{"<text>:6:8: hfov is an angle without a unit",
                                         "<text>:8:1: unknown key \"widht\" in film (did you mean \"width\")",
                                         "<text>:9:10: height is out of range",
                                         "<text>:11:8: type has an unknown value",
                                         "(did you mean \"plane\")",
                                         "<text>:12:1: terrain.b lacks the key \"type\""};
    std::size_t at = 0;
    for (const std::string& part : parts) {
        const std::size_t found = text.find(part, at);
        ASSERT_NE(found, std::string::npos) << part << "\nnot in order in\n" << text;
        at = found;
    }
}

TEST_F(SceneRead, a_syntax_error_has_its_place_and_a_caret)
{
    const std::string text = error_of("version = 1\n[camera\neye = 3\n");
    EXPECT_TRUE(text.starts_with("<text>:2:8: ")) << text;
    EXPECT_TRUE(text.ends_with("\n    [camera\n           ^")) << text;
}

TEST_F(SceneRead, the_version_is_needed_and_known)
{
    EXPECT_TRUE(says(error_of(camera), "<text>:1:1: the scene lacks the key \"version\", expected version = 1"));
    EXPECT_TRUE(says(error_of("version = 2\n" + camera), "<text>:1:11: this version of the format is unknown, expected version = 1, got 2"));
    EXPECT_TRUE(says(error_of("version = \"1\"\n" + camera), "got \"1\""));
    EXPECT_NE(error_of(""), "no error");
}

TEST_F(SceneRead, parameters_are_inserted_with_their_type_and_computed_with)
{
    const std::string text =
        "version = 1\n[params]\nh = 2.5\nn = \"= 4 * h\"\nsize = [640, 480]\nplace = [1, 2, \"= h\"]\n"
        "[camera]\neye = \"${place}\"\ntarget = [0, \"= n\", \"${h}\"]\n[render]\nspp = \"= n * 2\"\n";
    const Description scene = from_text(text);
    EXPECT_EQ(scene.camera.vec3("eye"), Vec3d(1, 2, 2.5));
    EXPECT_EQ(scene.camera.vec3("target"), Vec3d(0, 10, 2.5));
    EXPECT_EQ(scene.render.integer("spp"), 20);
    SceneOverrides overrides;
    overrides.params = {{"h", "3"}};
    EXPECT_EQ(from_text(text, overrides).render.integer("spp"), 24);
    overrides.params = {{"h", "= 1 + 1"}};
    EXPECT_EQ(from_text(text, overrides).render.integer("spp"), 16);
}

TEST_F(SceneRead, frame_and_t_are_known_everywhere)
{
    const std::string text = "version = 1\n[camera]\neye = [\"= 10 * t\", \"= frame\", 2]\ntarget = [0, 10, 2]\n";
    EXPECT_EQ(from_text(text).camera.vec3("eye"), Vec3d(0, 0, 2));
    SceneOverrides overrides;
    overrides.params = {{"frame", "24"}, {"t", "0.5"}};
    EXPECT_EQ(from_text(text, overrides).camera.vec3("eye"), Vec3d(5, 24, 2));
}

TEST_F(SceneRead, an_unknown_parameter_on_the_command_line_is_an_error)
{
    SceneOverrides overrides;
    overrides.params = {{"heigth", "3"}};
    EXPECT_EQ(error_of("version = 1\n[params]\nheight = 2\n" + camera, overrides),
              "-D:1:1: the scene has no parameter \"heigth\" (did you mean \"height\")\n    heigth=3\n    ^");
}

TEST_F(SceneRead, expressions_and_insertions_that_fail_show_where_and_only_once)
{
    const std::string text =
        error_of("version = 1\n[params]\nheight = 2\n[camera]\neye = [0, 0, \"= 2 * heigth\"]\ntarget = \"${place}\"\nhfov = \"about ${height}\"\n");
    EXPECT_EQ(text,
              "<text>:5:21: unknown name in the expression, got \"heigth\" (did you mean \"height\")\n"
              "    eye = [0, 0, \"= 2 * heigth\"]\n"
              "                        ^\n"
              "<text>:6:10: unknown parameter \"place\"\n"
              "    target = \"${place}\"\n"
              "             ^\n"
              "<text>:7:8: a parameter stands alone in its text, expected \"${name}\", got \"about ${height}\"\n"
              "    hfov = \"about ${height}\"\n"
              "           ^");
}

TEST_F(SceneRead, a_parameter_that_failed_is_not_reported_where_it_is_used)
{
    const std::string text =
        error_of("version = 1\n[params]\na = \"= 1 +\"\nb = \"= a + 1\"\n[camera]\neye = [\"= b\", \"${a}\", 0]\ntarget = [0, 1, 0]\n");
    EXPECT_EQ(text.substr(0, text.find('\n')), "<text>:3:11: the expression ends too early");
    EXPECT_EQ(text.find("<text>", 1), std::string::npos) << text;
}

TEST_F(SceneRead, set_replaces_values_and_gives_new_ones)
{
    SceneOverrides overrides;
    overrides.sets = {
        {"film.width", "320"}, {"camera.eye", "[1, 2, 3]"}, {"camera.target.1", "20"}, {"terrain.floor.material", "sand"}, {"camera.hfov", "40 deg"}};
    const Description scene = from_text(minimal + "[terrain.floor]\ntype = \"plane\"\n", overrides);
    EXPECT_EQ(scene.film.integer("width"), 320);
    EXPECT_EQ(scene.camera.vec3("eye"), Vec3d(1, 2, 3));
    EXPECT_EQ(scene.camera.vec3("target"), Vec3d(0, 20, 2));
    EXPECT_EQ(scene.terrains[0].values.text("material"), "sand");
    EXPECT_NEAR(scene.camera.number("hfov"), 0.69813170079773179, 1e-15);
}

TEST_F(SceneRead, set_that_misses_says_what_there_is)
{
    SceneOverrides overrides;
    overrides.sets = {{"terrain.flor.material", "sand"}, {"film.widht", "320"}, {"film.height", "1\nspp = 3"}};
    EXPECT_EQ(error_of(minimal + "[terrain.floor]\ntype = \"plane\"\n", overrides),
              "--set:1:6: unknown key \"widht\" in film (did you mean \"width\")\n    film.widht=320\n         ^\n"
              "--set:1:9: the scene has no \"flor\" here (did you mean \"floor\")\n    terrain.flor.material=sand\n            ^\n"
              "--set:1:13: height has the wrong type, expected an integer between 1 and 65536, got \"1 spp = 3\"\n    film.height=1 spp = 3\n        "
              "        ^");
}

TEST_F(SceneRead, includes_merge_and_the_including_file_wins)
{
    write("parts/base.toml", camera + "hfov_deg = 30\n[film]\nwidth = 100\nheight = 50\n[terrain.floor]\ntype = \"plane\"\nmaterial = \"sand\"\n");
    write("parts/late.toml", "[film]\nheight = 60\n");
    const std::string path =
        write("main.toml",
              "version = 1\ninclude = [\"parts/base.toml\", \"parts/late.toml\"]\n[film]\nwidth = 200\n[terrain.floor]\nmaterial = \"rock\"\n");
    const Description scene = read_scene(path, false);
    EXPECT_EQ(scene.film.integer("width"), 200);
    EXPECT_EQ(scene.film.integer("height"), 60);
    EXPECT_EQ(scene.terrains.at(0).type, "plane");
    EXPECT_EQ(scene.terrains[0].values.text("material"), "rock");
}

TEST_F(SceneRead, an_error_in_an_include_names_that_file)
{
    write("parts/base.toml", "[film]\nwidht = 100\n");
    const std::string path = write("main.toml", "include = [\"parts/base.toml\"]\n" + minimal);
    const Failure failure = failure_of([&] { read_scene(path, false); });
    EXPECT_TRUE(says(failure.text, (folder / "parts/base.toml").string() + ":2:1: unknown key \"widht\"")) << failure.text;
}

TEST_F(SceneRead, an_include_that_includes_itself_is_refused)
{
    write("b.toml", "include = [\"sub/../main.toml\"]\n");
    fs::create_directories(folder / "sub");
    const std::string path = write("main.toml", "include = [\"b.toml\"]\n" + minimal);
    const Failure failure = failure_of([&] { read_scene(path, false); });
    EXPECT_EQ(failure.kind, ErrorKind::scene);
    EXPECT_TRUE(says(failure.text, "b.toml:1:12: \"sub/../main.toml\" includes itself")) << failure.text;
}

TEST_F(SceneRead, includes_are_at_most_sixteen_deep)
{
    const auto chain = [&](int files) {
        for (int i = 1; i < files; ++i)
            write("f" + std::to_string(i) + ".toml", i + 1 < files ? "include = [\"f" + std::to_string(i + 1) + ".toml\"]\n" : "");
        return write("f0.toml", "include = [\"f1.toml\"]\n" + minimal);
    };
    EXPECT_EQ(failure_of([&] { read_scene(chain(16), false); }).text, "no error");
    EXPECT_TRUE(says(failure_of([&] { read_scene(chain(17), false); }).text, "too many includes"));
}

TEST_F(SceneRead, includes_that_double_at_each_level_are_refused)
{
    for (int i = 1; i < 14; ++i) {
        const std::string next = "\"f" + std::to_string(i + 1) + ".toml\"";
        write("f" + std::to_string(i) + ".toml", i < 13 ? "include = [" + next + ", " + next + "]\n" : "");
    }
    const std::string path = write("f0.toml", "include = [\"f1.toml\", \"f1.toml\"]\n" + minimal);
    EXPECT_TRUE(says(failure_of([&] { read_scene(path, false); }).text, "too many includes"));
}

TEST_F(SceneRead, insertions_that_double_each_time_are_refused)
{
    std::string text = "version = 1\n[params]\na0 = [1, 1]\n";
    for (int i = 1; i < 40; ++i)
        text += "a" + std::to_string(i) + " = [\"${a" + std::to_string(i - 1) + "}\", \"${a" + std::to_string(i - 1) + "}\"]\n";
    EXPECT_TRUE(says(error_of(text + camera), "the parameters make the scene too large"));
}

TEST_F(SceneRead, nesting_is_refused_before_it_reaches_the_parser)
{
    EXPECT_TRUE(says(error_of(minimal + "[film]\nx = " + std::string(100000, '[')), "nested too deeply"));
    std::string dots = "[film]\na";
    for (int i = 0; i < 100000; ++i) dots += ".a";
    EXPECT_TRUE(says(error_of(minimal + dots + " = 1\n"), "nested too deeply"));
    // The deepest that is allowed is only unknown, not too deep; brackets in texts and comments do not count.
    EXPECT_FALSE(says(error_of(minimal + "# " + std::string(1000, '[') + "\n[film]\nview = \"" + std::string(1000, '[') + "\"\n"), "nested"));
}

TEST_F(SceneRead, too_many_values_are_refused)
{
    std::string list = "[film]\nx = [";
    for (int i = 0; i < 150000; ++i) list += "1,";
    EXPECT_TRUE(says(error_of(minimal + list + "]\n"), "too many values"));
}

TEST_F(SceneRead, nul_bytes_dates_and_numbers_without_end_are_refused_with_their_place)
{
    using namespace std::string_literals;
    EXPECT_TRUE(says(error_of("version = 1\n[\0"s), "<text>:2:2: the file holds a NUL byte"));
    EXPECT_TRUE(says(error_of(minimal + "hfov_deg = nan\n"), "<text>:5:12: a number is not finite"));
    EXPECT_TRUE(says(error_of(minimal + "hfov_deg = -inf\n"), "a number is not finite"));
    EXPECT_TRUE(says(error_of(minimal + "hfov_deg = 2026-01-01\n"), "dates and times have no meaning"));
    EXPECT_NE(error_of("\xd0\xbd = 1\n"), "no error") << "toml++ once crashed here";
    EXPECT_NE(error_of("version = 1\n\xff\xfe"), "no error");
}

TEST_F(SceneRead, a_picture_too_large_is_refused_with_what_it_would_cost)
{
    const std::string text = error_of(minimal + "[film]\nwidth = 65536\nheight = 65536\n");
    EXPECT_TRUE(says(text, "<text>:6:9: 65536 x 65536 pixels are too many (at least 429 GB)")) << text;
}

TEST_F(SceneRead, the_hash_is_of_the_content_not_of_the_file)
{
    write("base.toml", camera);
    const std::uint64_t hash = from_text(minimal + "[film]\nwidth = 320\nheight = 200\n").hash;
    EXPECT_EQ(read_scene(write("a.toml", "include = [\"base.toml\"]\n# note\nversion = 1\n[film]\nheight = 200.0\nwidth = 320\n"), false).hash, hash);
    EXPECT_EQ(read_scene(write("sub/b.toml", minimal + "[film]\nheight = 200\nwidth = 320\n"), false).hash, hash);
    EXPECT_EQ(from_text("version = 1\n[params]\nw = 160\n" + camera + "[film]\nwidth = \"= 2 * w\"\nheight = 200\n").hash, hash);
    EXPECT_NE(from_text(minimal + "[film]\nwidth = 321\nheight = 200\n").hash, hash);
    SceneOverrides other;
    other.seed = 1;
    EXPECT_NE(from_text(minimal + "[film]\nwidth = 320\nheight = 200\n", other).hash, hash);
}

// -- Files --------------------------------------------------------------------------------------------------------------

TEST_F(SceneRead, an_absent_scene_or_include_is_a_problem_of_files)
{
    EXPECT_EQ(failure_of([&] { read_scene((folder / "none.toml").string(), false); }).kind, ErrorKind::file);
    const Failure failure = failure_of([&] { read_scene(write("main.toml", "include = [\"none.toml\"]\n" + minimal), false); });
    EXPECT_EQ(failure.kind, ErrorKind::file);
    EXPECT_TRUE(says(failure.text, "main.toml:1:12: cannot open \"none.toml\": no such file")) << failure.text;
    EXPECT_EQ(failure_of([&] { read_scene(folder.string(), false); }).kind, ErrorKind::file) << "a folder is no scene";
}

TEST_F(SceneRead, paths_are_relative_to_the_file_that_names_them)
{
    write("data/height.exr", "x");
    write("parts/data/height.exr", "x");
    write("parts/base.toml", camera + "[film]\ncolorconfig = \"data/height.exr\"\n");
    const Description scene = read_scene(write("main.toml", "version = 1\ninclude = [\"parts/base.toml\"]\n"), false);
    EXPECT_EQ(scene.resolve(scene.film.text("colorconfig"), scene.film.where("colorconfig")), (folder / "parts/data/height.exr").string());
    EXPECT_EQ(scene.resolve("data/height.exr", scene.render.where()), (folder / "data/height.exr").string());
}

TEST_F(SceneRead, files_outside_the_roots_are_refused_whether_they_exist_or_not)
{
    const std::string secret = write("secret.exr", "x");
    const std::string path = write("scene/main.toml", minimal);
    fs::create_symlink(secret, folder / "scene/link.exr");
    fs::create_directory_symlink(folder, folder / "scene/up");
    const Description scene = read_scene(path, false);
    const Source where{path, 1, 1, {}};
    for (const std::string& attack :
         {std::string("../secret.exr"), std::string("../none.exr"), secret, std::string("/etc/passwd"), std::string("/proc/self/environ"),
          std::string("link.exr"), std::string("up/secret.exr"), std::string("/dev/zero"), std::string("./../scene/../secret.exr")}) {
        const Failure failure = failure_of([&] { scene.resolve(attack, where); });
        EXPECT_EQ(failure.kind, ErrorKind::scene) << attack;
        EXPECT_TRUE(says(failure.text, "lies outside the folders this scene may read")) << attack << ": " << failure.text;
    }
    using namespace std::string_literals;
    EXPECT_EQ(failure_of([&] { scene.resolve("a\0b"s, where); }).kind, ErrorKind::scene);
    EXPECT_EQ(failure_of([&] { scene.resolve(std::string(5000, 'a'), where); }).kind, ErrorKind::file);
    // A folder whose name merely begins like the root is not below it.
    write("scene_of_others/a.exr", "x");
    EXPECT_EQ(failure_of([&] { scene.resolve("../scene_of_others/a.exr", where); }).kind, ErrorKind::scene);
}

TEST_F(SceneRead, a_declared_root_opens_that_folder_and_no_other)
{
    const std::string data = write("data/height.exr", "x");
    write("other/height.exr", "x");
    const std::string path = write("scene/main.toml", minimal);
    SceneOverrides overrides;
    overrides.allowed_roots = {(folder / "data").string()};
    const Description scene = read_scene(path, false, overrides);
    const Source where{path, 1, 1, {}};
    EXPECT_EQ(scene.resolve("../data/height.exr", where), data);
    EXPECT_EQ(scene.resolve(data, where), data);
    EXPECT_EQ(failure_of([&] { scene.resolve("../other/height.exr", where); }).kind, ErrorKind::scene);
    overrides.allowed_roots = {(folder / "none").string()};
    EXPECT_EQ(failure_of([&] { read_scene(path, false, overrides); }).kind, ErrorKind::file);
}

TEST_F(SceneRead, pipes_folders_and_absent_files_are_problems_of_files)
{
    const std::string path = write("main.toml", minimal);
    ASSERT_EQ(::mkfifo((folder / "pipe.exr").c_str(), 0600), 0);
    const Description scene = read_scene(path, false);
    const Source where{path, 1, 1, {}};
    for (const char* name : {"pipe.exr", "none.exr", "."}) EXPECT_EQ(failure_of([&] { scene.resolve(name, where); }).kind, ErrorKind::file) << name;
    // Without a writer, opening a pipe would wait for ever.
    EXPECT_EQ(failure_of([&] { read_scene((folder / "pipe.exr").string(), false); }).kind, ErrorKind::file);
    EXPECT_EQ(failure_of([&] { read_scene(write("m.toml", "include = [\"pipe.exr\"]\n" + minimal), false); }).kind, ErrorKind::file);
}
