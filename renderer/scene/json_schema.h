// The parameter schemas as one JSON Schema, for editors that complete and check scenes while they are written.
#pragma once

#include <string>

namespace hoodoo
{

/// Draft-07, indented. A scene refers to it in its first line: `#:schema PATH`. Accepts what read_scene accepts of one file, apart from sizes of
/// products.
std::string scene_json_schema();

}  // namespace hoodoo
