// Every schema of a scene keeps the promises that parsing, help and editors rely on.
#include "renderer/scene/sections.h"

#include "renderer/scene/json_schema.h"
#include "terrain/schema_values.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

using namespace hoodoo;

namespace
{

bool snake_case(const std::string& name)
{
    return !name.empty() && std::islower(static_cast<unsigned char>(name[0])) &&
           std::all_of(name.begin(), name.end(), [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

/// What is wrong with a parameter's definition, or "".
std::string fault_of(const Parameter& p)
{
    if (!snake_case(p.name)) return "its name is not snake_case";
    if (p.doc.empty()) return "it is not documented";
    const bool has_default = !std::holds_alternative<std::monostate>(p.fallback);
    if (p.required && has_default) return "it is required and has a default";
    if (p.minimum > p.maximum || p.min_count > p.max_count) return "its range is empty";
    if (p.type == ParameterType::choice && p.choices.empty()) return "it has no choices";
    if (p.type == ParameterType::tables && (p.items.empty() || (p.items.size() > 1 && p.discriminator.empty()))) return "its tables have no schema";
    const auto numbers = [&]() -> std::vector<double> {
        if (const auto* x = std::get_if<double>(&p.fallback)) return {*x};
        if (const auto* i = std::get_if<std::int64_t>(&p.fallback)) return {static_cast<double>(*i)};
        if (const auto* v = std::get_if<std::vector<double>>(&p.fallback)) return *v;
        if (const auto* c = std::get_if<ColorValue>(&p.fallback)) return {c->rgb.x, c->rgb.y, c->rgb.z};
        return {};
    }();
    for (const double x : numbers)
        if (!(x >= p.minimum && x <= p.maximum) || (p.above_minimum && x == p.minimum)) return "its default is out of its range";
    if (const auto* s = std::get_if<std::string>(&p.fallback);
        s && !p.choices.empty() && std::find(p.choices.begin(), p.choices.end(), *s) == p.choices.end())
        return "its default is none of its choices";

    // The getter of its type must be able to read the default.
    using T = ParameterType;
    std::vector<Problem> problems;
    Schema one{"one", "", {p}};
    one.parameters[0].required = false;
    const Values values = check(one, Node{}, problems);
    if (!has_default) return {};
    try {
        if (p.type == T::boolean)
            values.boolean(p.name);
        else if (p.type == T::integer)
            values.integer(p.name);
        else if (p.type == T::number || p.type == T::length || p.type == T::angle || p.type == T::duration)
            values.number(p.name);
        else if (p.type == T::text || p.type == T::choice || p.type == T::path)
            values.text(p.name);
        else if (p.type == T::vector)
            values.vector(p.name);
        else if (p.type == T::points)
            values.points(p.name);
        else if (p.type == T::color)
            values.color(p.name);
        else if (p.type == T::names)
            values.names(p.name);
        else
            values.tables(p.name);
    } catch (const Error&) {
        return "its default has another type";
    }
    return {};
}

void expect_sound(const Schema& schema, const std::string& title)
{
    EXPECT_FALSE(schema.doc.empty()) << title;
    std::set<std::string> names;
    for (const Parameter& p : schema.parameters) {
        EXPECT_EQ(fault_of(p), "") << title << "." << p.name;
        EXPECT_TRUE(names.insert(p.name).second) << title << " has two parameters " << p.name;
        EXPECT_NE(p.name, "type") << title;
        for (const Schema& item : p.items) expect_sound(item, title + "." + p.name + "." + item.name);
    }
}

}  // namespace

TEST(Sections, every_parameter_of_every_schema_is_sound)
{
    for (const Section& section : scene_sections())
        for (std::size_t i = 0; i < section.schemas.size(); ++i)
            expect_sound(*section.schemas[i], section.types.empty() ? section.name : section.name + "." + section.types[i]);
}

TEST(Sections, the_check_of_a_parameter_finds_each_fault)
{
    using T = ParameterType;
    const std::vector<Parameter> mutants{
        {.name = "Width", .doc = "A."},
        {.name = "width"},
        {.name = "width", .doc = "A.", .fallback = 1.0, .required = true},
        {.name = "width", .doc = "A.", .minimum = 2, .maximum = 1},
        {.name = "width", .doc = "A.", .fallback = 3.0, .maximum = 2},
        {.name = "width", .doc = "A.", .fallback = 0.0, .minimum = 0, .above_minimum = true},
        {.name = "width", .type = T::choice, .doc = "A."},
        {.name = "width", .type = T::choice, .doc = "A.", .fallback = std::string("c"), .choices = {"a", "b"}},
        {.name = "width", .type = T::integer, .doc = "A.", .fallback = 3.0},
        {.name = "width", .type = T::text, .doc = "A.", .fallback = true},
        {.name = "width", .type = T::tables, .doc = "A."},
    };
    for (const Parameter& mutant : mutants) EXPECT_NE(fault_of(mutant), "");
    EXPECT_EQ(fault_of({.name = "width", .doc = "A.", .fallback = 1.0, .minimum = 0, .maximum = 2}), "");
}

TEST(Sections, the_limits_of_a_picture_hold_before_anything_is_allocated)
{
    EXPECT_EQ(too_large(16384, 16384, 1), "");
    EXPECT_NE(too_large(16384, 16385, 1), "");
    EXPECT_EQ(too_large(65536, 65536, 1),
              "65536 x 65536 pixels are too many (at least 429 GB), expected at most 268435456");  // 2^32 pixels of 100 bytes
    EXPECT_EQ(too_large(1, 1, max_samples), "");
    EXPECT_NE(too_large(1, 1, max_samples + 1), "");
}

TEST(Sections, the_schema_for_editors_holds_every_parameter)
{
    const auto schema = nlohmann::json::parse(scene_json_schema());
    for (const Section& section : scene_sections()) {
        const auto& top = schema.at("properties").at(section.name);
        for (std::size_t i = 0; i < section.schemas.size(); ++i) {
            auto table = section.named ? top.at("additionalProperties") : top;
            if (table.contains("oneOf")) table = table.at("oneOf").at(i);
            for (const Parameter& p : section.schemas[i]->parameters) {
                EXPECT_TRUE(table.at("properties").contains(p.name)) << section.name << "." << p.name;
                EXPECT_EQ(table.at("properties").contains(p.name + "_deg"), p.type == ParameterType::angle) << section.name << "." << p.name;
            }
        }
    }
}
