// A table of a scene checked against its schema: every key is known, every value has its type, unit and range, nothing that is needed is missing.
// Missing: relations between parameters; a factory reports them with Values::problem at the value's own position.
#include "terrain/schema.h"

#include "terrain/schema_values.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

[[noreturn]] void misuse(const std::string& name, const char* what)
{
    throw Error(ErrorKind::internal, fmt::format("parameter \"{}\" {}", name, what));
}

const Parameter* find_parameter(const Schema& schema, const std::string& key, bool& in_degrees)
{
    in_degrees = false;
    for (const Parameter& p : schema.parameters)
        if (p.name == key) return &p;
    for (const Parameter& p : schema.parameters)
        if (p.type == ParameterType::angle && p.name + "_deg" == key) {
            in_degrees = true;
            return &p;
        }
    return nullptr;
}

std::vector<std::string> keys_of(const Schema& schema)
{
    std::vector<std::string> names;
    for (const Parameter& p : schema.parameters) {
        names.push_back(p.name);
        if (p.type == ParameterType::angle) names.push_back(p.name + "_deg");
    }
    return names;
}

/// One item of a list of tables: its discriminator chooses the schema and is taken out.
const Schema* choose_item(const Parameter& p, Node& item, std::vector<Problem>& problems)
{
    auto* table = std::get_if<Node::Table>(&item.value);
    if (!table) {
        problems.push_back({item.where, "an item of " + p.name + " has the wrong type", "a table", quoted_value(item), {}});
        return nullptr;
    }
    if (p.discriminator.empty()) return &p.items.front();
    std::vector<std::string> names;
    for (const Schema& s : p.items) names.push_back(s.name);
    const auto key = std::find_if(table->begin(), table->end(), [&](const auto& entry) { return entry.first == p.discriminator; });
    Parameter choice{.name = p.discriminator, .type = ParameterType::choice, .doc = {}, .choices = names};
    if (key == table->end()) {
        problems.push_back({item.where, fmt::format("an item of {} lacks the key \"{}\"", p.name, p.discriminator), expected_text(choice), {}, {}});
        return nullptr;
    }
    const auto chosen = ValueReader(choice, key->second, problems).text();
    table->erase(key);
    if (!chosen) return nullptr;
    return &*std::find_if(p.items.begin(), p.items.end(), [&](const Schema& s) { return s.name == *chosen; });
}

}  // namespace

const Node* Node::find(const std::string& key) const
{
    if (const auto* table = std::get_if<Table>(&value))
        for (const auto& [name, node] : *table)
            if (name == key) return &node;
    return nullptr;
}

// -- Values -------------------------------------------------------------------------------------------------------------

const Values::Entry* Values::entry(const std::string& name) const
{
    const auto found = entries_.find(name);
    if (found != entries_.end()) return &found->second;
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) misuse(name, "is not in the schema");
    return nullptr;
}

template <class T>
const T& Values::get(const std::string& name) const
{
    const Entry* e = entry(name);
    if (!e) misuse(name, "has no value: ask has() first");
    if (const T* value = std::get_if<T>(&e->value)) return *value;
    misuse(name, "is read as another type than its schema says");
}

template <class T>
const std::vector<T>& Values::get_list(const std::string& name) const
{
    static const std::vector<T> none;
    return entry(name) ? get<std::vector<T>>(name) : none;
}

bool Values::has(const std::string& name) const
{
    return entry(name) != nullptr;
}
bool Values::boolean(const std::string& name) const
{
    return get<bool>(name);
}
std::int64_t Values::integer(const std::string& name) const
{
    return get<std::int64_t>(name);
}
double Values::number(const std::string& name) const
{
    return get<double>(name);
}
const std::string& Values::text(const std::string& name) const
{
    return get<std::string>(name);
}
const std::vector<double>& Values::vector(const std::string& name) const
{
    return get<std::vector<double>>(name);
}
const std::vector<Vec3d>& Values::points(const std::string& name) const
{
    return get_list<Vec3d>(name);
}
const ColorValue& Values::color(const std::string& name) const
{
    return get<ColorValue>(name);
}
const std::vector<std::string>& Values::names(const std::string& name) const
{
    return get_list<std::string>(name);
}
const std::vector<Values>& Values::tables(const std::string& name) const
{
    return get_list<Values>(name);
}

Vec3d Values::vec3(const std::string& name) const
{
    const auto& v = vector(name);
    if (v.size() != 3) misuse(name, "has not three numbers");
    return {v[0], v[1], v[2]};
}

