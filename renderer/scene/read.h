// Scene text -> Description: parse, include, parameters, expressions, check; all problems of a file at once.
#pragma once

#include "renderer/scene/description.h"

#include <string>

namespace hoodoo
{

/// Reads a scene from a path, or from the text itself if `is_text` (its relative paths then start at the current folder, the only root it may
/// read from). Throws Error: `scene` (all problems at once), `file` where a file is absent or unreadable. Opens the scene, its includes and nothing
/// else. Thread-safe.
Description read_scene(const std::string& path_or_text, bool is_text, const SceneOverrides& overrides = {});

/// Names what a tree says: keys sorted, numbers as they compare; places in files do not matter.
std::uint64_t hash_of(const Node& root, std::uint64_t seed);

}  // namespace hoodoo
