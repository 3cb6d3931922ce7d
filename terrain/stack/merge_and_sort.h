// How every edit ends: loose material settles in its pocket, equal neighbours become one layer.
#pragma once

#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// What is loose, in the order in which it lies in a pocket, from the floor up.
constexpr std::array<Material, 4> kLooseOrder = {Material::sand, Material::soil, Material::rock, Material::water};

/// The layers of one column after settling. Between two layers of bedrock (a pocket; the last one is open above) the thicknesses of each material are
/// summed and laid down in the order sand, soil, rock, water, air. Thickness of every material is kept.
std::vector<Layer> merge_and_sort(std::span<const Layer> layers);

}  // namespace hoodoo
