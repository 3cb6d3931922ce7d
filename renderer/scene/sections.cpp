// The sections of a scene. Film and render stand here; the others' schemas come from whoever understands them: camera, lights, materials, catalogue.
// Filter widths (diameters): Blackman-Harris 3.3 pixels and Gaussian 3 (sigma 0.5) keep a pixel's neighbours out without blur; a box is the pixel
// itself.
#include "renderer/scene/sections.h"

#include "renderer/light/light.h"
#include "renderer/media/haze.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/media.h"
#include "renderer/shading/look.h"
#include "terrain/catalogue.h"

#include <fmt/format.h>

namespace hoodoo
{

const Schema& film_schema()
{
    using T = ParameterType;
    static const Schema schema{
        "film",
        "The picture: its size, its pixel filter, and how it is shown.",
        {
            {.name = "width",
             .type = T::integer,
             .doc = "Width of the picture.",
             .fallback = std::int64_t{1024},
             .unit = "pixel",
             .minimum = 1,
             .maximum = max_side},
            {.name = "height",
             .type = T::integer,
             .doc = "Height of the picture.",
             .fallback = std::int64_t{576},
             .unit = "pixel",
             .minimum = 1,
             .maximum = max_side},
            {.name = "filter",
             .type = T::choice,
             .doc = "Pixel filter, sampled by importance: a sample belongs to one pixel.",
             .fallback = std::string("blackman-harris"),
             .choices = {"blackman-harris", "gaussian", "box"}},
            {.name = "filter_width",
             .type = T::number,
             .doc = "Diameter of the filter. Without it: 3.3 for blackman-harris, 3 for gaussian, 1 for box.",
             .unit = "pixel",
             .minimum = 0,
             .maximum = 16,
             .above_minimum = true},
            {.name = "exposure",
             .type = T::number,
             .doc = "Applied where the picture is shown (PNG), never in an EXR: each stop doubles the light.",
             .fallback = 0.0,
             .unit = "stop",
             .minimum = -64,
             .maximum = 64},
            {.name = "fps",
             .type = T::number,
             .doc = "Frames a second: turns frames into the time t of expressions, of keys and of moving things.",
             .fallback = 24.0,
             .minimum = 0,
             .maximum = 100000,
             .above_minimum = true},
            {.name = "colorconfig", .type = T::path, .doc = "OpenColorIO configuration. Without it: $OCIO, then the one that is built in."},
            {.name = "display", .type = T::text, .doc = "Display of the colour configuration for PNG. Without it: its default."},
            {.name = "view", .type = T::text, .doc = "View of the display. Without it: its default."},
        }};
    return schema;
}

const Schema& render_schema()
{
    using T = ParameterType;
    static const Schema schema{
        "render",
        "How much work is done for a picture. Threads are no part of a scene: they never change a picture.",
        {
            {.name = "spp",
             .type = T::integer,
             .doc = "Samples a pixel.",
             .fallback = std::int64_t{64},
             .minimum = 1,
             .maximum = static_cast<double>(max_samples)},
            {.name = "max_depth",
             .type = T::integer,
             .doc = "Scattering events of a path at surfaces; 0 = unlimited. Those in haze, foam and water are ended by roulette alone.",
             .fallback = std::int64_t{8},
             .minimum = 0,
             .maximum = 1 << 20},
            {.name = "roulette_depth",
             .type = T::integer,
             .doc = "Scattering events before Russian roulette may end a path. Ground of albedo 0.5 wants 3 or 4, darker ground 2.",
             .fallback = std::int64_t{3},
             .minimum = 0,
             .maximum = 1 << 20},
            {.name = "replicates",
             .type = T::integer,
             .doc = "Independently scrambled repetitions among the samples: 2 or more give an unbiased variance, at the price "
                    "of noise (of 64 samples, 4 cost 20% more variance, 16 cost 34 to 65%).",
             .fallback = std::int64_t{1},
             .minimum = 1,
             .maximum = 4096},
        }};
    return schema;
}

std::vector<Section> scene_sections()
{
    Section terrain{.name = "terrain", .named = true, .types = {}, .schemas = {}};
    for (const CatalogueEntry& row : catalogue()) {
        terrain.types.push_back(row.name);
        terrain.schemas.push_back(&row.schema);
    }
    Section light{.name = "light", .named = true, .types = {}, .schemas = {}};
    for (const Schema& schema : light_schemas()) {
        light.types.push_back(schema.name);
        light.schemas.push_back(&schema);
    }
    Section medium{.name = "medium", .named = true, .types = {}, .schemas = {}};
    for (const Schema& schema : medium_schemas()) {
        medium.types.push_back(schema.name);
        medium.schemas.push_back(&schema);
    }
    return {{"camera", false, {}, {&camera_schema()}},
            {"film", false, {}, {&film_schema()}},
            {"render", false, {}, {&render_schema()}},
            {"haze", false, {}, {&haze_schema()}},
            std::move(terrain),
            {"material", true, {}, {&material_schema()}},
            std::move(medium),
            std::move(light)};
}

std::string too_large(std::int64_t width, std::int64_t height, std::int64_t samples)
{
    // 25 channels of four bytes are the least that a film keeps of a pixel.
    constexpr double bytes_a_pixel = 100.0;
    if (width * height > max_pixels)
        return fmt::format("{} x {} pixels are too many (at least {:.0f} GB), expected at most {}", width, height,
                           static_cast<double>(width) * static_cast<double>(height) * bytes_a_pixel / 1e9, max_pixels);
    if (samples > max_samples) return fmt::format("{} samples a pixel are too many, expected at most {}", samples, max_samples);
    return {};
}

}  // namespace hoodoo
