// [[node]] tables of a scene -> a tree of landforms.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/fields/landform.h"

#include <vector>

namespace hoodoo
{

/// The tree of the row's tables `node`; it covers the plane. Throws Error (scene, file) at what cannot be.
LandformPtr make_landform_tree(const Values& row, const BuildContext& context);

}  // namespace hoodoo
