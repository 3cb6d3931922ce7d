// An edit without a scene is checked as a terrain's list of edits with one item, so that the same checks speak the same words.
#include "terrain/edit/edit_table.h"

#include "terrain/math/hash.h"

#include <fmt/format.h>

namespace hoodoo
{

Parameter edit_name_parameter()
{
    return {.name = "name", .type = ParameterType::text, .doc = "Seeds the edit's noise; by default its number.", .fallback = std::string()};
}

std::uint64_t edit_seed(const Values& edit, std::uint64_t seed, std::size_t number)
{
    const std::string& name = edit.text("name");
    return hash_name(seed, name.empty() ? fmt::format("edit {}", number) : name);
}

Schema edit_list_schema(std::vector<Schema> tools)
{
    return {"edits", "", {{.name = "edit", .type = ParameterType::tables, .discriminator = "tool", .items = std::move(tools)}}};
}

Values checked_edit(const Schema& list, const std::string& tool, const Node& parameters)
{
    Node chosen = parameters, name, edits, table;
    name.where = name.key_where = edits.where = edits.key_where = table.where = parameters.where;
    name.value = tool;
    if (auto* entries = std::get_if<Node::Table>(&chosen.value)) entries->emplace_back("tool", std::move(name));
    edits.value = Node::Array{std::move(chosen)};
    table.value = Node::Table{{"edit", std::move(edits)}};
    std::vector<Problem> problems;
    const Values values = check(list, table, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, std::move(problems));
    return values.tables("edit")[0];
}

}  // namespace hoodoo
