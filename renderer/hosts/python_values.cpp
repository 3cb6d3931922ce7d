// Conversions of the Python module, and waiting for C++ without deafening the interpreter.
//
// Python runs signal handlers only in its main thread and only while that thread holds the interpreter: so the calling thread never does the work
// itself, it wakes up twenty times a second to ask. Texts become TOML strings, never bare words, so that a text stays a text.

#include "renderer/hosts/python_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>

namespace hoodoo::python
{

namespace
{

constexpr int kDeepest = 64;

std::string type_name(const py::handle& object)
{
    return py::str(py::type::of(object).attr("__name__"));
}

std::string quoted(const std::string& text)
{
    std::string out = "\"";
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += std::string("\\") + c;
        else if (u < 0x20 || u == 0x7f)
            out += fmt::format("\\u{:04X}", u);
        else
            out += c;
    }
    return out + "\"";
}

/// A NumPy array or scalar as plain Python, a path as its text; anything else as it is.
py::object plain(const py::handle& object)
{
    if (py::hasattr(object, "__fspath__")) return object.attr("__fspath__")();
    if (py::hasattr(object, "tolist") && !py::isinstance<py::list>(object)) return object.attr("tolist")();
    return py::reinterpret_borrow<py::object>(object);
}

Node node_at_depth(const py::handle& given, const std::string& what, int depth)
{
    if (depth > kDeepest) refuse(what + " is nested too deeply", "at most 64 levels", {});
    const py::object object = plain(given);
    Node node;
    node.where = node.key_where = {"<python>", 0, 0, {}};
    if (py::isinstance<py::bool_>(object)) {
        node.value = object.cast<bool>();
    } else if (py::isinstance<py::int_>(object)) {
        node.value = object.cast<std::int64_t>();
    } else if (py::isinstance<py::float_>(object)) {
        node.value = object.cast<double>();
    } else if (py::isinstance<py::str>(object)) {
        node.value = object.cast<std::string>();
    } else if (py::isinstance<py::dict>(object)) {
        Node::Table table;
        for (const auto& [key, value] : object.cast<py::dict>()) {
            const std::string name = py::str(key);
            table.emplace_back(name, node_at_depth(value, name, depth + 1));
        }
        node.value = std::move(table);
    } else if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
        Node::Array items;
        for (const auto& item : object) items.push_back(node_at_depth(item, what, depth + 1));
        node.value = std::move(items);
    } else {
        refuse(what + " has a type no scene value has", "bool, int, float, str, a list or a dict", type_name(object));
    }
    return node;
}

std::string toml_of(const Node& node)
{
    struct Writer {
        std::string operator()(bool v) const { return v ? "true" : "false"; }
        std::string operator()(std::int64_t v) const { return std::to_string(v); }
        std::string operator()(double v) const
        {
            if (std::isnan(v)) return "nan";
            if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
            const std::string text = fmt::format("{}", v);
            return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
        }
        std::string operator()(const std::string& v) const { return quoted(v); }
        std::string operator()(const Node::Array& items) const
        {
            std::string out;
            for (const Node& item : items) out += (out.empty() ? "" : ", ") + toml_of(item);
            return "[" + out + "]";
        }
        std::string operator()(const Node::Table& table) const
        {
            std::string out;
            for (const auto& [key, item] : table) out += (out.empty() ? "" : ", ") + quoted(key) + " = " + toml_of(item);
            return "{" + out + "}";
        }
    };
    return std::visit(Writer{}, node.value);
}

}  // namespace

std::string path_text(const py::object& path)
{
    return py::hasattr(path, "__fspath__") ? py::str(path.attr("__fspath__")()).cast<std::string>() : path.cast<std::string>();
}

void refuse(std::string what, std::string expected, std::string got)
{
    throw Error(ErrorKind::scene, Problem{{"<python>", 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

Node node_from(const py::handle& object, const std::string& what)
{
    return node_at_depth(object, what, 0);
}

std::string toml_from(const py::handle& object, const std::string& what)
{
    return toml_of(node_from(object, what));
}

SceneOverrides overrides_from(const py::dict& overrides)
{
    SceneOverrides result;
    for (const auto& [key, value] : overrides) {
        const std::string name = py::str(key);
        const std::string params = "params.";
        if (name.rfind(params, 0) == 0)
            result.params.emplace_back(name.substr(params.size()), toml_from(value, name));
        else
            result.sets.emplace_back(name, toml_from(value, name));
    }
    return result;
}

std::vector<py::ssize_t> shape_of_points(const Doubles& points, const std::string& what)
{
    std::vector<py::ssize_t> shape(points.shape(), points.shape() + points.ndim());
    if (shape.empty() || shape.back() != 3) {
        std::string got;
        for (const py::ssize_t n : shape) got += (got.empty() ? "" : ", ") + std::to_string(n);
        refuse(what + " has a wrong shape", "(n, 3)", "(" + got + ")");
    }
    shape.pop_back();
    return shape;
}

py::array_t<std::int32_t> columns_array(const ColumnSet& columns)
{
    py::array_t<std::int32_t> array({static_cast<py::ssize_t>(columns.count()), py::ssize_t{2}});
    std::int32_t* out = array.mutable_data();
    for (const std::uint32_t index : columns.indices()) {
        const Vec2i at = columns.column(index);
        *out++ = at.x;
        *out++ = at.y;
    }
    return array;
}

void run_interruptibly(const std::function<void()>& work, const std::function<void()>& stop, const std::function<void()>& idle)
{
    std::future<void> done = std::async(std::launch::async, work);
    const auto finish = [&] {
        py::gil_scoped_release free;
        done.wait();
    };
    for (;;) {
        bool ready = false;
        {
            py::gil_scoped_release free;
            ready = done.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready;
        }
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            idle();
        } catch (...) {
            stop();
            finish();
            throw;
        }
        if (ready) break;
    }
    done.get();
}

void for_chunks(std::size_t count, std::size_t chunk_size, const std::function<void(std::size_t, std::size_t)>& chunk)
{
    for (std::size_t begin = 0; begin < count; begin += chunk_size) {
        {
            py::gil_scoped_release free;
            chunk(begin, std::min(begin + chunk_size, count));
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
}

}  // namespace hoodoo::python
