// One value of a scene, read as its parameter's type. Each reader returns nothing and adds a Problem if the value is wrong; none throws.
#pragma once

#include "terrain/schema.h"

#include <optional>

namespace hoodoo
{

/// What a parameter accepts, in words for an error: `a length in m such as 350 or "350 m", above 0`.
std::string expected_text(const Parameter& parameter);

/// A value as an error quotes it: `12`, `"sand"`, `a list of 3 values`, `a table`.
std::string quoted_value(const Node& node);

/// "350 m", "12 deg", "40 ms" -> metres, radians, seconds; nothing if `text` is no number with a unit of `type` (length, angle, duration). Finite.
std::optional<double> parse_quantity(const std::string& text, ParameterType type);

/// Reads one value; `problems` grows where it is wrong.
class ValueReader
{
public:
    ValueReader(const Parameter& parameter, const Node& node, std::vector<Problem>& problems) : p_(parameter), node_(node), problems_(problems) {}

    std::optional<bool> boolean() const;
    std::optional<std::int64_t> integer() const;
    std::optional<double> number() const;   ///< number, length, angle (unit string), duration
    std::optional<double> degrees() const;  ///< the bare number of a key NAME_deg, in radians
    std::optional<std::string> text() const;
    std::optional<std::vector<double>> vector() const;
    std::optional<std::vector<Vec3d>> points() const;
    std::optional<ColorValue> color() const;
    std::optional<std::vector<std::string>> names() const;

    /// The list itself, its length checked.
    const Node::Array* list() const;

private:
    void wrong(const Node& node, const std::string& what, std::string nearest = {}) const;
    bool in_range(double value, const Node& node) const;
    std::optional<double> component(const Node& node) const;
    std::optional<std::string> word(const Node& node) const;

    const Parameter& p_;
    const Node& node_;
    std::vector<Problem>& problems_;
};

}  // namespace hoodoo
