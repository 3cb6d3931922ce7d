// The command line: arguments in, one command, and the one place where its errors are caught. The only includer of CLI11.
// Exit codes: 0; 1 internal; 2 arguments or scene; 3 files; 4 memory; 130 and 143 after SIGINT and SIGTERM.
#include "renderer/hosts/cli.h"

#include "terrain/isa.h"
#include "terrain/schema_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <new>
#include <tuple>

namespace hoodoo::cli
{
namespace
{

/// All that the options fill in.
struct Arguments {
    RenderArguments render;
    ImportArguments import;
    MovieArguments movie;
    std::int64_t frame = 0;
    ExportArguments exported;
    SurveyArguments survey;
    double azimuth_deg = 315.0, altitude_deg = 45.0;
    std::vector<int> subset;
    std::vector<double> cell, degrees;
    std::vector<std::string> params, sets;
    std::int64_t seed = 0;
    int spp = 0, replicates = 0;
    std::vector<int> resolution, pixel_bounds;
    std::vector<double> crop_window;
    std::string section;
};

std::pair<std::string, std::string> key_and_value(const std::string& text, const char* flag)
{
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw Error(ErrorKind::scene, Problem{{}, fmt::format("{} {} names no value", flag, text), "key=value", {}, {}});
    return {text.substr(0, equals), text.substr(equals + 1)};
}

/// A file name with an ending, or one of two.
CLI::Validator file_name(const std::string& what, const std::string& ending, const std::string& other = {})
{
    const std::string shown = other.empty() ? ending : ending + " or " + other;
    return CLI::Validator(
        [=](std::string& name) {
            const bool known = name.ends_with(ending) || (!other.empty() && name.ends_with(other));
            return known ? std::string() : what + " ends in " + shown + ", not \"" + name + "\"";
        },
        "FILE" + ending, what);
}

void add_scene_options(CLI::App& command, Arguments& a)
{
    SceneArguments& scene = a.render.scene;
    command.add_option("scene", scene.scene, "Scene file (TOML)")->required();
    command.add_option("-D,--define", a.params, "Replace a parameter of the scene: name=value")->take_all()->allow_extra_args(false);
    command.add_option("--set", a.sets, "Replace any value of the scene: path.to.key=value")->take_all()->allow_extra_args(false);
    command.add_option("--allow-read", scene.overrides.allowed_roots, "A folder the scene may read files from, beside its own")
        ->take_all()
        ->allow_extra_args(false);
    command.add_option("--colorconfig", scene.colorconfig, "OpenColorIO configuration (else the scene's, $OCIO, the one built in)");
    command.add_option("--frame", a.frame, "Frame of the animation")->check(CLI::Range(-1000000000, 1000000000));
    command.add_option("-t,--threads", scene.threads, "Threads; 0 = all this process may use")->check(CLI::Range(0, 4096));
    command.add_option("--seed", a.seed, "Seed of the samples; the ground keeps the scene's")->check(CLI::NonNegativeNumber);
    command.add_flag("-q,--quiet", scene.quiet, "Say nothing but errors");
}

void add_render(CLI::App& app, Arguments& a)
{
    CLI::App* command = app.add_subcommand("render", "Render a scene");
    add_scene_options(*command, a);
    RenderArguments& r = a.render;
    command->add_option("-o,--output", r.outputs, "Picture to write; several may be given")
        ->take_all()
        ->allow_extra_args(false)
        ->check(file_name("a picture", ".exr", ".png"));
    command->add_option("--spp", a.spp, "Samples a pixel")->check(CLI::Range(1, 1 << 24));
    command->add_option("-r,--resolution", a.resolution, "Width and height in pixels")
        ->expected(2)
        ->allow_extra_args(false)
        ->check(CLI::Range(1, 65536));
    command->add_option("--replicates", a.replicates, "Independent repetitions among the samples (unbiased variance)")->check(CLI::Range(1, 4096));
    auto* crop = command->add_option("--crop-window", a.crop_window, "x0,x1,y0,y1 as fractions of the picture, y downwards")
                     ->delimiter(',')
                     ->expected(4)
                     ->allow_extra_args(false);
    command->add_option("--pixel-bounds", a.pixel_bounds, "x0,x1,y0,y1 in pixels, half-open, y downwards")
        ->delimiter(',')
        ->expected(4)
        ->allow_extra_args(false)
        ->excludes(crop);
    command->add_option("--frames", r.frames, "Frames to render: 1-240, 1-10,20-50x2; the output names them with ####")
        ->excludes(command->get_option("--frame"));
    command->add_flag("--skip-existing", r.skip_existing, "Leave pictures that are there, whole, and of this scene and these options");
    command->add_flag("--lock-seed", r.options.lock_seed, "The same noise in every frame");
    command->add_flag("!--reproducible", r.options.measurements, "Leave time and memory out of the header: equal pictures are equal files");
    command->add_flag("--quick", r.options.quick, "A quarter of the resolution and of the samples");
    command->add_flag("-n,--dry-run", r.dry_run, "Read and build the scene, estimate time and memory, write nothing");
}

/// "30 m" -> "30": lengths carry units here as they do in scenes.
const CLI::Validator in_metres(
    [](std::string& text) {
        if (const auto metres = parse_quantity(text, ParameterType::length)) text = fmt::format("{}", *metres);
        return std::string();
    },
    "", "metres");

/// What an elevation model is, for every command that reads one.
void add_dem_options(CLI::App& command, Arguments& a)
{
    DemOptions& o = a.import.options;
    command.add_option("--array", o.array, "Array of an archive; without it the only one with two dimensions");
    command.add_flag("--flip", o.flip, "Row 0 of the source is the south");
    command.add_option("--subset", a.subset, "x0,x1,y0,y1 in source pixels, half-open, row 0 = north")
        ->delimiter(',')
        ->expected(4)
        ->allow_extra_args(false)
        ->check(CLI::NonNegativeNumber);
    command.add_option("--scale", o.scale, "Metres for the value 1")->transform(in_metres)->check(CLI::PositiveNumber);
    auto* cell = command.add_option("--cell", a.cell, "Metres between source pixels: one number, or x,y")
                     ->delimiter(',')
                     ->expected(1, 2)
                     ->transform(in_metres)
                     ->check(CLI::PositiveNumber);
    command.add_option("--degrees", a.degrees, "Degrees between source pixels: one number, or x,y")
        ->delimiter(',')
        ->expected(1, 2)
        ->check(CLI::PositiveNumber)
        ->excludes(cell);
    command.add_option("--latitude", o.latitude, "Of the middle, in degrees; without it from the archive")->check(CLI::Range(-89.0, 89.0));
    command.add_option("--resample", o.resample_to, "Metres between the cells written; without it the smaller of the two spacings")
        ->transform(in_metres)
        ->check(CLI::PositiveNumber);
    command.add_option("--fill", o.fill, "Height for samples without data, in files that GDAL reads; without it they are an error")
        ->transform(in_metres);
    command.add_flag("-q,--quiet", a.import.quiet, "Say nothing but errors");
}

void add_import_dem(CLI::App& app, Arguments& a)
{
    CLI::App* command = app.add_subcommand("import-dem", "Turn an elevation model into a height image in metres with square cells");
    command->add_option("input", a.import.input, "NumPy archive (.npz), GeoTIFF and the like (in a build with GDAL), or any image")->required();
    command->add_option("-o,--output", a.import.output, "Height image to write (.exr)")->required()->check(file_name("a height image", ".exr"));
    add_dem_options(*command, a);
}

void add_analyse(CLI::App& app, Arguments& a)
{
    CLI::App* command = app.add_subcommand("analyse", "Measure an elevation model: slope, aspect, curvatures, drained area, wetness");
    command->add_option("input", a.import.input, "Height image, NumPy archive (.npz) or any image")->required();
    command->add_option("-o,--output", a.import.output, "Channels to write (.exr)")->required()->check(file_name("metrics", ".exr"));
    add_dem_options(*command, a);
}

void add_movie(CLI::App& app, Arguments& a)
{
    CLI::App* command = app.add_subcommand("movie", "Numbered EXR pictures to an H.264 film, through the display transform");
    MovieArguments& m = a.movie;
    command->add_option("input", m.input, "Pictures, such as wave.####.exr")->required()->check(file_name("a picture", ".exr"));
    command->add_option("-o,--output", m.output, "Film to write (.mp4)")->required()->check(file_name("a film", ".mp4"));
    command->add_option("--frames", m.frames, "Frames to take; without it all there are");
    command->add_option("--fps", m.fps, "Frames a second; without it what the pictures say")->check(CLI::Range(1.0, 1000.0));
    command->add_option("--exposure", m.exposure, "Stops; without it what the pictures say")->check(CLI::Range(-64.0, 64.0));
    command->add_option("--colorconfig", m.colorconfig, "OpenColorIO configuration (else $OCIO, the one built in)");
    command->add_option("--display", m.display, "Display of the colour configuration");
    command->add_option("--view", m.view, "View of the display");
    command->add_option("--quality", m.quality, "0 lossless, 51 worst")->check(CLI::Range(0, 51));
    command->add_flag("-q,--quiet", m.quiet, "Say nothing but errors");
}

void finish_import(Arguments& a)
{
    DemOptions& o = a.import.options;
    if (a.subset.size() == 4) o.subset = {a.subset[0], a.subset[1], a.subset[2], a.subset[3]};
    if (!a.cell.empty()) std::tie(o.cell_x, o.cell_y) = std::pair(a.cell.front(), a.cell.back());
    if (!a.degrees.empty()) std::tie(o.degrees_x, o.degrees_y) = std::pair(a.degrees.front(), a.degrees.back());
}

CLI::App* add_export(CLI::App& app, Arguments& a, const char* name, const char* help, const CLI::Validator& output)
{
    CLI::App* command = app.add_subcommand(name, help);
    add_scene_options(*command, a);
    command->add_option("--terrain", a.exported.terrain, "Which terrain of the scene, where it has several");
    command->add_option("-o,--output", a.exported.output, "File to write")->required()->check(output);
    return command;
}

void add_bake(CLI::App& app, Arguments& a)
{
    CLI::App* command = app.add_subcommand("bake",
                                           "Write the layers of a terrain, edits done, as a deep EXR that a scene reads back; or the pictures "
                                           "behind cracked ground");
    add_scene_options(*command, a);
    ExportArguments& e = a.exported;
    command->add_option("--terrain", e.terrain, "Which terrain of the scene, where it has several");
    auto* group = command->add_option_group("output", "What to write");
    auto* stack = group->add_option("-o,--output", e.output, "Layers to write")->check(file_name("a stack", ".exr"));
    for (auto* picture :
         {group->add_option("--crack-map", e.crack_map, "Cracked ground: 1 in a crack, else 0")->check(file_name("a map", ".exr")),
          group->add_option("--height", e.height, "Cracked ground: heights in metres")->check(file_name("a height image", ".exr")),
          group->add_option("--diagram", e.diagram, "Cracked ground: sites, triangulation, cracks")->check(file_name("a drawing", ".svg", ".png"))})
        picture->excludes(stack);
    group->require_option(1, 0);
    command->add_option("--cell", e.cell, "Metres between pixels of map and heights; without it a 1024th of the longer side")
        ->transform(in_metres)
        ->check(CLI::PositiveNumber);
}

CLI::App* add_survey(CLI::App& app, Arguments& a, const char* name, const char* help)
{
    CLI::App* command = app.add_subcommand(name, help);
    add_scene_options(*command, a);
    command->add_option("--terrain", a.survey.terrain, "Which terrain of the scene, where it has several");
    return command;
}

/// What contours and hillshade take their heights from.
void add_heights(CLI::App& command, Arguments& a)
{
    SurveyArguments& s = a.survey;
    command.get_option("scene")->description("Scene file (TOML), or an elevation model (.npz or any image)");
    command.add_option("--bounds", s.bounds, "x0,x1,y0,y1 in metres; without it all of the terrain")
        ->delimiter(',')
        ->expected(4)
        ->allow_extra_args(false);
    command.add_option("--cell", s.cell, "Metres between heights; without it a 1024th of the longer side, or what the model says")
        ->transform(in_metres)
        ->check(CLI::PositiveNumber);
    command.add_option("--scale", s.scale, "Metres for the value 1 of an elevation model")->transform(in_metres)->check(CLI::PositiveNumber);
}

void add_surveys(CLI::App& app, Arguments& a)
{
    SurveyArguments& s = a.survey;
    CLI::App* sample = add_survey(app, a, "sample", "Write the field of a terrain on a grid of points");
    sample->add_option("--grid", s.grid, "Nodes along x, y and z: NX,NY,NZ")
        ->required()
        ->delimiter(',')
        ->expected(3)
        ->allow_extra_args(false)
        ->check(CLI::Range(1, 65536));
    sample->add_option("--bounds", s.bounds, "x0,x1,y0,y1,z0,z1 in metres; without it those of the terrain")
        ->delimiter(',')
        ->expected(6)
        ->allow_extra_args(false);
    sample->add_option("-o,--output", s.output, "Grid to write (.vdb, .exr or .npy)")->required();

    CLI::App* section = add_survey(app, a, "slice", "Draw a vertical section through a terrain");
    section->add_option("--from", s.from, "x,y where it begins, metres")->required()->delimiter(',')->expected(2)->allow_extra_args(false);
    section->add_option("--to", s.to, "x,y where it ends, metres")->required()->delimiter(',')->expected(2)->allow_extra_args(false);
    section->add_option("--heights", s.heights, "z0,z1 in metres; without it those of the terrain")
        ->delimiter(',')
        ->expected(2)
        ->allow_extra_args(false);
    section->add_option("--columns", s.columns, "Pixels from begin to end")->check(CLI::Range(2, 16384));

    CLI::App* contours = add_survey(app, a, "contours", "Draw contours of a terrain as seen from above");
    add_heights(*contours, a);
    contours->add_option("--interval", s.interval, "Metres from one contour to the next")->transform(in_metres)->check(CLI::PositiveNumber);
    for (CLI::App* drawing : {section, contours})
        drawing->add_option("-o,--output", s.output, "Drawing to write (.svg or .png)")->required()->check(file_name("a drawing", ".svg", ".png"));

    CLI::App* shade = add_survey(app, a, "hillshade", "Shade a terrain as seen from above, as maps do");
    add_heights(*shade, a);
    shade->add_option("--azimuth", a.azimuth_deg, "Where the light comes from, degrees from north to east")->check(CLI::Range(-360.0, 360.0));
    shade->add_option("--altitude", a.altitude_deg, "Of the light above the horizon, degrees")->check(CLI::Range(0.0, 90.0));
    shade->add_option("--exaggeration", s.exaggeration, "Of heights")->check(CLI::PositiveNumber);
    shade->add_option("-o,--output", s.output, "Picture to write (.png)")->required()->check(file_name("a picture", ".png"));

    CLI::App* error = add_survey(app, a, "mesh-error", "Measure how far a mesh lies from the field of a terrain; prints JSON");
    error->add_option("mesh", s.mesh, "Triangles (.ply, .obj or .stl) in the scene's metres")->required();
    error->add_flag("--y-up", s.y_up, "The mesh's second axis is its vertical");
    error->add_option("--reach", s.reach, "Metres to search; without it a fiftieth of the mesh's diagonal")
        ->transform(in_metres)
        ->check(CLI::PositiveNumber);
}

void add_commands(CLI::App& app, Arguments& a)
{
    add_surveys(app, a);
    add_bake(app, a);
    add_export(app, a, "mesh", "Write a terrain as triangles, with its measured error", file_name("a mesh", ".ply", ".obj"))
        ->add_option("--spacing", a.exported.spacing, "Metres between samples; without it a column of the stack")
        ->transform(in_metres)
        ->check(CLI::PositiveNumber);
    add_import_dem(app, a);
    add_analyse(app, a);
    add_render(app, a);
    add_movie(app, a);
    add_scene_options(*app.add_subcommand("check", "Read and build a scene, report all its errors"), a);
    add_scene_options(*app.add_subcommand("info", "Print what a scene is made of, as JSON"), a);
    app.add_subcommand("schema", "Print the JSON Schema of scenes for editors")
        ->add_option("section", a.section, "Explain one section instead: film, terrain.TYPE, light.TYPE ...");
    app.add_subcommand("version", "Print the versions of the program and its libraries");
}

void check_bounds(const Arguments& a)
{
    const auto& c = a.crop_window;
    if (!c.empty() && !(c[0] >= 0 && c[0] < c[1] && c[1] <= 1 && c[2] >= 0 && c[2] < c[3] && c[3] <= 1))
        throw Error(ErrorKind::scene, Problem{{}, "--crop-window is no window", "x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1", {}, {}});
    const auto& p = a.pixel_bounds;
    if (!p.empty() && !(p[0] >= 0 && p[0] < p[1] && p[2] >= 0 && p[2] < p[3]))
        throw Error(ErrorKind::scene, Problem{{}, "--pixel-bounds are no bounds", "x0,x1,y0,y1 with 0 <= x0 < x1 and 0 <= y0 < y1", {}, {}});
}

/// What CLI11 read, as the commands take it.
void finish_arguments(const CLI::App& command, Arguments& a)
{
    SceneArguments& scene = a.render.scene;
    for (const std::string& text : a.params) scene.overrides.params.push_back(key_and_value(text, "-D"));
    for (const std::string& text : a.sets) scene.overrides.sets.push_back(key_and_value(text, "--set"));
    const auto given = [&](const char* name) {
        const CLI::Option* option = command.get_option_no_throw(name);
        return option && option->count() > 0;
    };
    RenderOptions& o = a.render.options;
    o.threads = scene.threads;
    if (given("--seed")) o.seed = static_cast<std::uint64_t>(a.seed);  // of the samples alone: no hill moves
    if (given("--frame")) scene.overrides.frame = a.frame;
    if (given("--spp")) o.spp = a.spp;
    if (given("--replicates")) o.replicates = a.replicates;
    check_bounds(a);
    if (a.resolution.size() == 2) {
        o.width = a.resolution[0];
        o.height = a.resolution[1];
    }
    if (a.crop_window.size() == 4) o.crop_window = {a.crop_window[0], a.crop_window[1], a.crop_window[2], a.crop_window[3]};
    if (a.pixel_bounds.size() == 4) o.pixel_bounds = PixelBounds{a.pixel_bounds[0], a.pixel_bounds[1], a.pixel_bounds[2], a.pixel_bounds[3]};
    if (command.get_name() == "render" && a.render.outputs.empty() && !a.render.dry_run)
        throw Error(ErrorKind::scene, Problem{{}, "render writes no picture", "-o FILE.exr or --dry-run", {}, {}});
}

int run(int argc, char** argv)
{
    Arguments arguments;
    CLI::App app("Path tracer for terrains that height maps and meshes cannot hold.", "hoodoo");
    app.require_subcommand(1);
    app.set_version_flag("--version", [] {
        run_version();
        return std::string();
    });
    add_commands(app, arguments);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : exit_usage;
    }
    selected_isa();  // an unknown HOODOO_ISA is an error before any work
    const CLI::App& command = *app.get_subcommands().front();
    finish_arguments(command, arguments);
    const std::string& name = command.get_name();
    if (name == "render") return run_render(arguments.render);
    if (name == "check") return run_check(arguments.render.scene);
    if (name == "info") return run_info(arguments.render.scene);
    if (name == "movie") return run_movie(arguments.movie);
    if (name == "import-dem" || name == "analyse") {
        finish_import(arguments);
        return name == "analyse" ? run_analyse(arguments.import) : run_import_dem(arguments.import);
    }
    arguments.exported.scene = arguments.render.scene;
    if (name == "bake") return arguments.exported.output.empty() ? run_bake_cracks(arguments.exported) : run_bake(arguments.exported);
    if (name == "mesh") return run_mesh(arguments.exported);
    constexpr double radians = 0.017453292519943295;
    arguments.survey.scene = arguments.render.scene;
    arguments.survey.azimuth = radians * arguments.azimuth_deg;
    arguments.survey.altitude = radians * arguments.altitude_deg;
    if (name == "sample") return run_sample(arguments.survey);
    if (name == "slice") return run_section(arguments.survey);
    if (name == "contours") return run_contours(arguments.survey);
    if (name == "hillshade") return run_hillshade(arguments.survey);
    if (name == "mesh-error") return run_mesh_error(arguments.survey);
    if (name == "schema") return run_schema(arguments.section);
    return run_version();
}

}  // namespace
}  // namespace hoodoo::cli

int main(int argc, char** argv)
{
    hoodoo::cli::catch_signals();
    try {
        return hoodoo::cli::run(argc, argv);
    } catch (const hoodoo::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return static_cast<int>(error.kind());
    } catch (const std::bad_alloc&) {
        std::fputs("hoodoo: there is not enough memory\n", stderr);
        return static_cast<int>(hoodoo::ErrorKind::memory);
    } catch (const std::exception& error) {
        fmt::print(stderr, "hoodoo: internal error: {}\n", error.what());
        return static_cast<int>(hoodoo::ErrorKind::internal);
    }
}
