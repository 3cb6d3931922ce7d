// The parameters of a breaking sea: what a scene says about swell, waves, ripples and foam, and what it means in metres.
#pragma once

#include "terrain/fields/breaking_sea.h"
#include "terrain/fields/foam.h"
#include "terrain/fields/ripples.h"
#include "terrain/schema.h"

namespace hoodoo
{

/// Everything about the water but how it is traced. Horizontal places are relative to the sea's origin, heights to its level.
struct SeaDescription {
    std::vector<Breaker> breakers;
    Swells swell;
    RippleShape ripples;
    FoamShape foam;
};

/// Parameters about the water itself.
std::vector<Parameter> sea_parameters();

/// Throws Error (scene) at the value that cannot be. `seed` is the terrain's.
SeaDescription read_sea(const Values& values, std::uint64_t seed);

}  // namespace hoodoo
