// Between Python and the library: dictionaries to scene values, arrays of points, waiting that Ctrl-C can end.
#pragma once

#include "renderer/scene/description.h"
#include "terrain/field.h"
#include "terrain/math/vec.h"
#include "terrain/schema.h"
#include "terrain/stack/column_set.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <string>
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

/// Adds MaterialStack, ConvolutionField, Field, catalogue() and field() to the module.
void add_terrain(py::module_& module);

/// Adds the submodule `analysis`.
void add_analysis(py::module_& module);

}  // namespace hoodoo::python
