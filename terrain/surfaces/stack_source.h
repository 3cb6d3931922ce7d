// From the tables of a scene to a layer stack: layers bottom to top, then edits in their order.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/stack/material_stack.h"

#include <memory>

namespace hoodoo
{

/// What any row that stands on a stack accepts: grid, [[layer]] tables, [[edit]] tables.
std::vector<Parameter> stack_parameters();

/// Throws Error (scene, file) at the value that cannot be.
std::shared_ptr<MaterialStack> make_stack(const Values& values, const BuildContext& context);

}  // namespace hoodoo
