// The Python module: load, render, intersect, and the terrain behind them, as arrays.
//
// The interpreter is free while C++ works, Ctrl-C ends a render or a query within a second, and arrays keep what they show alive. Errors are
// hoodoo.Error, a ValueError with the full text.
// Missing: pickling; cancelling load().

#include "renderer/edit.h"
#include "renderer/hosts/python_values.h"
#include "renderer/render.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <limits>
#include <mutex>
#include <shared_mutex>

namespace hoodoo::python
{

namespace
{

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kRaysAtOnce = 8192;  // well under a second, at any speed a terrain was ever traced

struct SceneHandle {
    std::shared_ptr<LoadedScene> loaded;
    std::shared_ptr<std::shared_mutex> gate;  ///< edits keep everybody else out
    const Scene& scene() const { return *loaded->scene; }
};

struct ImageHandle {
    std::shared_ptr<const Image> image;
    std::shared_ptr<const LoadedScene> loaded;
};

// -- load ------------------------------------------------------------------------------------------------------------

/// A text is a scene if it has a line end or is no path to speak of: "x = 1" is a scene, "valley.toml" a file, there or not.
bool is_scene_text(const std::string& given)
{
    if (given.find('\n') != std::string::npos) return true;
    const std::filesystem::path path(given);
    std::error_code ignored;
    return path.extension() != ".toml" && given.find('=') != std::string::npos && !std::filesystem::exists(path, ignored);
}

SceneHandle load(const py::object& source, const py::dict& overrides, std::optional<std::uint64_t> seed, int threads, bool editable)
{
    const bool is_path = py::hasattr(source, "__fspath__");
    const std::string given = path_text(source);
    SceneOverrides all = overrides_from(overrides);
    all.seed = seed;
    py::gil_scoped_release free;
    return {std::make_shared<LoadedScene>(load_scene(given, !is_path && is_scene_text(given), all, threads, {}, {}, editable)),
            std::make_shared<std::shared_mutex>()};
}

// -- edit ------------------------------------------------------------------------------------------------------------

py::array_t<std::int32_t> edit(const SceneHandle& self, const std::string& tool, const py::object& terrain, const py::kwargs& parameters)
{
    const Node node = node_from(parameters, tool);
    const std::string name = terrain.is_none() ? std::string() : terrain.cast<std::string>();
    return columns_array([&] {
        const py::gil_scoped_release free;
        const std::unique_lock alone(*self.gate);
        return edit_scene(*self.loaded, name, tool, node);
    }());
}

// -- render ----------------------------------------------------------------------------------------------------------

ImageHandle render_image(const SceneHandle& self, std::optional<int> width, std::optional<int> height, std::optional<int> spp, int threads,
                         std::optional<std::uint64_t> seed, const py::object& progress)
{
    std::atomic<bool> cancel{false};
    std::mutex reported_mutex;
    double reported = 0.0;
    RenderOptions options;
    options.width = width;
    options.height = height;
    options.spp = spp;
    options.threads = threads;
    options.seed = seed;
    options.cancel = &cancel;
    options.progress = [&](double fraction, const std::string&) {
        const std::lock_guard lock(reported_mutex);
        reported = fraction;
    };

    double told = -1.0;
    const auto tell = [&] {
        double now = 0.0;
        {
            const std::lock_guard lock(reported_mutex);
            now = reported;
        }
        if (!progress.is_none() && now != told) progress(told = now);
    };
    Image image;
    run_interruptibly(
        [&] {
            const std::shared_lock together(*self.gate);
            image = render(*self.loaded, options);
        },
        [&] { cancel = true; }, tell);
    return {std::make_shared<const Image>(std::move(image)), self.loaded};
}

std::vector<std::string> channel_names(const ImageHandle& self)
{
    std::vector<std::string> names;
    for (const Channel& channel : self.image->channels) names.push_back(channel.name);
    return names;
}

/// A view: the array holds the image, so that it may outlive every other reference to it. Read-only, since all views share the pixels.
py::array_t<float> channel_array(const ImageHandle& self, const std::string& name)
{
    const Channel* channel = self.image->find(name);
    if (!channel) {
        const std::string nearest = nearest_name(name, channel_names(self));
        throw py::key_error("no channel \"" + name + "\"" + (nearest.empty() ? "" : " (did you mean \"" + nearest + "\"?)"));
    }
    auto* kept = new std::shared_ptr<const Image>(self.image);
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::shared_ptr<const Image>*>(p); });
    const std::vector<py::ssize_t> shape = {self.image->data.height(), self.image->data.width()};
    py::array_t<float> array(shape, channel->pixels.data(), owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

py::dict metadata_of(const ImageHandle& self)
{
    py::dict result;
    for (const auto& [name, value] : self.image->metadata)
        result[py::str(name)] = std::visit([](const auto& v) { return py::object(py::cast(v)); }, value);
    return result;
}

void write_image(const ImageHandle& self, const py::object& path)
{
    const std::string name = path_text(path);
    py::gil_scoped_release free;
    write_picture(*self.image, name, *self.loaded);
}

// -- intersect -------------------------------------------------------------------------------------------------------

/// The rays of a query. Directions need not be unit vectors: lengths along a ray are metres all the same.
struct Rays {
    Doubles origins, directions;
    double t_min, t_max;
    std::size_t count;

    Rays(Doubles o, Doubles d, double from, double to) : origins(std::move(o)), directions(std::move(d)), t_min(from), t_max(to)
    {
        const auto a = shape_of_points(origins, "origins"), b = shape_of_points(directions, "directions");
        if (a.size() != 1 || a != b)
            throw Error(ErrorKind::scene,
                        Problem{{"<python>", 0, 0, {}}, "origins and directions have wrong shapes", "both (n, 3) with the same n", {}, {}});
        count = static_cast<std::size_t>(a[0]);
    }

    Ray operator[](std::size_t i) const
    {
        const double* o = origins.data() + 3 * i;
        const double* d = directions.data() + 3 * i;
        Ray ray;
        ray.origin = Vec3d(o[0], o[1], o[2]);
        ray.direction = Vec3d(d[0], d[1], d[2]);
        const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
        if (largest > 0.0 && std::isfinite(largest)) ray.direction = (ray.direction / largest).normalized();
        ray.t_min = t_min;
        ray.t_max = t_max;
        return ray;
    }
};

py::dict intersect(const SceneHandle& self, Doubles origins, Doubles directions, double t_min, double t_max)
{
    const Rays rays(std::move(origins), std::move(directions), t_min, t_max);
    const auto n = static_cast<py::ssize_t>(rays.count);
    py::array_t<double> t(n), position({n, py::ssize_t(3)}), normal({n, py::ssize_t(3)}), shading_normal({n, py::ssize_t(3)});
    py::array_t<std::int64_t> object(n), cost(n);
    double *ts = t.mutable_data(), *ps = position.mutable_data(), *ns = normal.mutable_data(), *ss = shading_normal.mutable_data();
    std::int64_t *os = object.mutable_data(), *cs = cost.mutable_data();
    const Tracer& tracer = self.scene().tracer();
    for_chunks(rays.count, kRaysAtOnce, [&](std::size_t begin, std::size_t end) {
        const std::shared_lock together(*self.gate);
        for (std::size_t i = begin; i < end; ++i) {
            const Ray ray = rays[i];
            const TraceHit hit = tracer.intersect(ray);
            Interaction at;
            at.position = at.geometric_normal = at.shading_normal = Vec3d(kNan);
            if (hit.valid) at = tracer.interact(ray, hit);
            ts[i] = at.t;
            os[i] = hit.valid ? static_cast<std::int64_t>(hit.object) : -1;
            cs[i] = hit.evaluations;
            for (unsigned k = 0; k < 3; ++k) {
                ps[3 * i + k] = at.position[k];
                ns[3 * i + k] = at.geometric_normal[k];
                ss[3 * i + k] = at.shading_normal[k];
            }
        }
    });
    py::dict result;
    result["t"] = t;
    result["position"] = position;
    result["normal"] = normal;
    result["shading_normal"] = shading_normal;
    result["object"] = object;
    result["cost"] = cost;
    return result;
}

py::array_t<bool> occluded(const SceneHandle& self, Doubles origins, Doubles directions, double t_min, double t_max)
{
    const Rays rays(std::move(origins), std::move(directions), t_min, t_max);
    py::array_t<bool> result(static_cast<py::ssize_t>(rays.count));
    bool* out = result.mutable_data();
    const Tracer& tracer = self.scene().tracer();
    for_chunks(rays.count, kRaysAtOnce, [&](std::size_t begin, std::size_t end) {
        const std::shared_lock together(*self.gate);
        for (std::size_t i = begin; i < end; ++i) out[i] = tracer.occluded(rays[i]);
    });
    return result;
}

py::list crossings(const SceneHandle& self, Doubles origins, Doubles directions, double t_min, double t_max)
{
    const Rays rays(std::move(origins), std::move(directions), t_min, t_max);
    std::vector<std::vector<TraceHit>> all(rays.count);
    const Tracer& tracer = self.scene().tracer();
    for_chunks(rays.count, kRaysAtOnce / 8, [&](std::size_t begin, std::size_t end) {
        const std::shared_lock together(*self.gate);
        for (std::size_t i = begin; i < end; ++i) all[i] = tracer.crossings(rays[i]);
    });
    py::list result;
    for (const std::vector<TraceHit>& hits : all) {
        py::array_t<double> t(static_cast<py::ssize_t>(hits.size()));
        std::transform(hits.begin(), hits.end(), t.mutable_data(), [](const TraceHit& hit) { return hit.t; });
        result.append(t);
    }
    return result;
}

// -- the rest of a scene ---------------------------------------------------------------------------------------------

std::vector<std::string> object_names(const SceneHandle& self)
{
    std::vector<std::string> names;
    for (const SceneObject& object : self.scene().objects()) names.push_back(object.name);
    return names;
}

FieldHandle field_of_object(const SceneHandle& self, const std::string& name)
{
    const std::vector<std::string> names = object_names(self);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw Error(ErrorKind::scene,
                    Problem{{"<python>", 0, 0, {}}, "the scene has no terrain \"" + name + "\"", {}, {}, nearest_name(name, names)});
    const Shape& shape = self.scene().shapes()[static_cast<std::size_t>(found - names.begin())];
    const auto* surface = std::get_if<std::unique_ptr<Surface>>(&shape);
    const Field* field = surface ? (*surface)->field() : nullptr;
    if (!field)
        throw Error(ErrorKind::scene,
                    Problem{{"<python>", 0, 0, {}}, "the terrain \"" + name + "\" has no field", "a terrain given by an implicit function", {}, {}});
    return {self.loaded, field};
}

void add_image(py::module_& module)
{
    py::class_<ImageHandle>(module, "Image", "A rendered picture: named float32 channels. Immutable; arrays stay valid after the image is gone.")
        .def_property_readonly("channels", &channel_names, "Names of the channels, as in the EXR: 'R', 'N.X', 'variance.G' ...")
        .def_property_readonly(
            "width", [](const ImageHandle& i) { return i.image->width; }, "Of the display window, pixels.")
        .def_property_readonly(
            "height", [](const ImageHandle& i) { return i.image->height; }, "Of the display window, pixels.")
        .def_property_readonly(
            "data_window",
            [](const ImageHandle& i) { return std::make_tuple(i.image->data.x0, i.image->data.x1, i.image->data.y0, i.image->data.y1); },
            "(x0, x1, y0, y1), half-open, y downwards: the pixels that the arrays hold.")
        .def_property_readonly("metadata", &metadata_of, "What the EXR's header says, name -> int, float, str or list of floats.")
        .def("__getitem__", &channel_array, py::arg("name"),
             "image['R'] -> float32 (h, w), read-only, row 0 on top; radiance in W/m2/sr, linear, for R, G, B. Raises KeyError.")
        .def("__contains__", [](const ImageHandle& i, const std::string& name) { return i.image->find(name) != nullptr; })
        .def("__iter__", [](const ImageHandle& i) { return py::iter(py::cast(channel_names(i))); })
        .def("__len__", [](const ImageHandle& i) { return i.image->channels.size(); })
        .def("write", &write_image, py::arg("path"),
             "write(path)\n\nTo .exr (linear, all channels) or .png (through the display transform). Atomic and verified. Raises hoodoo.Error.");
}

void add_scene(py::module_& module)
{
    py::class_<SceneHandle>(module, "Scene", "A world that can be lit and asked. Safe to use from several Python threads; only edit() changes it.")
        .def("edit", &edit, py::arg("tool"), py::kw_only(), py::arg("terrain") = py::none(),
             "edit(tool, *, terrain=None, **parameters) -> int32 (n, 2)\n\nApplies an edit tool to the layers of a terrain, as if it were the next "
             "[[terrain.NAME.edit]] table of the scene (see tools() for the parameters), and makes anew what it touched of surface, rocks and "
             "acceleration structure. Pictures afterwards are those of a scene loaded with that table. terrain may be left out where there is only "
             "one. Returns the columns (i, j) that may have changed, sorted by j, then i. Waits for renders and queries under way; a Field of the "
             "terrain must not be used meanwhile. Raises hoodoo.Error: a scene that was not loaded with editable=True, a terrain without layers, an "
             "unknown tool, a value that cannot be; nothing has changed then.")
        .def("render", &render_image, py::arg("width") = py::none(), py::arg("height") = py::none(), py::arg("spp") = py::none(),
             py::arg("threads") = 0, py::arg("seed") = py::none(), py::arg("progress") = py::none(),
             "render(width=None, height=None, spp=None, threads=0, seed=None, progress=None) -> Image\n\nwidth, height: pixels; spp: samples a "
             "pixel; None: what the scene says. threads: 0 means all. "
             "progress: called with the fraction done, in [0, 1], from the calling thread. The picture does not depend on threads. The interpreter "
             "is free meanwhile; Ctrl-C raises KeyboardInterrupt "
             "within a second. Raises hoodoo.Error.")
        .def("intersect", &intersect, py::arg("origins"), py::arg("directions"), py::arg("t_min") = 0.0, py::arg("t_max") = kInfinity,
             "intersect(origins, directions, t_min=0, t_max=inf) -> dict of arrays\n\norigins, directions: float64 (n, 3), world space, metres; "
             "directions of any length but zero.\n"
             "t: float64 (n,) metres, inf on a miss. position: float64 (n, 3) metres; normal, shading_normal: float64 (n, 3), unit, towards air; all "
             "nan on a miss. "
             "object: int64 (n,), index into Scene.objects, -1 on a miss. cost: int64 (n,), field evaluations spent.\nA ray that is not finite is a "
             "miss. Raises hoodoo.Error: wrong shapes.")
        .def("crossings", &crossings, py::arg("origins"), py::arg("directions"), py::arg("t_min") = 0.0, py::arg("t_max") = kInfinity,
             "crossings(origins, directions, t_min=0, t_max=inf) -> list of n arrays\n\nDistances in metres, increasing, of every crossing of each "
             "ray "
             "in the open interval (t_min, t_max): ways in and ways out (Gamito and Musgrave 2001, section 3.1).")
        .def("occluded", &occluded, py::arg("origins"), py::arg("directions"), py::arg("t_min") = 0.0, py::arg("t_max") = kInfinity,
             "occluded(origins, directions, t_min=0, t_max=inf) -> bool (n,)\n\nWhether anything lies in the open interval (t_min, t_max), metres "
             "along each ray.")
        .def("field", &field_of_object, py::arg("name"),
             "field(name) -> Field\n\nThe implicit function of a terrain of the scene. Raises hoodoo.Error: no such terrain, or one without a field.")
        .def_property_readonly("objects", &object_names, "Names of the terrains, in the order of `object` (the objectId of a picture is one more).")
        .def_property_readonly(
            "materials", [](const SceneHandle& s) { return s.scene().material_names(); }, "Names of the materials.")
        .def_property_readonly(
            "bounds",
            [](const SceneHandle& s) {
                const Box3d& b = s.scene().bounds();
                return std::make_pair(std::make_tuple(b.min.x, b.min.y, b.min.z), std::make_tuple(b.max.x, b.max.y, b.max.z));
            },
            "((x, y, z) lowest, (x, y, z) highest), metres.");
}

}  // namespace

}  // namespace hoodoo::python

PYBIND11_MODULE(hoodoo, module)
{
    using namespace hoodoo::python;
    module.doc() =
        "Hoodoo: a path tracer for terrains that height maps and meshes cannot hold. Lengths in metres, angles in radians, z up, right-handed.";
    py::register_exception<hoodoo::Error>(module, "Error", PyExc_ValueError).attr("__doc__") =
        "Anything wrong with a scene, a file or an argument; its text says where, what, what was expected and what was found.";
    add_field(module);
    add_terrain(module);
    add_voxels(module);
    add_analysis(module);
    add_image(module);
    add_scene(module);
    module.def("load", &load, py::arg("path_or_toml_text"), py::arg("overrides") = py::dict(), py::arg("seed") = py::none(), py::arg("threads") = 0,
               py::arg("editable") = false,
               "load(path_or_toml_text, overrides={}, seed=None, threads=0, editable=False) -> Scene\n\nA scene file, or the text of one (anything "
               "with a line end). "
               "overrides: {'terrain.valley.sigma': 2.0} replaces "
               "values of the scene, {'params.x': 3} fills its [params]. threads: for building, 0 means all. editable: takes edits later; rays are "
               "then a little slower. Raises hoodoo.Error with every problem "
               "of the file and its place.");
}
