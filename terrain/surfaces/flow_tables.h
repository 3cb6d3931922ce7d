// Flows from the [[flow]] tables of a scene.
#pragma once

#include "terrain/fields/flow.h"
#include "terrain/schema.h"

#include <cstdint>

namespace hoodoo
{

/// One schema for each kind of flow, with the parameters that all share (strength, drift, mask).
std::vector<Schema> flow_schemas();

/// The sum of the tables' flows, each scaled, drifting and masked as it says; seeds are hashed from the tables' names under `seed`. With a view
/// octaves of noise fade by the distance; patterns that drift for `longest` do so for less of it.
/// Throws Error (scene) at the value that cannot be.
FlowPtr make_flow(const std::vector<Values>& tables, std::uint64_t seed, const std::optional<DetailView>& view = {}, double longest = 0.0);

}  // namespace hoodoo
