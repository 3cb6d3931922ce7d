// What a scene file said, checked but not yet built: plain data.
#pragma once

#include "terrain/schema.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hoodoo
{

/// Applied while reading: `-D key=value` fills [params], `--set path.to.key=value` replaces a value (or gives one that the file leaves out).
/// Values are TOML; what is no TOML value is a text. Expressions also know `frame` and `t` = frame / film.fps.
struct SceneOverrides {
    std::vector<std::pair<std::string, std::string>> params, sets;
    std::optional<std::uint64_t> seed;
    std::optional<std::int64_t> frame;       ///< 0 without; `-D frame=` goes before it
    std::vector<std::string> allowed_roots;  ///< folders that files may be read from, beside the scene's own folder and what lies below it
};

/// A named table [KIND.NAME] with a `type`.
struct DescribedNode {
    std::string name;
    std::string type;  ///< catalogue row of a terrain, kind of a light or medium; "" where a section has no types
    Values values;
    std::uint64_t seed = 0;  ///< hashed from the scene's seed and the name, or the node's own `seed`
    Source where;
    std::optional<bool> visible = {};  ///< of a terrain: whether it is rendered itself; absent: unless another stands on it
};

struct Description {
    std::string file;        ///< as given; "<text>" for a text
    std::uint64_t hash = 0;  ///< of everything the file and its includes said, after parameters: names the scene in an EXR
    std::uint64_t seed = 0;  ///< scene seed from `seed`, `--seed`
    std::int64_t frame = 0;
    double time = 0.0;  ///< seconds: the value of `t`
    Values camera, film, render, haze;
    std::vector<DescribedNode> terrains, materials, media, lights;
    std::function<std::string(const std::string& path, const Source& where)> resolve;  ///< confines files to the declared roots
};

}  // namespace hoodoo
