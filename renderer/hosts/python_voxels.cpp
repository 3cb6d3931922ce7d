// Sampled solids in Python: made of an array or read from a file, changed by the tools that scenes have, asked like any field, written again.
//
// A grid changes by putting a changed copy in its place: a tool that fails leaves it alone, fields made from it before keep what they were, and
// questions from other threads meet one state or the other. Missing: materials a voxel; they come with .npz files in scenes.
#include "renderer/hosts/python_values.h"

#include "terrain/edit/voxel_tools.h"
#include "terrain/fields/voxel_field.h"
#include "terrain/io/grid_file.h"
#include "terrain/io/voxel_file.h"

#include <memory>
#include <mutex>
#include <optional>

namespace hoodoo::python
{

namespace
{

const Source kHere{"<python>", 0, 0, {}};

/// A grid and, once somebody asked, its field. Both are never changed, only replaced.
class Voxels
{
public:
    explicit Voxels(VoxelGrid grid) : grid_(std::make_shared<const VoxelGrid>(std::move(grid))) {}

    std::shared_ptr<const VoxelGrid> grid() const
    {
        const std::lock_guard lock(mutex_);
        return grid_;
    }

    FieldHandle field() const
    {
        const std::lock_guard lock(mutex_);
        if (!field_) field_ = std::make_shared<const VoxelField>(grid_);
        return {field_, field_.get()};
    }

