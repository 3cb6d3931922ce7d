// Between Python and the library: dictionaries to scene values, arrays of points, waiting that Ctrl-C can end.
#pragma once

#include "renderer/scene/description.h"
#include "terrain/field.h"
#include "terrain/math/vec.h"
#include "terrain/schema.h"
#include "terrain/stack/column_set.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hoodoo::python
{

namespace py = pybind11;

/// A field and whatever it lives in.
struct FieldHandle {
    std::shared_ptr<const void> owner;
    const Field* field = nullptr;
};

/// Any array-like of float64, made contiguous.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The text of a path: a str or an os.PathLike.
std::string path_text(const py::object& path);

/// Throws Error (scene) placed at "<python>".
[[noreturn]] void refuse(std::string what, std::string expected, std::string got = {});

/// bool, int, float, str, list or tuple, dict, os.PathLike, NumPy scalars and arrays -> a node whose position is "<python>". Throws Error on anything
/// else.
Node node_from(const py::handle& object, const std::string& what);

/// The same as the text of a TOML value.
std::string toml_from(const py::handle& object, const std::string& what);

/// {"params.width": 3, "terrain.rock.sigma": 1.5} -> -D and --set.
SceneOverrides overrides_from(const py::dict& overrides);

/// The last axis must be 3; throws Error that names `what` otherwise. The shape without it is what results have.
std::vector<py::ssize_t> shape_of_points(const Doubles& points, const std::string& what);

/// int32 (n, 2): the columns (i, j), sorted by j, then i.
py::array_t<std::int32_t> columns_array(const ColumnSet& columns);

/// Runs `work` on another thread with the interpreter free, so that other Python threads run; `idle` is called in this thread, holding the
/// interpreter, about twenty times a second. If a signal handler raises (Ctrl-C), or `idle` does, `stop` is called, the work awaited, and the
/// exception passed on.
void run_interruptibly(const std::function<void()>& work, const std::function<void()>& stop, const std::function<void()>& idle);

/// Calls chunk(begin, end) over [0, count) with the interpreter free; between chunks a signal may raise.
void for_chunks(std::size_t count, std::size_t chunk_size, const std::function<void(std::size_t, std::size_t)>& chunk);

/// The field at points (n, 3); a point that is not finite gives nan.
py::array_t<double> values_at(const Field& field, const Doubles& points);
py::array_t<double> gradients_at(const Field& field, const Doubles& points);
/// Throws Error: a box that is none.
std::pair<double, double> interval_over(const Field& field, const std::array<double, 3>& low, const std::array<double, 3>& high);
double slope_bound_over(const Field& field, const std::array<double, 3>& a, const std::array<double, 3>& b);

/// value, gradient, interval and slope_bound of a class; `handle_of(self)` gives the field and keeps it alive for the call.
template <class Class, class HandleOf>
void add_field_methods(Class& c, HandleOf handle_of)
{
    using Self = typename Class::type;
    using Corner = std::array<double, 3>;
    c.def(
         "value", [=](const Self& self, const Doubles& points) { return values_at(*handle_of(self).field, points); }, py::arg("points"),
         "value(points) -> float64 (n,)\n\nThe function at points, float64 (n, 3) in metres, world space. Negative inside matter; its unit is the "
         "field's own (a convolution field has none and lies in [-1, 1]). Any leading shape is kept: (3,) gives (). A point that is not finite gives "
         "nan. Raises hoodoo.Error if the last axis is not 3.")
        .def(
            "gradient", [=](const Self& self, const Doubles& points) { return gradients_at(*handle_of(self).field, points); }, py::arg("points"),
            "gradient(points) -> float64 (n, 3)\n\nIts gradient per metre at points, float64 (n, 3) in metres; it points from matter to air, and is "
            "one-sided where the function has a crease.")
        .def(
            "interval", [=](const Self& self, const Corner& low, const Corner& high) { return interval_over(*handle_of(self).field, low, high); },
            py::arg("low"), py::arg("high"),
            "interval(low, high) -> (float, float)\n\nA proved enclosure of the values over the box between the corners low and high, three numbers "
            "in metres each: no value lies outside. Raises hoodoo.Error: a box that is none.")
        .def(
            "slope_bound", [=](const Self& self, const Corner& a, const Corner& b) { return slope_bound_over(*handle_of(self).field, a, b); },
            py::arg("a"), py::arg("b"),
            "slope_bound(a, b) -> float\n\nA proved upper bound of |value(p) - value(q)| / |p - q|, per metre, over all p, q of the segment from a "
            "to b, three numbers in metres each.");
}

/// A schema as a dict: name, doc, parameters (name -> text, with the unit).
py::dict described(const Schema& schema);

/// Adds Field to the module.
void add_field(py::module_& module);

/// Adds VoxelGrid and voxel_tools().
void add_voxels(py::module_& module);

/// Adds MaterialStack, ConvolutionField, catalogue() and field() to the module; after add_field().
void add_terrain(py::module_& module);

/// Adds the submodule `analysis`.
void add_analysis(py::module_& module);

}  // namespace hoodoo::python
