// The fixed sections of a scene, [film] and [render], as schemas. [camera] is in camera.h, lights in light.h, materials in look.h, terrains in the catalogue.
#pragma once

#include "terrain/schema.h"

namespace hoodoo {

/// width, height, filter ("blackman-harris", "gaussian", "box"), filter_width (pixels; absent: the filter's own), exposure (stops, of the PNG alone),
/// colorconfig, display, view (absent: the colour configuration's defaults). width * height never exceeds max_pixels.
const Schema& film_schema();

/// spp, max_depth (scattering events; 0 = unlimited), roulette_depth, replicates. spp * replicates never exceeds max_samples.
const Schema& render_schema();

constexpr std::int64_t max_side = 65536;            ///< pixels
constexpr std::int64_t max_pixels = 1ll << 28;      ///< 268 million: 16384 x 16384
constexpr std::int64_t max_samples = 1ll << 24;     ///< a pixel: a float still counts them exactly

}  // namespace hoodoo