Vec2d Values::vec2(const std::string& name) const
{
    const auto& v = vector(name);
    if (v.size() != 2) misuse(name, "has not two numbers");
    return {v[0], v[1]};
}

const Source& Values::where(const std::string& name) const
{
    const Entry* e = entry(name);
    return e ? e->where : where_;
}

Error Values::problem(const std::string& name, std::string what, std::string expected, std::string got) const
{
    return Error(ErrorKind::scene, Problem{where(name), std::move(what), std::move(expected), std::move(got), {}});
}

// -- Checking -----------------------------------------------------------------------------------------------------------

void Values::read(const Parameter& p, const Node& node, bool in_degrees, std::vector<Problem>& problems)
{
    const ValueReader reader(p, node, problems);
    const auto keep = [&](auto&& value) {
        if (value) entries_[p.name] = Entry{Value(*std::move(value)), node.where};
    };
    switch (p.type) {
        case ParameterType::boolean:
            return keep(reader.boolean());
        case ParameterType::integer:
            return keep(reader.integer());
        case ParameterType::number:
        case ParameterType::length:
        case ParameterType::duration:
            return keep(reader.number());
        case ParameterType::angle:
            return keep(in_degrees ? reader.degrees() : reader.number());
        case ParameterType::text:
        case ParameterType::choice:
        case ParameterType::path:
            return keep(reader.text());
        case ParameterType::vector:
            return keep(reader.vector());
        case ParameterType::points:
            return keep(reader.points());
        case ParameterType::color:
            return keep(reader.color());
        case ParameterType::names:
            return keep(reader.names());
        case ParameterType::tables:
            break;
    }
    const Node::Array* items = reader.list();
    if (!items) return;
    std::vector<Values> tables;
    for (Node item : *items)
        if (const Schema* schema = choose_item(p, item, problems)) {
            tables.push_back(check(*schema, item, problems));
            if (!p.discriminator.empty()) tables.back().variant_ = schema->name;
        }
    entries_[p.name] = Entry{Value(std::move(tables)), node.where};
}

void Values::fill(const Parameter& p)
{
    const bool real =
        p.type == ParameterType::number || p.type == ParameterType::length || p.type == ParameterType::angle || p.type == ParameterType::duration;
    const auto keep = [&](auto&& value) { entries_[p.name] = Entry{Value(value), where_}; };
    std::visit(
        [&](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, std::monostate>)
                return;
            else if constexpr (std::is_same_v<T, std::int64_t>)
                real ? keep(static_cast<double>(value)) : keep(value);
            else if constexpr (std::is_same_v<T, std::vector<double>>) {
                if (p.type != ParameterType::points) return keep(value);
                std::vector<Vec3d> points;
                for (std::size_t i = 0; i + 2 < value.size(); i += 3) points.emplace_back(value[i], value[i + 1], value[i + 2]);
                keep(points);
            } else
                keep(value);
        },
        p.fallback);
}

Values check(const Schema& schema, const Node& table, std::vector<Problem>& problems)
{
    Values values;
    values.where_ = table.where;
    for (const Parameter& p : schema.parameters) values.known_.push_back(p.name);
    const auto* entries = std::get_if<Node::Table>(&table.value);
    if (!entries) {
        problems.push_back({table.where, schema.name + " has the wrong type", "a table", quoted_value(table), {}});
        return values;
    }

    // Read what is there.
    std::vector<std::string> seen;
    for (const auto& [key, node] : *entries) {
        bool in_degrees = false;
        const Parameter* p = find_parameter(schema, key, in_degrees);
        if (!p) {
            problems.push_back({node.key_where,
                                fmt::format("unknown key \"{}\" in {}", key, schema.name),
                                {},
                                {},
                                problems.size() < 100 ? nearest_name(key, keys_of(schema)) : std::string()});
            continue;
        }
        if (std::find(seen.begin(), seen.end(), p->name) != seen.end())
            problems.push_back({node.key_where, fmt::format("{} is given twice", p->name), "one of " + p->name + " and " + p->name + "_deg", {}, {}});
        seen.push_back(p->name);
        values.read(*p, node, in_degrees, problems);
    }

    // Fill in what is not there.
    for (const Parameter& p : schema.parameters) {
        if (std::find(seen.begin(), seen.end(), p.name) != seen.end()) continue;
        if (p.required) problems.push_back({table.where, fmt::format("{} lacks the key \"{}\"", schema.name, p.name), expected_text(p), {}, {}});
        values.fill(p);
    }
    return values;
}

}  // namespace hoodoo
