// Terrains without a scene: stacks from lists, their convolution field, and every field that a catalogue row has.
//
// Everything here is a value that Python owns; results are new arrays.

#include "renderer/hosts/python_values.h"

#include "terrain/catalogue.h"
#include "terrain/edit/tools.h"
#include "terrain/math/hash.h"
#include "terrain/stack/convolution.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace hoodoo::python
{

namespace
{

using LayerTuple = std::pair<std::string, double>;
using ColumnLists = std::vector<std::vector<std::vector<LayerTuple>>>;

[[noreturn]] void refuse(std::string what, std::string expected, std::string got = {})
{
    throw Error(ErrorKind::scene, Problem{{"<python>", 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

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

py::array_t<double> values_at(const FieldHandle& self, const Doubles& points)
{
    const std::vector<py::ssize_t> shape = shape_of_points(points, "points");
    py::array_t<double> result(shape);
    const double* p = points.data();
    double* out = result.mutable_data();
    for_chunks(static_cast<std::size_t>(result.size()), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d at(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
            out[i] = is_finite(at) ? self.field->value(at) : std::numeric_limits<double>::quiet_NaN();
        }
    });
    return result;
}

py::array_t<double> gradients_at(const FieldHandle& self, const Doubles& points)
{
    std::vector<py::ssize_t> shape = shape_of_points(points, "points");
    shape.push_back(3);
    py::array_t<double> result(shape);
    const double* p = points.data();
    double* out = result.mutable_data();
    for_chunks(static_cast<std::size_t>(result.size()) / 3, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d at(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
            const Vec3d g = is_finite(at) ? self.field->gradient(at) : Vec3d(std::numeric_limits<double>::quiet_NaN());
            for (unsigned k = 0; k < 3; ++k) out[3 * i + k] = g[k];
        }
    });
    return result;
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

void add_terrain(py::module_& module)
{
    py::class_<FieldHandle>(module, "Field", "An implicit function of space, negative inside matter. Immutable.")
        .def("value", &values_at, py::arg("points"),
             "value(points) -> float64 (n,)\n\nThe function at points, float64 (n, 3) in metres, world space. Negative inside matter; its unit is "
             "the field's own (a convolution field has none "
             "and lies in [-1, 1]). Any leading shape is kept: (3,) gives (). A point that is not finite gives nan. Raises hoodoo.Error if the last "
             "axis is not 3.")
        .def("gradient", &gradients_at, py::arg("points"),
             "gradient(points) -> float64 (n, 3)\n\nIts gradient per metre at points, float64 (n, 3) in metres; it points from matter to air, and is "
             "one-sided where the function has a crease.")
        .def(
            "interval",
            [](const FieldHandle& self, const std::array<double, 3>& low, const std::array<double, 3>& high) {
                for (std::size_t k = 0; k < 3; ++k)
                    if (!(low[k] <= high[k])) refuse("the box of an interval", "low <= high in every coordinate");
                const Interval i = self.field->range(Box3d(Vec3d(low[0], low[1], low[2]), Vec3d(high[0], high[1], high[2])));
                return std::make_pair(i.lo, i.hi);
            },
            py::arg("low"), py::arg("high"),
            "interval(low, high) -> (float, float)\n\nA proved enclosure of the values over the box between the corners low and high, three numbers "
            "in "
            "metres each: no value lies outside. Raises hoodoo.Error: a box that is none.")
        .def(
            "slope_bound",
            [](const FieldHandle& self, const std::array<double, 3>& a, const std::array<double, 3>& b) {
                return self.field->slope_bound({Vec3d(a[0], a[1], a[2]), Vec3d(b[0], b[1], b[2])});
            },
            py::arg("a"), py::arg("b"),
            "slope_bound(a, b) -> float\n\nA proved upper bound of |value(p) - value(q)| / |p - q|, per metre, over all p, q of the segment from a "
            "to b, "
            "three numbers in metres each.");

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
