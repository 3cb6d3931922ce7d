// Where one material turns into another: by slope, by altitude, by a map of what was measured on the ground.
#pragma once

#include "renderer/shading/look.h"

#include <memory>
#include <string>
#include <vector>

namespace hoodoo
{

/// What a [[material.NAME.mask]] table accepts, one schema for each way to decide (its name is the value of `by`).
std::vector<Schema> mask_schemas();

/// The look of a material that has no masks of its own.
using PlainLook = std::function<std::unique_ptr<Look>(const std::string& material)>;

/// `look` with the masks of its material's table, or itself where the table has none. Masks with one `into` are multiplied; the materials they turn
/// into are laid over the look in the order in which they first appear. Throws Error: a map that cannot be read, limits that do not differ.
std::unique_ptr<Look> with_masks(std::unique_ptr<Look> look, const Values& material, const PathResolver& resolve, const PlainLook& plain);

}  // namespace hoodoo