    void replace(VoxelGrid grid)
    {
        const std::lock_guard lock(mutex_);
        grid_ = std::make_shared<const VoxelGrid>(std::move(grid));
        field_ = nullptr;
    }

private:
    mutable std::mutex mutex_;
    std::shared_ptr<const VoxelGrid> grid_;
    mutable std::shared_ptr<const VoxelField> field_;
};

VoxelFileOptions options_of(const std::string& meaning, std::optional<double> iso, std::optional<double> cell,
                            const std::optional<std::array<double, 3>>& origin)
{
    VoxelFileOptions options;
    if (meaning == "density")
        options.meaning = VoxelMeaning::density;
    else if (meaning == "distance")
        options.meaning = VoxelMeaning::distance;
    else if (meaning != "auto")
        refuse("what the numbers mean", "\"density\", \"distance\" or \"auto\"", '"' + meaning + '"');
    options.iso = iso;
    options.cell = cell;
    if (origin) options.origin = Vec3d((*origin)[0], (*origin)[1], (*origin)[2]);
    return options;
}

std::unique_ptr<Voxels> from_array(const Doubles& values, double cell, const std::array<double, 3>& origin, const std::string& meaning,
                                   std::optional<double> iso)
{
    if (values.ndim() != 3) refuse("voxels are an array of three axes (x, y, z)", "three", std::to_string(values.ndim()));
    Index3 size;
    for (std::size_t k = 0; k < 3; ++k) {
        const py::ssize_t n = values.shape(static_cast<py::ssize_t>(k));
        if (n < 1 || n > 65536) refuse("an axis of the voxels", "1 to 65536 samples", std::to_string(n));
        size[k] = static_cast<int>(n);
    }
    const VoxelFileOptions options = options_of(meaning, iso, cell, origin);
    const double* from = values.data();
    const py::gil_scoped_release free;
    return std::make_unique<Voxels>(voxels_from_slices(size, options, kHere.file, kHere, [&](std::vector<double>& slice) {
        std::copy(from, from + slice.size(), slice.begin());
        from += slice.size();
    }));
}

std::unique_ptr<Voxels> from_file(const py::object& path, const std::string& array, const std::string& meaning, std::optional<double> iso,
                                  std::optional<double> cell, const std::optional<std::array<double, 3>>& origin)
{
    const std::string name = path_text(path);
    VoxelFileOptions options = options_of(meaning, iso, cell, origin);
    options.array = array;
    const py::gil_scoped_release free;
    return std::make_unique<Voxels>(read_voxel_file(name, options, kHere));
}

void edit(Voxels& self, const std::string& tool, std::uint64_t seed, const py::kwargs& parameters)
{
    const Node node = node_from(parameters, tool);
    const py::gil_scoped_release free;
    VoxelGrid grid = self.grid()->copy();
    apply_voxel_edit(grid, tool, node, seed, 0);
    self.replace(std::move(grid));
}

/// Samples that the grid was given, without the layer of air around them.
Index3 inner_size(const VoxelGrid& grid)
{
    const Index3& n = grid.values.size();
    return {n[0] - 2, n[1] - 2, n[2] - 2};
}

template <class T>
void copy_samples(const VoxelGrid& grid, T* out)
{
    const Index3 n = inner_size(grid);
    for (int i = 1; i <= n[0]; ++i)
        for (int j = 1; j <= n[1]; ++j)
            for (int k = 1; k <= n[2]; ++k) *out++ = static_cast<T>(grid.at({i, j, k}));
}

py::array_t<float> samples(const Voxels& self)
{
    const std::shared_ptr<const VoxelGrid> grid = self.grid();
    const Index3 n = inner_size(*grid);
    py::array_t<float> result({n[0], n[1], n[2]});
    float* out = result.mutable_data();
    const py::gil_scoped_release free;
    copy_samples(*grid, out);
    return result;
}

void write(const Voxels& self, const py::object& path)
{
    const std::string name = path_text(path);
    const py::gil_scoped_release free;
    const std::shared_ptr<const VoxelGrid> grid = self.grid();
    SampledGrid out;
    out.count = inner_size(*grid);
    out.origin = grid->world(Vec3d(1.0));
    out.step = Vec3d(grid->cell);
    out.values.resize(static_cast<std::size_t>(out.count[0]) * static_cast<std::size_t>(out.count[1]) * static_cast<std::size_t>(out.count[2]));
    copy_samples(*grid, out.values.data());
    write_grid_file(name, out);
}

py::list voxel_tool_rows()
{
    py::list rows;
    for (const Schema& schema : voxel_edit_schemas()) rows.append(described(schema));
    return rows;
}

/// What a tool's method says of itself: from its schema, so that it cannot differ from what scenes accept.
std::string documentation(const Schema& schema)
{
    std::string text = schema.name + "(*, seed=0, **parameters)\n\n" + schema.doc + " Changes the grid in place.\n";
    for (const Parameter& p : schema.parameters)
        text += "\n" + p.name + (p.unit.empty() ? "" : " [" + p.unit + "]") + (p.required ? ", required: " : ": ") + p.doc;
    return text + "\n\nRaises hoodoo.Error: a parameter that cannot be; the grid is then as it was.";
}

}  // namespace

void add_voxels(py::module_& module)
{
    py::class_<Voxels> grid(module, "VoxelGrid",
                            "A solid sampled on a lattice, trilinear between samples, negative inside matter; around the samples there is air. "
                            "Memory follows the surface: far from it only the side is kept.");
    grid.def(py::init(&from_array), py::arg("values"), py::arg("cell") = 1.0, py::arg("origin") = std::array<double, 3>{0.0, 0.0, 0.0},
             py::arg("meaning") = "density", py::arg("iso") = py::none(),
             "VoxelGrid(values, cell=1.0, origin=(0, 0, 0), meaning='density', iso=None)\n\nvalues: (nx, ny, nz) numbers, i along x, k upwards; "
             "sample "
             "(i, j, k) stands at origin + cell * (i, j, k), metres.\nmeaning: 'density', matter where a number is above iso (0.5 by default); "
             "'distance', metres from the surface, matter where it is below iso (0 by default).\nRaises hoodoo.Error: not three axes, numbers that "
             "are not finite, a cell or an iso not above 0.")
        .def_static("read", &from_file, py::arg("path"), py::arg("array") = "", py::arg("meaning") = "auto", py::arg("iso") = py::none(),
                    py::arg("cell") = py::none(), py::arg("origin") = py::none(),
                    "read(path, array='', meaning='auto', iso=None, cell=None, origin=None) -> VoxelGrid\n\nA NumPy array (.npy, .npz; [x, y, z]) or "
                    "an OpenVDB grid (.vdb). array: which one of several. meaning: as the constructor; 'auto' is what a VDB says of itself, else "
                    "density. cell: metres, origin: (x, y, z) of sample (0, 0, 0); a VDB has its own. Raises hoodoo.Error: what is wrong with the "
                    "file.")
        .def("edit", &edit, py::arg("tool"), py::kw_only(), py::arg("seed") = 0,
             "edit(tool, *, seed=0, **parameters)\n\nApplies a tool in place, with the parameters that an [[edit]] table of voxels takes (see "
             "voxel_tools()). Noise depends on seed and on the parameter `name`. Fields made before keep what they were. Raises hoodoo.Error: an "
             "unknown tool or parameter, a value that cannot be; the grid is then as it was.")
        .def("array", &samples,
             "array() -> float32 (nx, ny, nz)\n\nThe samples, a new array: negative in matter. Near the surface they are exact, elsewhere only their "
             "side is.")
        .def_property_readonly(
            "field", [](const Voxels& v) { return v.field(); }, "The Field of the grid as it is now; later edits do not change it.")
        .def("write", &write, py::arg("path"),
             "write(path)\n\nThe samples as .npy (float64 [i, j, k]), .vdb (a float grid called \"field\" with cell and origin) or .exr (one channel "
             "a "
             "height), in one step. read(path, meaning='distance') gives the same solid again; an .npy needs cell and origin to be said. Raises "
             "hoodoo.Error.")
        .def(
            "copy", [](const Voxels& v) { return std::make_unique<Voxels>(v.grid()->copy()); }, "A grid of its own with the same samples.")
        .def_property_readonly(
            "shape",
            [](const Voxels& v) {
                const Index3 n = inner_size(*v.grid());
                return std::make_tuple(n[0], n[1], n[2]);
            },
            "(nx, ny, nz), samples along each axis.")
        .def_property_readonly(
            "cell", [](const Voxels& v) { return v.grid()->cell; }, "Between neighbouring samples, metres.")
        .def_property_readonly(
            "origin",
            [](const Voxels& v) {
                const Vec3d at = v.grid()->world(Vec3d(1.0));
                return std::make_tuple(at.x, at.y, at.z);
            },
            "Where sample (0, 0, 0) stands, metres.")
        .def_property_readonly(
            "memory_bytes", [](const Voxels& v) { return v.grid()->memory_bytes(); }, "Bytes that the samples hold in memory.");
    add_field_methods(grid, [](const Voxels& v) { return v.field(); });
    for (const Schema& schema : voxel_edit_schemas()) {
        const std::string name = schema.name;
        grid.def(
            name.c_str(), [name](Voxels& self, std::uint64_t seed, const py::kwargs& parameters) { edit(self, name, seed, parameters); },
            py::kw_only(), py::arg("seed") = 0, documentation(schema).c_str());
    }
    module.def("voxel_tools", &voxel_tool_rows,
               "voxel_tools() -> list of dict\n\nEvery tool of voxels: name, doc and parameters (name -> text, with the unit), as VoxelGrid.edit and "
               "[[edit]] tables of voxels take them.");
}

}  // namespace hoodoo::python
