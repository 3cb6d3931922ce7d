// The edit tools of the layer stack, one row each: an operator from stack to stack with a schema, usable from scenes and from every host.
#pragma once

#include "terrain/edit/stabilise.h"
#include "terrain/schema.h"
#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

struct EditContext {
    double sigma = 0.0;      ///< half-width of the terrain's kernel, metres, for tools that work on its surface; 0 = one cell
    std::uint64_t seed = 0;  ///< hashed from the edit's name
    Repose repose = {};      ///< what the terrain's materials bear
    /// A file named in a scene -> the path to open, as BuildContext::resolve.
    std::function<std::string(const std::string& path, const Source& where)> resolve = [](const std::string& p, const Source&) { return p; };
};

struct EditTool {
    Schema schema;  ///< its name is the `tool` of an [[edit]] table
    /// Changes the stack; returns the columns whose layers differ afterwards. Throws Error (scene) at the value that cannot be, and then leaves the
    /// stack as it was. The tool need not settle what it left: apply_edit does, unless the tool `settles` by itself.
    std::function<ColumnSet(MaterialStack&, const Values&, const EditContext&)> apply;
    bool settles = false;
};

/// All tools, in a fixed order. Built once, thread-safe.
std::span<const EditTool> edit_tools();

/// What an [[edit]] table accepts, one schema a tool: the tool's own parameters and those that all tools share (name, stabilise).
std::vector<Schema> edit_schemas();

/// Applies one checked [[edit]] table, the `number`-th of its terrain, and stabilises the columns it touched, and what slides from them, unless it
/// says `stabilise = false`. `seed` is the terrain's; the edit's own is hashed from its name, by default its number. Returns the columns that may
/// differ afterwards: all others keep their bits. If stabilising throws (an angle of `context.repose` out of range), the edit itself is done.
ColumnSet apply_edit(MaterialStack& stack, const Values& edit, std::uint64_t seed, std::size_t number, EditContext context = {});

/// The same for a table that nobody has checked yet: `parameters` are what an [[edit]] table holds beside its `tool`. Throws Error (scene) with all
/// problems of the table at once.
ColumnSet apply_edit(MaterialStack& stack, const std::string& tool, const Node& parameters, std::uint64_t seed, std::size_t number,
                     EditContext context = {});

}  // namespace hoodoo
