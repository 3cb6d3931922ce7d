// What the [[edit]] tables of all terrains share: a tool found by its name, a name that seeds noise, a check of tables that come without a scene.
#pragma once

#include "terrain/error.h"
#include "terrain/schema.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// The key `name` of every [[edit]] table.
Parameter edit_name_parameter();

/// What the edit's noise is hashed from: `seed`, its terrain's, and its name; without a name its number.
std::uint64_t edit_seed(const Values& edit, std::uint64_t seed, std::size_t number);

/// A terrain's parameter `edit` and nothing else, whose tables are these: what checked_edit() reads against.
Schema edit_list_schema(std::vector<Schema> tools);

/// Checks a table that stands in no scene: `parameters` are what an [[edit]] table holds beside its `tool`. Throws Error (scene) with all problems
/// of the table at once. The result keeps a reference to `list`.
Values checked_edit(const Schema& list, const std::string& tool, const Node& parameters);

/// The tool that a checked table names. Tool has a `schema`.
template <class Tool>
const Tool& tool_of(std::span<const Tool> tools, const Values& edit)
{
    const auto tool = std::find_if(tools.begin(), tools.end(), [&](const Tool& t) { return t.schema.name == edit.variant(); });
    if (tool == tools.end()) throw Error(ErrorKind::internal, "no edit tool is called " + edit.variant());
    return *tool;
}

}  // namespace hoodoo
