// TOML text -> Node, within limits that hold before anything is allocated.
#pragma once

#include "terrain/schema.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hoodoo
{

/// What all files and insertions of one scene may use together. Each part takes its share; nothing is left of a hostile one.
struct SceneBudget {
    std::size_t bytes = std::size_t{64} << 20;
    std::size_t nodes = 100000;

    bool take(std::size_t byte_count, std::size_t node_count);  ///< false if there is not enough left
};

constexpr int max_nesting = 64;  ///< tables and lists inside each other

/// Parses TOML 1.0. What is wrong (syntax, limits, dates, nan and inf) becomes a Problem; the result is then incomplete. `file` goes into every
/// Source.
Node parse_toml(const std::string& text, const std::string& file, SceneBudget& budget, std::vector<Problem>& problems);

/// One value given on a command line: TOML if it is a value of TOML, else a text. `where` becomes its position.
Node parse_toml_value(const std::string& text, const Source& where);

}  // namespace hoodoo
