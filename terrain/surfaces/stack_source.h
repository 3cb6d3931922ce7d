// From the tables of a scene to a layer stack: layers bottom to top, then edits in their order.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/edit/tools.h"
#include "terrain/stack/material_stack.h"

#include <memory>

namespace hoodoo
{

/// What any row that stands on a stack accepts: a grid and [[layer]] tables, or a file of them; the kernel; [[edit]] tables.
std::vector<Parameter> stack_parameters();

/// Half-width of the kernel, metres, from `sigma` or `sigma_cells`. Throws Error (scene) if it is too wide.
double stack_kernel(const Values& values, double cell);

/// What the terrain's edits go by; `cell` is the width of its columns, metres.
EditContext edit_context(const Values& values, const BuildContext& context, double cell);

/// Throws Error (scene, file) at the value that cannot be.
std::shared_ptr<MaterialStack> make_stack(const Values& values, const BuildContext& context);

}  // namespace hoodoo
