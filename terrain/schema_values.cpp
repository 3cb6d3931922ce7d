// One value of a scene, read as its parameter's type: numbers with units, colours with a space, lists with a length. SI units only; decimal point
// only. A bare number is metres or seconds, but never an angle, where degrees and radians are mixed up too often: NAME_deg or a unit says which.
// Deviation: an integer may also be written as an integral real number (spp = 1e3). Missing: temperatures and compound units.
#include "terrain/schema_values.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstddef>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

/// x / 180 first: the usual angles (90, 45, 30 deg ...) then give the nearest double to pi / 2, pi / 4 ...
double radians(double degrees)
{
    return degrees / 180.0 * kPi;
}

struct Unit {
    const char* name;
    ParameterType type;
    double factor;  // to the SI unit
};

constexpr double by_degrees = -1.0;
constexpr std::array units = {
    Unit{"m", ParameterType::length, 1.0},     Unit{"km", ParameterType::length, 1e3},        Unit{"cm", ParameterType::length, 1e-2},
    Unit{"mm", ParameterType::length, 1e-3},   Unit{"um", ParameterType::length, 1e-6},       Unit{"nm", ParameterType::length, 1e-9},
    Unit{"rad", ParameterType::angle, 1.0},    Unit{"deg", ParameterType::angle, by_degrees}, Unit{"s", ParameterType::duration, 1.0},
    Unit{"ms", ParameterType::duration, 1e-3}, Unit{"min", ParameterType::duration, 60.0},    Unit{"h", ParameterType::duration, 3600.0},
};

const double* real(const Node& node)
{
    return std::get_if<double>(&node.value);
}
const std::int64_t* whole(const Node& node)
{
    return std::get_if<std::int64_t>(&node.value);
}
const std::string* string(const Node& node)
{
    return std::get_if<std::string>(&node.value);
}

std::optional<double> bare_number(const Node& node)
{
    if (const auto* i = whole(node)) return static_cast<double>(*i);
    if (const auto* x = real(node); x && std::isfinite(*x)) return *x;
    return std::nullopt;
}

std::string in_unit(double value, const Parameter& p)
{
    return p.type == ParameterType::angle ? fmt::format("{:.6g} deg", value / kPi * 180.0) : fmt::format("{}", value);
}

std::string range_text(const Parameter& p)
{
    const bool low = p.minimum > -kInfinity, high = p.maximum < kInfinity;
    if (low && p.above_minimum) return " above " + in_unit(p.minimum, p) + (high ? ", at most " + in_unit(p.maximum, p) : "");
    if (low && high) return " between " + in_unit(p.minimum, p) + " and " + in_unit(p.maximum, p);
    if (low) return " of at least " + in_unit(p.minimum, p);
    return high ? " of at most " + in_unit(p.maximum, p) : "";
}

std::string count_text(const Parameter& p)
{
    const bool bounded = p.max_count < (1 << 20);
    if (p.min_count == p.max_count) return fmt::format("{} ", p.min_count);
    if (bounded) return fmt::format("{} to {} ", p.min_count, p.max_count);
    return p.min_count > 0 ? fmt::format("at least {} ", p.min_count) : "";
}

std::string choice_text(const std::vector<std::string>& choices)
{
    std::string out;
    for (std::size_t i = 0; i < choices.size(); ++i) out += (i ? ", " : "") + fmt::format("\"{}\"", choices[i]);
    return out;
}

std::optional<int> hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return std::nullopt;
}

std::optional<ColorValue> hex_color(const std::string& text)
{
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    ColorValue color;
    color.space = "srgb";
    for (unsigned k = 0; k < 3; ++k) {
        const auto high = hex_digit(text[1 + 2 * k]), low = hex_digit(text[2 + 2 * k]);
        if (!high || !low) return std::nullopt;
        color.rgb[static_cast<int>(k)] = (*high * 16 + *low) / 255.0;
    }
    return color;
}

}  // namespace

