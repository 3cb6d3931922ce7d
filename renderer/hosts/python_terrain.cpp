// Terrains without a scene: stacks from lists, their convolution field, and every field that a catalogue row has.
//
// Everything here is a value that Python owns; results are new arrays.

#include "renderer/hosts/python_values.h"

#include "terrain/catalogue.h"
#include "terrain/edit/tools.h"
#include "terrain/math/hash.h"
#include "terrain/stack/convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace hoodoo::python
{

namespace
{

using LayerTuple = std::pair<std::string, double>;
using ColumnLists = std::vector<std::vector<std::vector<LayerTuple>>>;

double default_unit(const ColumnLists& columns)
{
    double highest = 0.0;
    for (const auto& row : columns)
        for (const auto& column : row)
            for (const auto& layer : column) highest = std::max(highest, layer.second);
    return highest > 0.0 ? highest / 8000.0 : 1.0;
}

std::shared_ptr<MaterialStack> stack_from(double cell, const ColumnLists& columns, const std::array<double, 3>& origin, std::optional<double> unit)
{
    if (columns.empty() || columns.front().empty()) refuse("columns is empty", "columns[i][j] with at least one column");
    const Vec2i size(static_cast<int>(columns.size()), static_cast<int>(columns.front().size()));
    const double quantum = unit ? *unit : default_unit(columns);
    auto stack = std::make_shared<MaterialStack>(size, cell, quantum, Vec3d(origin[0], origin[1], origin[2]));

    std::vector<std::vector<Layer>> packed;
    packed.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    for (int j = 0; j < size.y; ++j)
        for (int i = 0; i < size.x; ++i) {
            const auto& row = columns[static_cast<std::size_t>(i)];
            if (row.size() != columns.front().size())
                refuse("columns[" + std::to_string(i) + "] has another length than columns[0]", std::to_string(size.y), std::to_string(row.size()));
            std::vector<Layer>& layers = packed.emplace_back();
            for (const auto& [name, top] : row[static_cast<std::size_t>(j)]) {
                const double units = std::nearbyint(top / quantum);
                if (!(units >= 0.0 && units <= MaterialStack::max_top))
                    refuse("a top of columns[" + std::to_string(i) + "][" + std::to_string(j) + "] is out of range",
                           "0 to " + std::to_string(MaterialStack::max_top * quantum) + " m (8191 units)", std::to_string(top));
                layers.push_back({material_from_name(name), static_cast<std::int32_t>(units)});
            }
        }
    stack->set_columns(Vec2i(0, 0), size, packed);
    return stack;
}

ColumnLists columns_of(const MaterialStack& stack)
{
    ColumnLists columns(static_cast<std::size_t>(stack.size().x));
    for (int i = 0; i < stack.size().x; ++i)
        for (int j = 0; j < stack.size().y; ++j) {
            auto& column = columns[static_cast<std::size_t>(i)].emplace_back();
            for (const Layer& layer : stack.column(i, j)) column.emplace_back(material_name(layer.material), layer.top * stack.unit());
        }
    return columns;
}

FieldHandle convolution_of(std::shared_ptr<MaterialStack> stack, double sigma, const std::vector<std::string>& materials, const std::string& border,
                           double base)
{
    if (!(sigma > 0.0 && std::isfinite(sigma))) refuse("sigma is out of range", "a finite number above 0 (metres)", std::to_string(sigma));
    if (border != "extend" && border != "cut") refuse("border is unknown", "\"extend\" or \"cut\"", "\"" + border + "\"");
    if (!(base >= 0.0 && base / stack->unit() < 1e8)) refuse("base is out of range", "0 to 1e8 units (metres)", std::to_string(base));
    MaterialSet set = 0;
    for (const std::string& name : materials) set = static_cast<MaterialSet>(set | material_set({material_from_name(name)}));
    const auto units = static_cast<std::int32_t>(std::nearbyint(base / stack->unit()));
    auto field = std::make_shared<ConvolutionField>(Ground(stack, set, border == "cut" ? Border::cut : Border::extend, units), sigma);
    const Field* raw = field.get();
    return {std::move(field), raw};
}

FieldHandle field_of_row(const std::string& type, const py::kwargs& parameters)
{
    const CatalogueEntry* row = find_in_catalogue(type);
    if (!row) {
        std::vector<std::string> names;
        for (const CatalogueEntry& entry : catalogue()) names.push_back(entry.name);
        throw Error(ErrorKind::scene,
                    Problem{{"<python>", 0, 0, {}}, "the catalogue has no row \"" + type + "\"", {}, {}, nearest_name(type, names)});
    }
    std::vector<Problem> problems;
    const Values values = check(row->schema, node_from(parameters, type), problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.name = type;
    context.seed = hash_name(0, type);
    auto shape = std::make_shared<Shape>(row->make(values, context));
    const auto* surface = std::get_if<std::unique_ptr<Surface>>(shape.get());
    const Field* field = surface ? (*surface)->field() : nullptr;
    if (!field) refuse("the row \"" + type + "\" has no field", "a terrain given by an implicit function");
    return {std::move(shape), field};
}

py::array_t<std::int32_t> edit_stack(MaterialStack& stack, const std::string& tool, std::uint64_t seed, const py::kwargs& parameters)
{
    const Node node = node_from(parameters, tool);
    return columns_array([&] {
        const py::gil_scoped_release free;
        return apply_edit(stack, tool, node, seed, 0);
    }());
}

py::list catalogue_rows()
{
    py::list rows;
    for (const CatalogueEntry& entry : catalogue()) {
        py::dict row = described(entry.schema);
        row["name"] = entry.name;
        row["paper"] = entry.paper;
        rows.append(row);
    }
    return rows;
}

py::list tool_rows()
{
    py::list rows;
    for (const Schema& schema : edit_schemas()) rows.append(described(schema));
    return rows;
}

}  // namespace

py::dict described(const Schema& schema)
{
    py::dict parameters;
    for (const Parameter& p : schema.parameters) parameters[py::str(p.name)] = p.doc + (p.unit.empty() ? "" : " [" + p.unit + "]");
    py::dict row;
    row["name"] = schema.name;
    row["doc"] = schema.doc;
    row["parameters"] = parameters;
    return row;
}

void add_terrain(py::module_& module)
{
    py::class_<MaterialStack, std::shared_ptr<MaterialStack>>(module, "MaterialStack", "Layers of material over a grid of columns.")
        .def(py::init(&stack_from), py::arg("cell"), py::arg("columns"), py::arg("origin") = std::array<double, 3>{0.0, 0.0, 0.0},
             py::arg("unit") = py::none(),
             "MaterialStack(cell, columns, origin=(0, 0, 0), unit=None)\n\ncell: width of a column, metres. columns[i][j]: [(material name, top), "
             "...] from bottom to top, i along x, j along y; "
             "top: metres above the origin. Materials: air, water, sand, bedrock, rock, soil. Below the origin there is bedrock, above the last "
             "layer air.\n"
             "unit: the height quantum in metres, None: the highest top / 8000. Heights are ROUNDED to whole units (at most 8191 of them), equal "
             "neighbours merged.\n"
             "Raises hoodoo.Error: an unknown material, tops that decrease or are out of range, rows of different length.")
        .def_property_readonly("columns", &columns_of, "The columns as the constructor takes them, after rounding and merging. A new list each time.")
        .def_property_readonly(
            "shape", [](const MaterialStack& s) { return std::make_pair(s.size().x, s.size().y); }, "Columns along x and y.")
        .def_property_readonly("cell", &MaterialStack::cell, "Width of a column, metres.")
        .def_property_readonly("unit", &MaterialStack::unit, "Height quantum, metres.")
        .def_property_readonly(
            "origin", [](const MaterialStack& s) { return std::make_tuple(s.origin().x, s.origin().y, s.origin().z); }, "Lower corner, metres.")
        .def_property_readonly("layer_count", &MaterialStack::layer_count, "Layers of all columns, implicit base and air not counted.")
        .def(
            "edit", &edit_stack, py::arg("tool"), py::kw_only(), py::arg("seed") = 0,
            "edit(tool, *, seed=0, **parameters) -> int32 (n, 2)\n\nApplies an edit tool in place, with the parameters an [[edit]] table takes (see "
            "tools()), and brings loose material to rest unless "
            "stabilise=False. Returns the columns (i, j) that may have changed, sorted by j, then i; all others keep their bits. Noise depends on "
            "seed and on the parameter "
            "`name`. Fields made from this stack follow it. Not while another thread uses them. Raises hoodoo.Error: an unknown tool or parameter, a "
            "value that cannot be; "
            "the stack is then as it was.")
        .def(
            "copy", [](const MaterialStack& s) { return std::make_shared<MaterialStack>(s); }, "A stack of its own with the same columns.")
        .def_property_readonly("memory_bytes", &MaterialStack::memory_bytes, "Bytes that the stack holds in memory.");

    module.def("ConvolutionField", &convolution_of, py::arg("stack"), py::arg("sigma"),
               py::arg("materials") = std::vector<std::string>{"sand", "bedrock"}, py::arg("border") = "extend", py::arg("base") = 0.0,
               "ConvolutionField(stack, sigma, materials=('sand', 'bedrock'), border='extend', base=0) -> Field\n\nThe share of matter in the cube "
               "of half-width sigma (metres) against one half: "
               "1 - V / (4 sigma^3), in [-1, 1], negative inside. border: 'extend' repeats the edge columns for ever; 'cut' ends the block at the "
               "grid, `base` metres below the origin.\n"
               "The stack is shared, not copied. Raises hoodoo.Error: sigma not above 0, an unknown material.");
    module.def("field", &field_of_row, py::arg("type"),
               "field(type, **parameters) -> Field\n\nThe implicit function of a catalogue row, with the parameters a [terrain.NAME] table takes "
               "(see catalogue()). Raises hoodoo.Error: an unknown row or "
               "parameter, a row that has no field.");
    module.def(
        "tools", &tool_rows,
        "tools() -> list of dict\n\nEvery edit tool: name, doc and parameters (name -> text, with the unit), as MaterialStack.edit and [[edit]] "
        "tables take them.");
    module.def("catalogue", &catalogue_rows,
               "catalogue() -> list of dict\n\nEvery terrain representation: name, doc, paper and parameters (name -> text, with the unit).");
}

}  // namespace hoodoo::python
