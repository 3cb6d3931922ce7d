// The parameter schemas as one JSON Schema (draft-07, and of it only what draft-04 tools know too, apart from exclusiveMinimum and const).
// Every value may also be an insertion "${name}", every number an expression "= ...": their results cannot be checked here.
// A file that another one includes may lack what is required; it validates only as part of the whole.
#include "renderer/scene/json_schema.h"

#include "renderer/scene/sections.h"
#include "terrain/schema_values.h"

#include <nlohmann/json.hpp>

namespace hoodoo
{
namespace
{

using Json = nlohmann::ordered_json;

constexpr double kPi = 3.14159265358979323846;
const char* const number_pattern = "^-?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)? *";

Json reference(const char* name)
{
    return {{"$ref", std::string("#/definitions/") + name}};
}

Json text_matching(const std::string& pattern)
{
    return {{"type", "string"}, {"pattern", pattern}};
}

Json bounded(Json schema, const Parameter& p, double scale = 1.0)
{
    if (p.minimum > -kInfinity) schema[p.above_minimum ? "exclusiveMinimum" : "minimum"] = p.minimum * scale;
    if (p.maximum < kInfinity) schema["maximum"] = p.maximum * scale;
    return schema;
}

Json counted(Json items, int min_count, int max_count)
{
    Json out{{"type", "array"}, {"items", std::move(items)}};
    if (min_count > 0) out["minItems"] = min_count;
    if (max_count < (1 << 20)) out["maxItems"] = max_count;
    return out;
}

Json any_of(std::vector<Json> options)
{
    Json list = Json::array();
    for (Json& option : options) list.push_back(std::move(option));
    return {{"anyOf", std::move(list)}};
}

Json bare_number(const Parameter& p)
{
    return bounded({{"type", "number"}}, p);
}

Json quantity(const Parameter& p, const char* units)
{
    return any_of({bare_number(p), text_matching(std::string(number_pattern) + units + "$"), reference("expression"), reference("parameter")});
}

Json number(const Parameter& p)
{
    return any_of({bare_number(p), reference("expression"), reference("parameter")});
}

Json choice(const std::vector<std::string>& choices)
{
    return choices.empty() ? Json{{"type", "string"}} : any_of({{{"type", "string"}, {"enum", choices}}, reference("parameter")});
}

const char* const length_units = "(m|km|cm|mm|um|nm)";

Json color(const Parameter& p)
{
    const Json rgb = any_of({counted(number(p), 3, 3), reference("parameter")});
    const Json table{{"type", "object"},
                     {"minProperties", 1},
                     {"maxProperties", 1},
                     {"additionalProperties", false},
                     {"properties", {{"srgb", rgb}, {"lin_rec709", rgb}, {"acescg", rgb}, {"grey", number(p)}}}};
    return any_of({text_matching("^#[0-9a-fA-F]{6}$"), table, reference("parameter")});
}

Json object_of(const Schema& schema, Json properties);

Json tables(const Parameter& p)
{
    std::vector<Json> items;
    for (const Schema& schema : p.items) {
        Json chosen = Json::object();
        if (!p.discriminator.empty()) chosen[p.discriminator] = {{"const", schema.name}};
        items.push_back(object_of(schema, std::move(chosen)));
    }
    return counted(items.size() == 1 ? items.front() : Json{{"oneOf", items}}, p.min_count, p.max_count);
}

Json value_schema(const Parameter& p)
{
    switch (p.type) {
        case ParameterType::boolean:
            return any_of({{{"type", "boolean"}}, reference("parameter")});
        case ParameterType::integer:
            return any_of({bounded({{"type", "integer"}}, p), reference("expression"), reference("parameter")});
        case ParameterType::number:
            return number(p);
        case ParameterType::length:
            return quantity(p, length_units);
        case ParameterType::duration:
            return quantity(p, "(s|ms|min|h)");
        case ParameterType::angle:
            return any_of({text_matching(std::string(number_pattern) + "(deg|rad)$"), reference("parameter")});
        case ParameterType::text:
            return {{"type", "string"}};
        case ParameterType::path:
            return {{"type", "string"}, {"minLength", 1}};
        case ParameterType::choice:
            return choice(p.choices);
        case ParameterType::vector:
            return any_of({counted(p.unit == "m" ? quantity(p, length_units) : number(p), p.min_count, p.max_count), reference("parameter")});
        case ParameterType::points:
            return any_of({counted(any_of({counted(quantity(p, length_units), 3, 3), reference("parameter")}), p.min_count, p.max_count),
                           reference("parameter")});
        case ParameterType::color:
            return color(p);
        case ParameterType::names:
            return any_of({counted(choice(p.choices), p.min_count, p.max_count), reference("parameter")});
        case ParameterType::tables:
            return tables(p);
    }
    return Json::object();
}

void add_default(Json& schema, const Default& fallback)
{
    std::visit(
        [&](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, ColorValue>)
                schema["default"] = {{value.space, {value.rgb.x, value.rgb.y, value.rgb.z}}};
            else if constexpr (!std::is_same_v<T, std::monostate>)
                schema["default"] = value;
        },
        fallback);
}

/// A table with the parameters of `schema` beside the properties given.
Json object_of(const Schema& schema, Json properties)
{
    Json required = Json::array();
    Json either = Json::array();  // an angle may be given under either of two keys
    for (const auto& [key, value] : properties.items())
        if (value.contains("const")) required.push_back(key);
    for (const Parameter& p : schema.parameters) {
        Json value = value_schema(p);
        value["description"] = p.unit.empty() ? p.doc : p.doc + " [" + p.unit + "]";
        if (p.type == ParameterType::angle) {
            Json degrees = any_of({bounded({{"type", "number"}}, p, 180.0 / kPi), reference("expression"), reference("parameter")});
            degrees["description"] = p.doc + " [degrees]";
            if (const auto* radians = std::get_if<double>(&p.fallback)) degrees["default"] = *radians / kPi * 180.0;
            properties[p.name + "_deg"] = std::move(degrees);
            if (p.required) either.push_back({{"oneOf", {{{"required", {p.name}}}, {{"required", {p.name + "_deg"}}}}}});
        } else {
            add_default(value, p.fallback);
            if (p.required) required.push_back(p.name);
        }
        properties[p.name] = std::move(value);
    }
    Json out{{"type", "object"}, {"description", schema.doc}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    if (!required.empty()) out["required"] = std::move(required);
    if (!either.empty()) out["allOf"] = std::move(either);
    return out;
}

const Json seed_schema{{"type", "integer"}, {"minimum", 0}, {"description", "Replaces the seed that is hashed from the name."}};

Json section_schema(const Section& section)
{
    if (!section.named) return object_of(*section.schemas.front(), Json::object());
    Json kinds = Json::array();
    for (std::size_t i = 0; i < section.schemas.size(); ++i) {
        Json properties{{"seed", seed_schema}};
        if (section.name == "terrain")
            properties["visible"] = {{"type", "boolean"},
                                     {"description", "Whether it is rendered itself; by default unless another terrain stands on it."}};
        if (!section.types.empty()) properties["type"] = {{"const", section.types[i]}};
        kinds.push_back(object_of(*section.schemas[i], std::move(properties)));
    }
    Json node = kinds.size() == 1 ? kinds.front() : Json{{"oneOf", kinds}};
    return {{"type", "object"}, {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]{1,64}$"}}}, {"additionalProperties", std::move(node)}};
}

}  // namespace

std::string scene_json_schema()
{
    Json properties{
        {"version", {{"const", 1}, {"description", "Version of the scene format."}}},
        {"seed",
         {{"type", "integer"}, {"minimum", 0}, {"default", 0}, {"description", "Every random number of the scene follows from it and a name."}}},
        {"include", {{"type", "array"}, {"items", {{"type", "string"}}}, {"description", "Scenes to start from; this file wins over them."}}},
        {"params",
         {{"type", "object"},
          {"propertyNames", {{"pattern", "^[A-Za-z_][A-Za-z0-9_]{0,63}$"}}},
          {"description", "Defaults that -D name=value replaces."}}},
    };
    for (const Section& section : scene_sections()) properties[section.name] = section_schema(section);
    // A camera stands at one place, or moves along keys: what the camera itself checks, for editors.
    Json& camera = properties["camera"];
    if (camera.contains("properties")) camera["anyOf"] = {{{"required", {"eye", "target"}}}, {{"required", {"key"}}}};
    const Json schema{
        {"$schema", "http://json-schema.org/draft-07/schema#"},
        {"title", "Hoodoo scene"},
        {"type", "object"},
        {"required", {"version"}},
        {"additionalProperties", false},
        {"properties", std::move(properties)},
        {"definitions",
         {{"expression", {{"type", "string"}, {"pattern", "^="}, {"maxLength", 1025}, {"description", "= arithmetic with parameters, frame and t"}}},
          {"parameter", {{"type", "string"}, {"pattern", "^\\$\\{[A-Za-z_][A-Za-z0-9_]*\\}$"}, {"description", "${name of a parameter}"}}}}},
    };
    return schema.dump(2) + "\n";
}

}  // namespace hoodoo
