// hoodoo.analysis: what one measures on a grid of heights, arrays in, arrays out.
#include "renderer/hosts/python_values.h"

#include "terrain/analysis/drainage.h"
#include "terrain/analysis/slopes.h"

#include <algorithm>

namespace hoodoo::python
{

namespace
{

/// A view of the array; throws Error if it has not two dimensions.
Elevation elevation_of(const Doubles& z, double cell)
{
    if (z.ndim() != 2)
        throw Error(ErrorKind::scene,
                    Problem{{"<python>", 0, 0, {}}, "z has a wrong shape", "(rows, columns)", std::to_string(z.ndim()) + " dimensions", {}});
    const auto count = static_cast<std::size_t>(z.size());
    return {{z.data(), count}, static_cast<int>(z.shape(1)), static_cast<int>(z.shape(0)), cell};
}

template <class T>
py::array_t<T> like(const Doubles& z, const std::vector<T>& values)
{
    py::array_t<T> out({z.shape(0), z.shape(1)});
    std::copy(values.begin(), values.end(), out.mutable_data());
    return out;
}

/// Runs an analysis with the interpreter free.
template <class F>
auto analysed(const Doubles& z, double cell, const F& f)
{
    const Elevation elevation = elevation_of(z, cell);
    const py::gil_scoped_release free;
    return f(elevation);
}

void add_measure(py::module_& module, const char* name, std::vector<double> (*measure)(const Elevation&), const char* doc)
{
    module.def(
        name, [measure](const Doubles& z, double cell) { return like(z, analysed(z, cell, measure)); }, py::arg("z"), py::arg("cell"), doc);
}

void add_bend(py::module_& module, const char* name, double Curvature::*member, const char* doc)
{
    module.def(
        name,
        [member](const Doubles& z, double cell) {
            const std::vector<Curvature> all = analysed(z, cell, curvatures);
            std::vector<double> values(all.size());
            std::transform(all.begin(), all.end(), values.begin(), [&](const Curvature& c) { return c.*member; });
            return like(z, values);
        },
        py::arg("z"), py::arg("cell"), doc);
}

}  // namespace

void add_analysis(py::module_& parent)
{
    py::module_ module = parent.def_submodule("analysis",
                                              "Measures of a height grid.\n\nAll take z, float64 (rows, columns) in metres, row 0 = north, columns "
                                              "from west to east, and cell, metres between "
                                              "samples, and return an array of that shape. All raise hoodoo.Error: z without two dimensions, samples "
                                              "that are not finite (how many, where the "
                                              "first is), a cell not above 0.");
    add_measure(
        module, "slope", slope,
        "slope(z, cell) -> float64 (rows, columns)\n\nThe angle of steepest ascent, radians in [0, pi/2): atan of the length of the gradient of the "
        "quadric of Zevenbergen and Thorne. At the rim heights go on as straight lines.");
    add_measure(
        module, "aspect", aspect,
        "aspect(z, cell) -> float64 (rows, columns)\n\nWhere the ground faces (downhill), radians from north to east in [0, 2 pi); -1 where it is "
        "flat.");
    add_bend(module, "plan_curvature", &Curvature::plan,
             "plan_curvature(z, cell) -> float64 (rows, columns)\n\nZevenbergen and Thorne's, 1/m: plus the second derivative along the contour. "
             "Below 0 on "
             "ridges, above 0 in valleys; 0 where the ground is flat.");
    add_bend(module, "profile_curvature", &Curvature::profile,
             "profile_curvature(z, cell) -> float64 (rows, columns)\n\nZevenbergen and Thorne's, 1/m: MINUS the second derivative along the slope. "
             "Above 0 "
             "where it is convex; 0 where the ground is flat.");
    add_bend(module, "contour_curvature", &Curvature::contour,
             "contour_curvature(z, cell) -> float64 (rows, columns)\n\nThe curvature of the contour line itself, 1/m: -plan / |grad z|. Above 0 on "
             "ridges.");
    add_bend(
        module, "normal_curvature", &Curvature::normal,
        "normal_curvature(z, cell) -> float64 (rows, columns)\n\nThe curvature of the vertical section along the slope, 1/m: profile / (1 + |grad "
        "z|^2)^1.5. Above 0 where it is convex.");
    add_bend(module, "tangential_curvature", &Curvature::tangential,
             "tangential_curvature(z, cell) -> float64 (rows, columns)\n\nThe curvature of the normal section across the slope, 1/m: -plan / sqrt(1 "
             "+ |grad "
             "z|^2). Above 0 on ridges.");
    add_measure(
        module, "fill_pits", fill_pits,
        "fill_pits(z, cell) -> float64 (rows, columns)\n\nThe heights in metres with every pit raised until it drains over its rim, by the smallest "
        "steps a double can make.");
    module.def(
        "drainage",
        [](const Doubles& z, double cell) {
            const Drainage d = analysed(z, cell, drainage);
            return py::make_tuple(like(z, d.area), like(z, d.slope), like(z, d.downstream));
        },
        py::arg("z"), py::arg("cell"),
        "drainage(z, cell) -> (area, slope, downstream)\n\narea: float64 (rows, columns), m2 that drain through each cell, itself included. slope: "
        "float64, "
        "metres a metre towards the cell it drains to, 0 where water leaves the grid. downstream: int64, flat index of that cell, -1 where water "
        "leaves. "
        "Pits are filled first; each cell drains to its neighbour of steepest descent (eight directions; of equally steep ones the first, row by "
        "row).");
    module.def(
        "wetness",
        [](const Doubles& z, double cell, const std::string& kind) {
            if (kind != "tangent" && kind != "cover")
                throw Error(ErrorKind::scene, Problem{{"<python>", 0, 0, {}}, "kind", "\"tangent\" or \"cover\"", "\"" + kind + "\"", {}});
            const auto measure = [&](const Elevation& e) {
                return wetness(drainage(e), e.cell, kind == "cover" ? WetnessKind::cover : WetnessKind::tangent);
            };
            return like(z, analysed(z, cell, measure));
        },
        py::arg("z"), py::arg("cell"), py::arg("kind") = "tangent",
        "wetness(z, cell, kind='tangent') -> float64 (rows, columns)\n\nln(A / s), A = area / cell in metres. kind 'tangent': s is the slope towards "
        "the cell "
        "that is drained to, at least 0.001 (the topographic wetness index); 'cover': s = sqrt(1 + slope^2), never singular.");
    module.def(
        "hillshade",
        [](const Doubles& z, double cell, double azimuth, double altitude, double exaggeration) {
            const auto measure = [&](const Elevation& e) { return hillshade(e, azimuth, altitude, exaggeration); };
            return like(z, analysed(z, cell, measure));
        },
        py::arg("z"), py::arg("cell"), py::arg("azimuth") = 5.497787143782138, py::arg("altitude") = 0.7853981633974483,
        py::arg("exaggeration") = 1.0,
        "hillshade(z, cell, azimuth=7 pi / 4, altitude=pi / 4, exaggeration=1) -> float64 (rows, columns)\n\nThe cosine between the normal and a "
        "light from "
        "azimuth (radians from north to east) at altitude (radians above the horizon), in [0, 1].");
}

}  // namespace hoodoo::python
