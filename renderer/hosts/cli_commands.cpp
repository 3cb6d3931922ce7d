// What the commands of the command line do. Data goes to stdout, everything said about the work to stderr.
#include "renderer/hosts/cli.h"

#include "renderer/build_info.h"
#include "renderer/scene/json_schema.h"
#include "renderer/scene/sections.h"
#include "terrain/isa.h"
#include "terrain/schema_values.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <unistd.h>

namespace hoodoo::cli
{
namespace fs = std::filesystem;

void print(const std::string& text)
{
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw Error(ErrorKind::file, "cannot write to the standard output");
}

LoadedScene load(const SceneArguments& arguments, Progress& progress)
{
    return load_scene(arguments.scene, false, arguments.overrides, arguments.threads, arguments.colorconfig,
                      [&](double fraction, const std::string& what) { progress.update(fraction, what); });
}

/// An hour of work must not end at a folder that is not there.
void check_output(const std::string& path)
{
    const fs::path folder = fs::path(path).parent_path();
    const std::string named = folder.empty() ? "." : folder.string();
    std::error_code error;
    if (!fs::is_directory(named, error)) throw Error(ErrorKind::file, fmt::format("cannot write \"{}\": there is no folder \"{}\"", path, named));
    if (fs::is_directory(path, error)) throw Error(ErrorKind::file, fmt::format("cannot write \"{}\": it is a folder", path));
    if (::access(named.c_str(), W_OK) != 0)
        throw Error(ErrorKind::file, fmt::format("cannot write \"{}\": the folder \"{}\" is not writable", path, named));
}

namespace
{

using Json = nlohmann::ordered_json;

Json info_json(const LoadedScene& loaded)
{
    Json terrains = Json::object();
    for (const SceneObject& object : loaded.scene->objects()) {
        const SurfaceInfo& i = object.info;
        terrains[object.name] = {{"type", object.type},
                                 {"columns", i.columns},
                                 {"layers", i.layers},
                                 {"stack_bytes", i.stack_bytes},
                                 {"trace_bytes", i.trace_bytes},
                                 {"patches", i.patches},
                                 {"build_seconds", i.build_seconds}};
        if (i.rocks.instances > 0)
            terrains[object.name]["rocks"] = {{"instances", i.rocks.instances},
                                              {"per_tile", i.rocks.per_tile},
                                              {"tile_seconds", i.rocks.tile_seconds},
                                              {"instancing_seconds", i.rocks.instancing_seconds}};
    }
    Json lights = Json::object();
    for (const DescribedNode& light : loaded.description.lights) lights[light.name] = {{"type", light.type}};
    const Box3d& box = loaded.scene->bounds();
    Json bounds = nullptr;
    if (!box.isEmpty()) bounds = {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}};
    return {{"terrain", terrains},
            {"light", lights},
            {"materials", loaded.scene->material_names()},
            {"bounds", bounds},
            {"build_seconds", loaded.build_seconds},
            {"scene_hash", fmt::format("{:016x}", loaded.description.hash)}};
}

std::string default_text(const Parameter& p)
{
    Node node;  // only to quote the value as errors do
    if (const auto* b = std::get_if<bool>(&p.fallback))
        node.value = *b;
    else if (const auto* i = std::get_if<std::int64_t>(&p.fallback))
        node.value = *i;
    else if (const auto* x = std::get_if<double>(&p.fallback)) {
        if (p.type == ParameterType::angle) return fmt::format(" Default {:.6g} deg.", *x * 57.295779513082323);
        node.value = *x;
    } else if (const auto* s = std::get_if<std::string>(&p.fallback))
        node.value = *s;
    else if (const auto* v = std::get_if<std::vector<double>>(&p.fallback))
        return fmt::format(" Default [{}].", fmt::join(*v, ", "));
    else if (const auto* c = std::get_if<ColorValue>(&p.fallback))
        return fmt::format(" Default {{ {} = [{}, {}, {}] }}.", c->space, c->rgb.x, c->rgb.y, c->rgb.z);
    else if (const auto* n = std::get_if<std::vector<std::string>>(&p.fallback))
        return fmt::format(" Default [\"{}\"].", fmt::join(*n, "\", \""));
    else
        return p.required ? " Required." : "";
    return " Default " + quoted_value(node) + ".";
}

/// A table of a scene in words, its lists of tables indented below it.
std::string schema_text(const std::string& head, const Schema& schema, int indent)
{
    const std::string margin(static_cast<std::size_t>(indent), ' ');
    std::string out = fmt::format("{}{}  {}\n", margin, head, schema.doc);
    for (const Parameter& p : schema.parameters) {
        const std::string key = p.type == ParameterType::angle ? fmt::format("{} | {}_deg", p.name, p.name) : p.name;
        out += fmt::format("{}  {:<26} {}{}\n{}  {:<26} {}\n", margin, key, p.doc, default_text(p), margin, "", expected_text(p));
        for (const Schema& item : p.items)
            out += schema_text(p.discriminator.empty() ? "[[" + p.name + "]]" : fmt::format("[[{}]] {} = \"{}\"", p.name, p.discriminator, item.name),
                               item, indent + 4);
    }
    return out;
}

}  // namespace

int run_check(const SceneArguments& arguments)
{
    Progress progress(arguments.quiet);
    const LoadedScene loaded = load(arguments, progress);
    progress.finish();
    if (!arguments.quiet)
        print(fmt::format("{}: all is well ({} terrains, {} materials, {} lights)\n", arguments.scene, loaded.description.terrains.size(),
                          loaded.description.materials.size(), loaded.description.lights.size()));
    return 0;
}

int run_info(const SceneArguments& arguments)
{
    Progress progress(arguments.quiet);
    const LoadedScene loaded = load(arguments, progress);
    progress.finish();
    print(info_json(loaded).dump(2) + "\n");
    return 0;
}

int run_schema(const std::string& wanted)
{
    if (wanted.empty()) {
        print(scene_json_schema());
        return 0;
    }
    std::vector<std::string> titles;
    for (const Section& section : scene_sections())
        for (std::size_t i = 0; i < section.schemas.size(); ++i) {
            titles.push_back(section.types.empty() ? section.name : section.name + "." + section.types[i]);
            if (titles.back() != wanted) continue;
            print(schema_text("[" + wanted + "]", *section.schemas[i], 0));
            return 0;
        }
    std::string all;
    for (const std::string& title : titles) all += (all.empty() ? "" : ", ") + title;
    throw Error(ErrorKind::scene, Problem{{}, fmt::format("there is no section \"{}\"", wanted), "one of " + all, {}, nearest_name(wanted, titles)});
}

int run_version()
{
    std::string text =
        fmt::format("hoodoo {}\nprocessor: {}\nbuilt for: {}, uses {}\n", version(), processor_name(), baseline_name(), isa_name(selected_isa()));
    for (const auto& [name, number] : library_versions()) text += fmt::format("{} {}\n", name, number);
    print(text);
    return 0;
}

int run_import_dem(const ImportArguments& arguments)
{
    check_output(arguments.output);
    const HeightImage heights = import_dem(arguments.input, arguments.options);
    write_height_image(arguments.output, heights);
    const auto [low, high] = std::minmax_element(heights.values.begin(), heights.values.end());
    if (!arguments.quiet)
        fmt::print(stderr, "wrote {}: {} x {} heights of {:.6g} m, from {:.6g} to {:.6g} m\n", arguments.output, heights.width, heights.height,
                   heights.cell, *low, *high);
    return 0;
}

}  // namespace hoodoo::cli
