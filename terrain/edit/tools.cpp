// Every edit tool, one row each: open this file first. A tool is made in terrain/edit/NAME.cpp, which says what it does and from which paper.
// As in Peytavie2009, section 3.4, an edit ends by itself with merge, sort and stabilisation of what it touched.
#include "terrain/edit/tools.h"

#include "terrain/edit/edit_table.h"
#include "terrain/edit/rows.h"

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
        schema.parameters.push_back(edit_name_parameter());
        schema.parameters.push_back({.name = "stabilise",
                                     .type = ParameterType::boolean,
                                     .doc = "Whether loose material that the edit touched comes to rest at once.",
                                     .fallback = true});
    }
    return schemas;
}

ColumnSet apply_edit(MaterialStack& stack, const Values& edit, std::uint64_t seed, std::size_t number, EditContext context)
{
    const EditTool& tool = tool_of(edit_tools(), edit);
    context.seed = edit_seed(edit, seed, number);
    ColumnSet changed = tool.apply(stack, edit, context);
    if (edit.boolean("stabilise") && !tool.settles) changed.add(stabilise(stack, changed, context.repose));
    return changed;
}

ColumnSet apply_edit(MaterialStack& stack, const std::string& tool, const Node& parameters, std::uint64_t seed, std::size_t number,
                     EditContext context)
{
    static const Schema schema = edit_list_schema(edit_schemas());
    return apply_edit(stack, checked_edit(schema, tool, parameters), seed, number, std::move(context));
}

}  // namespace hoodoo
