// Every edit tool, one row each: open this file first. A tool is made in terrain/edit/NAME.cpp, which says what it does and from which paper.
// As in Peytavie2009, section 3.4, an edit ends by itself with merge, sort and stabilisation of what it touched.
#include "terrain/edit/tools.h"

#include "terrain/edit/rows.h"
#include "terrain/error.h"
#include "terrain/math/hash.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

std::span<const EditTool> edit_tools()
{
    // clang-format off
    static const std::vector<EditTool> rows = {
        sculpt_tool(),
        sweep_tool(),
        deposit_tool(),
        erode_tool(),
        fill_tool(),
        stabilise_tool(),
        crack_tool(),
    };
    // clang-format on
    return rows;
}

std::vector<Schema> edit_schemas()
{
    std::vector<Schema> schemas;
    for (const EditTool& tool : edit_tools()) {
        Schema& schema = schemas.emplace_back(tool.schema);
        schema.parameters.push_back(
            {.name = "name", .type = ParameterType::text, .doc = "Seeds the edit's noise; by default its number.", .fallback = std::string()});
        schema.parameters.push_back({.name = "stabilise",
                                     .type = ParameterType::boolean,
                                     .doc = "Whether loose material that the edit touched comes to rest at once.",
                                     .fallback = true});
    }
    return schemas;
}

ColumnSet apply_edit(MaterialStack& stack, const Values& edit, std::uint64_t seed, std::size_t number, EditContext context)
{
    const auto tools = edit_tools();
    const auto tool = std::find_if(tools.begin(), tools.end(), [&](const EditTool& t) { return t.schema.name == edit.variant(); });
    if (tool == tools.end()) throw Error(ErrorKind::internal, "no edit tool is called " + edit.variant());
    const std::string& name = edit.text("name");
    context.seed = hash_name(seed, name.empty() ? fmt::format("edit {}", number) : name);
    ColumnSet changed = tool->apply(stack, edit, context);
    if (edit.boolean("stabilise") && !tool->settles) changed.add(stabilise(stack, changed, context.repose));
    return changed;
}

ColumnSet apply_edit(MaterialStack& stack, const std::string& tool, const Node& parameters, std::uint64_t seed, std::size_t number,
                     EditContext context)
{
    // As a terrain's list of edits with one item, so that the same checks speak the same words.
    static const Schema schema{"edits", "", {{.name = "edit", .type = ParameterType::tables, .discriminator = "tool", .items = edit_schemas()}}};
    Node chosen = parameters, name, list, table;
    name.where = name.key_where = list.where = list.key_where = table.where = parameters.where;
    name.value = tool;
    if (auto* entries = std::get_if<Node::Table>(&chosen.value)) entries->emplace_back("tool", std::move(name));
    list.value = Node::Array{std::move(chosen)};
    table.value = Node::Table{{"edit", std::move(list)}};
    std::vector<Problem> problems;
    const Values values = check(schema, table, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, std::move(problems));
    return apply_edit(stack, values.tables("edit")[0], seed, number, std::move(context));
}

}  // namespace hoodoo
