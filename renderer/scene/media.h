// What fills the scene between its surfaces, from the tables that say so: [medium.NAME], [haze], and a material's `ior` and `medium`.
#pragma once

#include "renderer/media/media.h"
#include "renderer/scene/description.h"
#include "terrain/surface.h"

#include <map>
#include <optional>
#include <span>
#include <string>

namespace hoodoo
{

/// One schema a kind; its name is the `type` of a [medium.NAME] table.
std::span<const Schema> medium_schemas();

/// A surface of the scene that may carry a density.
struct DensityCarrier {
    std::string name;
    const Surface* surface = nullptr;
};

/// Haze and regions. Throws Error (scene) at the value's position for a terrain that is not there or carries no density.
Media make_media(const Description& description, std::span<const DensityCarrier> carriers, const ColorConversion& to_rendering);

/// The bodies that light passes, by the names of their materials. Throws Error (scene) for a medium that is not there, one that is no even medium,
/// and one of a material that light does not pass.
std::map<std::string, Interior> make_interiors(const Description& description, const ColorConversion& to_rendering);

/// What a material is that no table describes: clear water, if water is its name.
std::optional<Interior> default_interior(const std::string& material, const ColorConversion& to_rendering);

/// Vertical optical depth of the scene's haze at 550 nm, from its base up: the part of a clear sky's aerosol that is between the things of the scene
/// and not to be counted twice.
double haze_depth(const Values& haze);

}  // namespace hoodoo