std::string expected_text(const Parameter& p)
{
    switch (p.type) {
        case ParameterType::boolean:
            return "true or false";
        case ParameterType::integer:
            return "an integer" + range_text(p);
        case ParameterType::number:
            return "a number" + range_text(p);
        case ParameterType::length:
            return "a length such as 350 (metres) or \"350 m\"" + range_text(p);
        case ParameterType::angle:
            return fmt::format("an angle such as \"12 deg\" (or the key {}_deg with a number){}", p.name, range_text(p));
        case ParameterType::duration:
            return "a time such as 0.04 (seconds) or \"40 ms\"" + range_text(p);
        case ParameterType::text:
            return "a text";
        case ParameterType::choice:
            return "one of " + choice_text(p.choices);
        case ParameterType::vector:
            return "a list of " + count_text(p) + (p.unit == "m" ? "lengths" : "numbers") + range_text(p);
        case ParameterType::points:
            return "a list of " + count_text(p) + "points [x, y, z] in metres";
        case ParameterType::color:
            return "a colour such as \"#c8a070\" or { srgb = [0.8, 0.6, 0.4] } (srgb, lin_rec709, acescg, grey)" + range_text(p);
        case ParameterType::path:
            return "a path";
        case ParameterType::names:
            return "a list of " + count_text(p) + (p.choices.empty() ? "texts" : "of " + choice_text(p.choices));
        case ParameterType::tables:
            return "a list of " + count_text(p) + "tables, written [[...]]";
    }
    return {};
}

std::string quoted_value(const Node& node)
{
    if (const auto* b = std::get_if<bool>(&node.value)) return *b ? "true" : "false";
    if (const auto* i = whole(node)) return std::to_string(*i);
    if (const auto* x = real(node)) return fmt::format("{}", *x);
    if (const auto* s = string(node)) return "\"" + *s + "\"";
    if (const auto* a = std::get_if<Node::Array>(&node.value)) return fmt::format("a list of {} value{}", a->size(), a->size() == 1 ? "" : "s");
    return "a table";
}

std::optional<double> parse_quantity(const std::string& text, ParameterType type)
{
    double number = 0.0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
    std::string name(rest, end);
    name.erase(0, name.find_first_not_of(' '));
    for (const Unit& unit : units)
        if (unit.type == type && name == unit.name) {
            const double value = unit.factor == by_degrees ? radians(number) : number * unit.factor;
            return std::isfinite(value) ? std::optional(value) : std::nullopt;
        }
    return std::nullopt;
}

void ValueReader::wrong(const Node& node, const std::string& what, std::string nearest) const
{
    if (!node.broken) problems_.push_back({node.where, what, expected_text(p_), quoted_value(node), std::move(nearest)});
}

bool ValueReader::in_range(double value, const Node& node) const
{
    if (value >= p_.minimum && value <= p_.maximum && !(p_.above_minimum && value == p_.minimum)) return true;
    wrong(node, p_.name + " is out of range");
    return false;
}

std::optional<bool> ValueReader::boolean() const
{
    if (const auto* b = std::get_if<bool>(&node_.value)) return *b;
    wrong(node_, p_.name + " has the wrong type");
    return std::nullopt;
}

std::optional<std::int64_t> ValueReader::integer() const
{
    std::optional<std::int64_t> value;
    if (const auto* i = whole(node_)) value = *i;
    // 2^53: below it every integral double is exact.
    if (const auto* x = real(node_); x && std::abs(*x) <= 0x1p53 && std::trunc(*x) == *x) value = static_cast<std::int64_t>(*x);
    if (!value) {
        wrong(node_, p_.name + " has the wrong type");
        return std::nullopt;
    }
    return in_range(static_cast<double>(*value), node_) ? value : std::nullopt;
}

std::optional<double> ValueReader::component(const Node& node) const
{
    const bool lengths = p_.type == ParameterType::length || p_.unit == "m";
    std::optional<double> value;
    if (p_.type != ParameterType::angle) value = bare_number(node);
    if (const auto* s = string(node); s && p_.type != ParameterType::number) value = parse_quantity(*s, lengths ? ParameterType::length : p_.type);
    if (!value) {
        const bool bare_angle = p_.type == ParameterType::angle && bare_number(node);
        wrong(node, p_.name + (bare_angle ? " is an angle without a unit" : string(node) ? " cannot be read" : " has the wrong type"));
        return std::nullopt;
    }
    return in_range(*value, node) ? value : std::nullopt;
}

std::optional<double> ValueReader::number() const
{
    return component(node_);
}

