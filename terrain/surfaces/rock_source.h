// What a scene may say about rocks, for every row that has them.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/rocks/placement.h"
#include "terrain/stack/material_stack.h"

#include <memory>

namespace hoodoo
{

/// The parameters rock_size, rocks_per_tile, ... `size` is the default of rock_size, metres; 0: two columns of the row's stack.
std::vector<Parameter> rock_parameters(double size);

/// Throws Error (scene) at the value that cannot be. `cell` is the width of a column, metres (used where rock_size is not given).
RockOptions rock_options(const Values& values, const BuildContext& context, double cell);

/// The rocks in the rock layers of a stack; no instances if it has none.
Instances stack_rocks(std::shared_ptr<const MaterialStack> stack, Border border, const Values& values, const BuildContext& context);

}  // namespace hoodoo
