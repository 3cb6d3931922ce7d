// Parameters as data: name, unit, default, range, doc; and values that know where in the scene file they stand.
// From a Schema follow parsing, error texts, --help, the JSON Schema for editors, and every binding. Nothing is copied by hand.
#pragma once

#include "terrain/error.h"
#include "terrain/math/vec.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hoodoo
{

/// A scene file (or a host's dictionary) as plain data, each value with its position. Tables keep the order of the file.
struct Node {
    using Array = std::vector<Node>;
    using Table = std::vector<std::pair<std::string, Node>>;
    std::variant<bool, std::int64_t, double, std::string, Array, Table> value = Table{};
    Source where;         ///< of the value
    Source key_where;     ///< of its key (the value's own position inside arrays)
    bool broken = false;  ///< already has its Problem (an expression that failed): no second one for its type

    const Node* find(const std::string& key) const;  ///< nullptr if absent or if this is no table
};

enum class ParameterType {
    boolean,
    integer,
    number,    ///< no unit
    length,    ///< metres; also "350 m", "1.2 km", "5 mm"
    angle,     ///< radians inside; in a file "12 deg", "0.2 rad", or the key NAME_deg with a bare number. A bare number under NAME is an error
    duration,  ///< seconds; also "40 ms"
    text,
    choice,  ///< one of `choices`
    vector,  ///< `min_count` to `max_count` bare numbers (or unit strings where unit == "m")
    points,  ///< a list of points of three numbers, metres
    color,   ///< names its space: { acescg = [r,g,b] }, { lin_rec709 = [..] }, { srgb = [..] }, { grey = 0.5 }, or "#c8a070" (sRGB)
    path,    ///< a file, relative to the file that names it
    names,   ///< a list of texts, each one of `choices` where choices are given
    tables,  ///< a list of tables ([[...]]), each checked by the member of `items` that `discriminator` chooses
};

struct Parameter;

struct Schema {
    std::string name;
    std::string doc;
    std::vector<Parameter> parameters;
};

/// A colour as written: three numbers and the space they are in (acescg, lin_rec709, srgb). Converted by the renderer, never assumed.
struct ColorValue {
    Vec3d rgb{0.0};
    std::string space = "acescg";
};

using Default = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>, ColorValue, std::vector<std::string>>;

/// One parameter. `required` and a default exclude each other; an optional one without default reads as absent (Values::has is false).
struct Parameter {
    std::string name = {};
    ParameterType type = ParameterType::number;
    std::string doc = {};
    Default fallback = {};
    bool required = false;
    std::string unit = {};        ///< for the documentation: "m", "cell", "1/m"
    double minimum = -kInfinity;  ///< inclusive, for every component
    double maximum = kInfinity;
    bool above_minimum = false;  ///< minimum itself excluded
    std::vector<std::string> choices = {};
    int min_count = 0;  ///< vector, points, names, tables
    int max_count = 1 << 20;
    std::string discriminator = {};  ///< tables: the key that names the item's schema
    std::vector<Schema> items = {};  ///< tables: one schema for each value of the discriminator (exactly one if it is empty)
};

/// Checked values of one table. Getters throw an internal Error on a name the schema does not have: a typing error of ours, not of the user.
/// An absent optional value throws too, except for lists (points, names, tables), which read as empty.
class Values
{
public:
    bool has(const std::string& name) const;
    bool boolean(const std::string& name) const;
    std::int64_t integer(const std::string& name) const;
    double number(const std::string& name) const;            ///< number, length, angle (radians), duration
    const std::string& text(const std::string& name) const;  ///< text, choice, path
    const std::vector<double>& vector(const std::string& name) const;
    Vec3d vec3(const std::string& name) const;
    Vec2d vec2(const std::string& name) const;
    const std::vector<Vec3d>& points(const std::string& name) const;
    const ColorValue& color(const std::string& name) const;
    const std::vector<std::string>& names(const std::string& name) const;
    const std::vector<Values>& tables(const std::string& name) const;

    /// The item schema's name that the discriminator chose ("" outside `tables`).
    const std::string& variant() const { return variant_; }
    /// Where the value stands; the table's own position if it has its default.
    const Source& where(const std::string& name) const;
    const Source& where() const { return where_; }

    /// An Error at the value's position, to throw for what only the factory can know.
    Error problem(const std::string& name, std::string what, std::string expected = {}, std::string got = {}) const;

private:
    friend Values check(const Schema&, const Node&, std::vector<Problem>&);
    using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<Vec3d>, ColorValue, std::vector<std::string>,
                               std::vector<Values>>;
    struct Entry {
        Value value;
        Source where;
    };
    const Entry* entry(const std::string& name) const;
    template <class T>
    const T& get(const std::string& name) const;
    template <class T>
    const std::vector<T>& get_list(const std::string& name) const;
    void read(const Parameter& parameter, const Node& node, bool in_degrees, std::vector<Problem>& problems);
    void fill(const Parameter& parameter);

    std::map<std::string, Entry> entries_;
    std::vector<std::string> known_;  ///< all names of the schema
    std::string variant_;
    Source where_;
};

/// Checks a table against its schema. Unknown keys, wrong types, ranges, counts, missing values: each becomes a Problem; nothing is thrown.
/// A key that only chose the schema (such as "type") is taken out by the caller first.
Values check(const Schema& schema, const Node& table, std::vector<Problem>& problems);

}  // namespace hoodoo
