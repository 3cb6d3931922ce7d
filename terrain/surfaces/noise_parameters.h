// Parameters of a sum of noise as a height: what terrains and parts of terrains made of it have in common.
#pragma once

#include "terrain/fields/elevation.h"
#include "terrain/schema.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// `kind_name` (fbm, ridged, billow, multifractal), relief, wavelength, octaves, lacunarity, gain.
std::vector<Parameter> noise_parameters(const std::string& kind_name, double octaves);

/// Reads them; all else stays as it is by default.
ElevationShape read_noise(const Values& values, const std::string& kind_name);

}  // namespace hoodoo
