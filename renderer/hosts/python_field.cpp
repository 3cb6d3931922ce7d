// Fields in Python: values, gradients and what is proved of them, for arrays of points.
//
// The functions are shared by everything that has a field (Field, VoxelGrid). Results are new arrays; the interpreter is free while C++ works.
#include "renderer/hosts/python_values.h"

#include <pybind11/stl.h>

#include <array>
#include <limits>

namespace hoodoo::python
{

py::array_t<double> values_at(const Field& field, const Doubles& points)
{
    const std::vector<py::ssize_t> shape = shape_of_points(points, "points");
    py::array_t<double> result(shape);
    const double* p = points.data();
    double* out = result.mutable_data();
    for_chunks(static_cast<std::size_t>(result.size()), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d at(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
            out[i] = is_finite(at) ? field.value(at) : std::numeric_limits<double>::quiet_NaN();
        }
    });
    return result;
}

py::array_t<double> gradients_at(const Field& field, const Doubles& points)
{
    std::vector<py::ssize_t> shape = shape_of_points(points, "points");
    shape.push_back(3);
    py::array_t<double> result(shape);
    const double* p = points.data();
    double* out = result.mutable_data();
    for_chunks(static_cast<std::size_t>(result.size()) / 3, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d at(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
            const Vec3d g = is_finite(at) ? field.gradient(at) : Vec3d(std::numeric_limits<double>::quiet_NaN());
            for (unsigned k = 0; k < 3; ++k) out[3 * i + k] = g[k];
        }
    });
    return result;
}

std::pair<double, double> interval_over(const Field& field, const std::array<double, 3>& low, const std::array<double, 3>& high)
{
    for (std::size_t k = 0; k < 3; ++k)
        if (!(low[k] <= high[k])) refuse("the box of an interval", "low <= high in every coordinate");
    const Interval i = field.range(Box3d(Vec3d(low[0], low[1], low[2]), Vec3d(high[0], high[1], high[2])));
    return {i.lo, i.hi};
}

double slope_bound_over(const Field& field, const std::array<double, 3>& a, const std::array<double, 3>& b)
{
    return field.slope_bound({Vec3d(a[0], a[1], a[2]), Vec3d(b[0], b[1], b[2])});
}

void add_field(py::module_& module)
{
    py::class_<FieldHandle> handle(module, "Field", "An implicit function of space, negative inside matter. Immutable.");
    add_field_methods(handle, [](const FieldHandle& self) { return self; });
}

}  // namespace hoodoo::python
