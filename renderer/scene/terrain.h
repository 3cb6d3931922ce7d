// From a described terrain to the catalogue row that makes it.
#pragma once

#include "renderer/scene/description.h"
#include "terrain/catalogue.h"

namespace hoodoo
{

/// The row that `node.type` names. Throws Error (scene) at the node if there is none.
const CatalogueEntry& terrain_row(const DescribedNode& node);

/// What the row's factories get beside the parameters. `progress` may be empty; it is told the terrain's name with what is being done.
BuildContext terrain_context(const DescribedNode& node, const Description& description, int threads,
                             const std::function<void(double fraction, const std::string& what)>& progress);

/// The terrain called `name`; without a name the only one. Throws Error (scene) that lists the names.
const DescribedNode& choose_terrain(const Description& description, const std::string& name);

}  // namespace hoodoo
