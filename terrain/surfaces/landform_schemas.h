// What each kind of landform node may say.
#pragma once

#include "terrain/schema.h"

#include <vector>

namespace hoodoo
{

std::vector<Schema> landform_node_schemas();

}  // namespace hoodoo
