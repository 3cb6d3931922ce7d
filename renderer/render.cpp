// The whole program on one page: read, build, trace, develop, write.
//
// Missing: checkpoints within a picture.
#include "renderer/render.h"

#include "renderer/build_info.h"
#include "renderer/film/film.h"
#include "renderer/film/write.h"
#include "renderer/provenance.h"
#include "renderer/scene/read.h"
#include "renderer/scene/sections.h"
#include "renderer/transport/tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace hoodoo
{

namespace
{

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string text_of(const Values& values, const std::string& name)
{
    return values.has(name) ? values.text(name) : std::string();
}

/// How the scene wants to be shown. Throws Error at the view or display that the colour configuration does not have.
ColorTransform display_of(const LoadedScene& loaded)
{
    const Values& film = loaded.description.film;
    return loaded.color->to_display(text_of(film, "display"), text_of(film, "view"), film.where(film.has("view") ? "view" : "display"));
}

std::string ending_of(const std::string& path)
{
    const std::size_t dot = path.find_last_of("./");
    return dot == std::string::npos || path[dot] == '/' ? std::string() : path.substr(dot);
}

/// The part of the picture that is asked for: bounds in pixels, or a window whose edges are shared between neighbouring windows.
PixelBounds data_window(const RenderOptions& options, int width, int height)
{
    if (options.crop_window && options.pixel_bounds) throw Error(ErrorKind::scene, "give either a crop window or pixel bounds, not both");
    if (options.pixel_bounds) {
        const PixelBounds& b = *options.pixel_bounds;
        if (!options.quick) return b;
        return {b.x0 / 4, std::min((b.x1 + 3) / 4, width), b.y0 / 4, std::min((b.y1 + 3) / 4, height)};
    }
    if (!options.crop_window) return {0, width, 0, height};
    const auto& [x0, x1, y0, y1] = *options.crop_window;
    const bool inside = 0.0 <= x0 && x0 < x1 && x1 <= 1.0 && 0.0 <= y0 && y0 < y1 && y1 <= 1.0;
    if (!inside)
        throw Error(ErrorKind::scene, Problem{{},
                                              "the crop window must be a part of the picture",
                                              "0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1",
                                              fmt::format("{},{},{},{}", x0, x1, y0, y1),
                                              {}});
    const auto pixel = [](double share, int size) { return static_cast<int>(std::ceil(share * size)); };
    return {pixel(x0, width), pixel(x1, width), pixel(y0, height), pixel(y1, height)};
}

}  // namespace

LoadedScene load_scene(const std::string& text_or_path, bool is_text, const SceneOverrides& overrides, int threads, const std::string& colorconfig,
                       std::function<void(double, const std::string&)> progress, bool editable)
{
    const auto start = std::chrono::steady_clock::now();
    LoadedScene loaded;
    loaded.description = read_scene(text_or_path, is_text, overrides);

    // Colours first: every table of the scene may name one.
    const Values& film = loaded.description.film;
    const bool named = colorconfig.empty() && film.has("colorconfig");
    loaded.color =
        ColorConfig::choose(colorconfig, named ? loaded.description.resolve(film.text("colorconfig"), film.where("colorconfig")) : std::string());
    display_of(loaded);

    SceneOptions options;
    options.to_rendering = [color = loaded.color](const ColorValue& value) { return color->to_rendering(value.space, Vec3f(value.rgb)); };
    options.threads = threads;
    options.progress = std::move(progress);
    options.editable = editable;
    loaded.scene = std::make_unique<Scene>(loaded.description, options);
    loaded.build_seconds = seconds_since(start);
    return loaded;
}

FilmLayout picture_layout(const Description& description, const RenderOptions& options)
{
    const Values &film = description.film, &work = description.render;
    FilmLayout layout;
    layout.width = options.width.value_or(static_cast<int>(film.integer("width")));
    layout.height = options.height.value_or(static_cast<int>(film.integer("height")));
    layout.samples = options.spp.value_or(static_cast<int>(work.integer("spp")));
    layout.replicates = options.replicates.value_or(static_cast<int>(work.integer("replicates")));
    if (layout.width < 1 || layout.height < 1 || layout.samples < 1 || layout.replicates < 1)
        throw Error(ErrorKind::scene, "a picture needs at least one pixel, one sample and one replicate");
    if (const std::string what = too_large(layout.width, layout.height, layout.samples); !what.empty()) throw Error(ErrorKind::scene, what);
    if (options.quick)
        for (int* number : {&layout.width, &layout.height, &layout.samples}) *number = std::max(1, *number / 4);
    layout.replicates = std::min(layout.replicates, layout.samples);
    layout.data = data_window(options, layout.width, layout.height);
    return layout;
}

Image render(const LoadedScene& loaded, const RenderOptions& options)
{
    const auto start = std::chrono::steady_clock::now();
    const Values &picture = loaded.description.film, &work = loaded.description.render;
    FilmLayout layout = picture_layout(loaded.description, options);
    layout.materials = loaded.scene->material_names();
    PathSettings path;
    path.size = {layout.width, layout.height};
    Film film(std::move(layout));
    path.max_depth = static_cast<int>(work.integer("max_depth"));
    path.roulette_depth = static_cast<int>(work.integer("roulette_depth"));
    path.seed = options.seed.value_or(loaded.description.seed);
    path.frame = options.lock_seed ? 0u : static_cast<std::uint32_t>(loaded.description.frame);

    TileSettings tiles;
    tiles.filter = Filter(picture.text("filter"), picture.has("filter_width") ? picture.number("filter_width") : 0.0);
    tiles.threads = options.threads;
    tiles.tile_size = options.tile_size;
    tiles.cancel = options.cancel;
    if (options.progress) tiles.progress = [&](double fraction) { options.progress(fraction, "tracing"); };
    if (!trace_tiles(*loaded.scene, path, tiles, film)) return {};

    Image image = film.develop();
    image.metadata = provenance(loaded, options, film, path.seed, seconds_since(start));
    return image;
}

std::string picture_key(const Description& description, const RenderOptions& options)
{
    const FilmLayout layout = picture_layout(description, options);
    const PixelBounds& d = layout.data;
    const std::string frame = options.lock_seed ? fmt::format("{} locked", description.frame) : fmt::to_string(description.frame);
    return fmt::format("scene {:016x}, frame {}, seed {}, {} samples in {}, {} x {}, {},{},{},{}, Hoodoo {}", description.hash, frame,
                       options.seed.value_or(description.seed), layout.samples, layout.replicates, layout.width, layout.height, d.x0, d.x1, d.y0,
                       d.y1, version());
}

bool is_rendered(const std::string& path, const std::string& key)
{
    try {
        if (ending_of(path) == ".png") return read_png_text(path, "hoodoo:picture") == key;
        const Image image = read_exr(path);
        const auto found = image.metadata.find("hoodoo:picture");
        const std::string* text = found == image.metadata.end() ? nullptr : std::get_if<std::string>(&found->second);
        return text && *text == key;
    } catch (const Error&) {
        return false;
    }
}

void check_picture_name(const std::string& path)
{
    const std::string ending = ending_of(path);
    if (ending != ".exr" && ending != ".png")
        throw Error(ErrorKind::scene,
                    Problem{{}, "the name of a picture tells its format", ".exr or .png at its end", fmt::format("\"{}\"", path), {}});
}

void write_picture(const Image& image, const std::string& path, const LoadedScene& loaded)
{
    check_picture_name(path);
    if (ending_of(path) == ".exr") {
        write_exr(image, path);
        return;
    }
    const Values& film = loaded.description.film;
    const bool is_srgb = loaded.color->display_name(text_of(film, "display")).find("sRGB") != std::string::npos;
    write_png(image, path, display_of(loaded), film.number("exposure"), is_srgb);
}

}  // namespace hoodoo
