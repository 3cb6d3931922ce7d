// The edit tools of voxels, one row each: what changes a grid in place.
#pragma once

#include "terrain/fields/voxel_grid.h"
#include "terrain/schema.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

struct VoxelTool {
    Schema schema;  ///< its name is the `tool` of an [[edit]] table
    /// `seed` is hashed from the edit's name. Throws Error (scene) at the value that cannot be, and then leaves the grid as it was.
    std::function<void(VoxelGrid&, const Values&, std::uint64_t seed)> apply;
};

/// All tools, in a fixed order. Built once, thread-safe.
std::span<const VoxelTool> voxel_tools();

/// What an [[edit]] table of voxels accepts, one schema a tool: its own parameters and a name.
std::vector<Schema> voxel_edit_schemas();

/// Applies one checked [[edit]] table, the `number`-th of its terrain, and trims the grid. `seed` is the terrain's.
void apply_voxel_edit(VoxelGrid& grid, const Values& edit, std::uint64_t seed, std::size_t number);

/// The same for a table that nobody has checked yet: `parameters` are what an [[edit]] table holds beside its `tool`. Throws Error (scene) with all
/// problems of the table at once.
void apply_voxel_edit(VoxelGrid& grid, const std::string& tool, const Node& parameters, std::uint64_t seed, std::size_t number);

}  // namespace hoodoo
