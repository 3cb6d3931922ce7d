// What a scene may say about rocks, for every row that has them.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/rocks/stack_rocks.h"
#include "terrain/stack/material_stack.h"

#include <memory>

namespace hoodoo
{

/// The parameters rock_size, rocks_per_tile, ... `size` is the default of rock_size, metres; 0: two columns of the row's stack.
std::vector<Parameter> rock_parameters(double size);

/// Throws Error (scene) at the value that cannot be. `cell` is the width of a column, metres (used where rock_size is not given).
RockOptions rock_options(const Values& values, const BuildContext& context, double cell);

/// The rocks in the rock layers of a stack. If they are to follow edits (context.editable) the means to do so come with them.
class LyingRocks
{
public:
    /// Throws Error (scene) as place_rocks.
    LyingRocks(std::shared_ptr<const MaterialStack> stack, Border border, const Values& values, const BuildContext& context);

    Instances rocks;

    /// The stack was edited there and nowhere else. Not while other threads use the rocks.
    InstanceChange follow(const ColumnSet& changed);
    double overhang() const { return placement_ ? placement_->overhang() : 0.0; }  ///< how far rocks may stick out of their layer, metres

private:
    std::shared_ptr<const MaterialStack> stack_;
    std::shared_ptr<StackRocks> volume_;
    std::unique_ptr<RockPlacement> placement_;  ///< none: no rocks, and none to come
};

}  // namespace hoodoo
