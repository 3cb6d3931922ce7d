// What a scene file said, checked but not yet built: plain data.
#pragma once

#include "terrain/schema.h"

#include <functional>
#include <string>
#include <vector>

namespace hoodoo {

/// A named table [KIND.NAME] with a `type`.
struct DescribedNode {
    std::string name;
    std::string type;       ///< catalogue row of a terrain, kind of a light; "" where a section has no types
    Values values;
    std::uint64_t seed = 0; ///< hashed from the scene's seed and the name, or the node's own `seed`
    Source where;
};

struct Description {
    std::string file;       ///< as given; "<text>" for a text
    std::uint64_t hash = 0; ///< of everything the file and its includes said, after parameters: names the scene in an EXR
    std::uint64_t seed = 0; ///< scene seed from `seed`, `--seed`
    Values camera, film, render;
    std::vector<DescribedNode> terrains, materials, lights;
    std::function<std::string(const std::string& path, const Source& where)> resolve;   ///< confines files to the declared roots
};

}  // namespace hoodoo
