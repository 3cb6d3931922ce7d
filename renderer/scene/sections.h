// What a scene consists of: its sections and their schemas. Parsing, the JSON Schema and the help all follow from this list.
#pragma once

#include "terrain/schema.h"

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

/// width, height, filter ("blackman-harris", "gaussian", "box"), filter_width (pixels; absent: the filter's own), exposure (stops, of the PNG alone),
/// fps, colorconfig, display, view (absent: the colour configuration's defaults).
const Schema& film_schema();

/// spp, max_depth (scattering events; 0 = unlimited), roulette_depth, replicates.
const Schema& render_schema();

/// A section [NAME], or [KIND.NAME] for as many names as there are.
struct Section {
    std::string name;                    ///< "camera", "terrain"
    bool named = false;                  ///< [terrain.NAME]
    std::vector<std::string> types;      ///< values of the key `type`; empty: no such key, and one schema
    std::vector<const Schema*> schemas;  ///< one for each type
};

/// camera, film, render, haze, terrain, material, medium, light.
std::vector<Section> scene_sections();

constexpr std::int64_t max_side = 65536;         ///< pixels
constexpr std::int64_t max_pixels = 1ll << 28;   ///< 16384 x 16384
constexpr std::int64_t max_samples = 1ll << 24;  ///< a pixel, over all replicates: a float still counts them exactly

/// What a picture of this size costs at least, in words, if it is over the limits; "" if it is not. Nothing is allocated to find out.
std::string too_large(std::int64_t width, std::int64_t height, std::int64_t samples);

}  // namespace hoodoo
