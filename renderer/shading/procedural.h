// Rock, sand and soil without any file: colour and relief as functions of space, band-limited by the footprint of the lookup.
#pragma once

#include "terrain/surface.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

enum class Procedure : std::uint8_t { plain, sand, bedrock, rock, soil, water };

/// Names as the scene writes them, in the order of the enumeration.
const std::vector<std::string>& procedure_names();

/// A colour ramp's stops in the rendering space; what each means is the procedure's own affair.
using Palette = std::array<Vec3f, 5>;

/// The palette of a procedure in linear Rec.709, to be converted.
const Palette& procedure_palette(Procedure procedure);

struct Pattern {
    Vec3f albedo{0.5f};
    Vec3d relief{0.0};           ///< gradient of the height along the normal, per metre, world space
    double lost_variance = 0.0;  ///< variance of the slopes of relief that the footprint was too wide to show
};

/// Pure. `footprint` in metres: every detail of wavelength under twice the footprint is replaced by its mean.
Pattern evaluate_procedure(Procedure procedure, const Palette& palette, std::uint64_t seed, const Interaction& at, double footprint);

/// Relative change of the albedo on scales from 100 m down to 10 m, mean 0, within [-1, 1]; 0 for footprints that average it out.
double large_scale_variation(std::uint64_t seed, const Vec3d& p, double footprint);

/// Share of a detail of that wavelength which a lookup of that footprint still shows: 1 down to 4 footprints, 0 from 2 on.
double kept_share(double wavelength, double footprint);

}  // namespace hoodoo