std::optional<double> ValueReader::degrees() const
{
    const auto value = bare_number(node_);
    if (!value) {
        wrong(node_, p_.name + "_deg has the wrong type");
        return std::nullopt;
    }
    return in_range(radians(*value), node_) ? std::optional(radians(*value)) : std::nullopt;
}

std::optional<std::string> ValueReader::word(const Node& node) const
{
    const auto* s = string(node);
    if (!s) {
        wrong(node, p_.name + " has the wrong type");
        return std::nullopt;
    }
    for (const std::string& choice : p_.choices)
        if (choice == *s) return *s;
    if (p_.choices.empty()) return *s;
    wrong(node, p_.name + " has an unknown value", nearest_name(*s, p_.choices));
    return std::nullopt;
}

std::optional<std::string> ValueReader::text() const
{
    auto value = word(node_);
    if (value && p_.type == ParameterType::path && value->empty()) {
        wrong(node_, p_.name + " is empty");
        return std::nullopt;
    }
    return value;
}

const Node::Array* ValueReader::list() const
{
    const auto* items = std::get_if<Node::Array>(&node_.value);
    if (!items) {
        wrong(node_, p_.name + " has the wrong type");
        return nullptr;
    }
    if (items->size() < static_cast<std::size_t>(p_.min_count) || items->size() > static_cast<std::size_t>(p_.max_count)) {
        wrong(node_, p_.name + " has the wrong length");
        return nullptr;
    }
    return items;
}

std::optional<std::vector<double>> ValueReader::vector() const
{
    const auto* items = list();
    if (!items) return std::nullopt;
    std::vector<double> out;
    for (const Node& item : *items)
        if (const auto x = component(item)) out.push_back(*x);
    return out.size() == items->size() ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<std::vector<Vec3d>> ValueReader::points() const
{
    const auto* items = list();
    if (!items) return std::nullopt;
    Parameter length = p_;
    length.type = ParameterType::vector;
    length.unit = "m";
    length.min_count = length.max_count = 3;
    std::vector<Vec3d> out;
    for (const Node& item : *items)
        if (const auto xyz = ValueReader(length, item, problems_).vector()) out.emplace_back((*xyz)[0], (*xyz)[1], (*xyz)[2]);
    return out.size() == items->size() ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<std::vector<std::string>> ValueReader::names() const
{
    const auto* items = list();
    if (!items) return std::nullopt;
    std::vector<std::string> out;
    for (const Node& item : *items)
        if (auto name = word(item)) out.push_back(std::move(*name));
    return out.size() == items->size() ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<ColorValue> ValueReader::color() const
{
    std::optional<ColorValue> color;
    if (const auto* s = string(node_)) color = hex_color(*s);
    const auto* table = std::get_if<Node::Table>(&node_.value);
    if (table && table->size() == 1) {
        const auto& [space, value] = table->front();
        Parameter numbers = p_;
        numbers.name += "." + space;
        numbers.unit.clear();
        numbers.type = space == "grey" ? ParameterType::number : ParameterType::vector;
        numbers.min_count = numbers.max_count = 3;
        const ValueReader reader(numbers, value, problems_);
        if (space == "grey") {  // the same number in each channel is a grey of that reflectance in every space with this white
            const auto g = reader.number();
            return g ? std::optional(ColorValue{Vec3d(*g), "acescg"}) : std::nullopt;
        }
        if (space == "acescg" || space == "lin_rec709" || space == "srgb") {
            const auto rgb = reader.vector();
            return rgb ? std::optional(ColorValue{Vec3d((*rgb)[0], (*rgb)[1], (*rgb)[2]), space}) : std::nullopt;
        }
        problems_.push_back({value.key_where, fmt::format("unknown colour space of {}", p_.name), expected_text(p_), "\"" + space + "\"",
                             nearest_name(space, {"srgb", "lin_rec709", "acescg", "grey"})});
        return std::nullopt;
    }
    if (!color) {
        wrong(node_, p_.name + (string(node_) ? " cannot be read" : " has the wrong type"));
        return std::nullopt;
    }
    for (int k = 0; k < 3; ++k)
        if (!in_range(color->rgb[k], node_)) return std::nullopt;
    return color;
}

}  // namespace hoodoo
