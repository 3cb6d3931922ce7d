// The [[edit]] table of the sweeping tool.
#pragma once

#include "terrain/edit/sweep.h"
#include "terrain/schema.h"

namespace hoodoo
{

Schema sweep_schema();

/// The tool that a checked table describes. Throws Error (scene) at the value that cannot be.
SweepTool read_sweep(const Values& edit, std::uint64_t seed);

}  // namespace hoodoo
