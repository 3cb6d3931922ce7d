// Editing the layers of a scene that stays alive: what an interactive host does between two pictures.
#pragma once

#include "renderer/render.h"
#include "terrain/stack/column_set.h"

#include <string>

namespace hoodoo
{

/// Applies `tool` with the parameters of an [[edit]] table, as if it were the next one of the terrain in the scene's file, and makes anew what it
/// touched of surface, rocks and acceleration structure: pictures afterwards have the bits of a scene that was loaded with that table. An empty
/// `terrain` means the only one. Returns the columns that may have changed. Not while others use the scene.
/// Throws Error (scene): a scene that was not loaded for edits, no such terrain, one without layers or one that others stand on, an unknown tool, a
/// value that cannot be: nothing has changed then. If the camera stands inside the ground afterwards, or there are too many rocks, the edit is done.
ColumnSet edit_scene(LoadedScene& loaded, const std::string& terrain, const std::string& tool, const Node& parameters);

}  // namespace hoodoo
