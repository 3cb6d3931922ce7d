// [params] and what refers to them. A parameter may use those above it, so that there is no cycle to find. Insertions count against the scene's
// budget: a list of lists of lists that doubles each time is refused long before it fills the memory. An integral result of an expression is an
// integer, so that "= 2 * n" may be a count. Missing: insertion into the middle of a text.
#include "renderer/scene/parameters.h"

#include "terrain/schema_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hoodoo
{
namespace
{

Node* child(Node& node, const std::string& key)
{
    if (auto* table = std::get_if<Node::Table>(&node.value)) {
        for (auto& entry : *table)
            if (entry.first == key) return &entry.second;
    } else if (auto* items = std::get_if<Node::Array>(&node.value)) {
        std::size_t index = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
        if (error == std::errc() && end == key.data() + key.size() && index < items->size()) return &(*items)[index];
    }
    return nullptr;
}

std::vector<std::string> keys(const Node& node)
{
    std::vector<std::string> out;
    if (const auto* table = std::get_if<Node::Table>(&node.value))
        for (const auto& entry : *table) out.push_back(entry.first);
    return out;
}

bool is_section(const std::string& key)
{
    return key == "camera" || key == "film" || key == "render" || key == "params";
}

void set_one(Node& root, const std::string& path, const std::string& value, std::vector<Problem>& problems)
{
    const std::string argument = path + "=" + value;
    const auto column = [](std::size_t offset) { return static_cast<int>(offset) + 1; };
    Node* node = &root;
    std::size_t begin = 0;
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
        const std::string key = path.substr(begin, dot - begin);
        Node* next = child(*node, key);
        auto* table = std::get_if<Node::Table>(&node->value);
        if (!next && node == &root && table && is_section(key)) next = &table->emplace_back(key, Node{}).second;
        if (!next) {
            problems.push_back(
                {{"--set", 1, column(begin), argument}, fmt::format("the scene has no \"{}\" here", key), {}, {}, nearest_name(key, keys(*node))});
            return;
        }
        node = next;
        begin = dot + 1;
    }
    const std::string key = path.substr(begin);
    Node parsed = parse_toml_value(value, {"--set", 1, column(path.size() + 1), argument});
    parsed.key_where.column = column(begin);
    auto* table = std::get_if<Node::Table>(&node->value);
    if (Node* old = child(*node, key))
        *old = std::move(parsed);
    else if (table && !key.empty())
        table->emplace_back(key, std::move(parsed));
    else
        problems.push_back({{"--set", 1, column(begin), argument}, "there is nothing to set here", "path.to.key=value", {}, {}});
}

Node number_node(double value, const Node& like)
{
    Node out;
    out.where = like.where;
    out.key_where = like.key_where;
    if (std::trunc(value) == value && std::abs(value) <= 0x1p53)
        out.value = static_cast<std::int64_t>(value);
    else
        out.value = value;
    return out;
}

/// What an insertion costs: values and bytes of texts.
void measure(const Node& node, std::size_t& bytes, std::size_t& nodes)
{
    ++nodes;
    if (const auto* s = std::get_if<std::string>(&node.value)) bytes += s->size();
    if (const auto* items = std::get_if<Node::Array>(&node.value))
        for (const Node& item : *items) measure(item, bytes, nodes);
    if (const auto* table = std::get_if<Node::Table>(&node.value))
        for (const auto& entry : *table) measure(entry.second, bytes, nodes);
}

int depth_of(const Node& node)
{
    int deepest = 0;
    if (const auto* items = std::get_if<Node::Array>(&node.value))
        for (const Node& item : *items) deepest = std::max(deepest, 1 + depth_of(item));
    if (const auto* table = std::get_if<Node::Table>(&node.value))
        for (const auto& entry : *table) deepest = std::max(deepest, 1 + depth_of(entry.second));
    return deepest;
}

}  // namespace

void apply_sets(Node& root, const SceneOverrides& overrides, std::vector<Problem>& problems)
{
    for (const auto& [path, value] : overrides.sets) set_one(root, path, value, problems);
}

void SceneParameters::apply(Node& root, const SceneOverrides& overrides)
{
    auto* table = std::get_if<Node::Table>(&root.value);
    if (!table) return;
    Node params;
    if (const auto found = std::find_if(table->begin(), table->end(), [](const auto& e) { return e.first == "params"; }); found != table->end()) {
        params = std::move(found->second);
        table->erase(found);
    }
    auto* entries = std::get_if<Node::Table>(&params.value);
    if (!entries) {
        problems_.push_back({params.where, "params has the wrong type", "a table", quoted_value(params), {}});
        return;
    }

    // The command line replaces defaults; it invents nothing but the two names that are always known.
    const bool own_time = params.find("t") != nullptr;
    for (const char* name : {"t", "frame"})
        if (!params.find(name)) entries->insert(entries->begin(), {name, number_node(0.0, Node{})});
    if (overrides.frame) *child(params, "frame") = number_node(static_cast<double>(*overrides.frame), Node{});
    for (const auto& [name, value] : overrides.params) {
        const std::string argument = name + "=" + value;
        Node given = parse_toml_value(value, {"-D", 1, static_cast<int>(name.size()) + 2, argument});
        if (Node* old = child(params, name))
            *old = std::move(given);
        else
            problems_.push_back(
                {{"-D", 1, 1, argument}, fmt::format("the scene has no parameter \"{}\"", name), {}, {}, nearest_name(name, keys(params))});
    }
    const bool given = std::any_of(overrides.params.begin(), overrides.params.end(), [](const auto& p) { return p.first == "t"; });
    if (!own_time && !given) derive_time(params, root);
    for (auto& [name, node] : *entries) define(name, std::move(node));
    substitute(root, 0);
}

void SceneParameters::derive_time(Node& params, const Node& root)
{
    const auto value = [](const Node* node) -> std::optional<double> {
        if (node)
            if (const auto* i = std::get_if<std::int64_t>(&node->value)) return static_cast<double>(*i);
        if (node)
            if (const auto* x = std::get_if<double>(&node->value)) return *x;
        return std::nullopt;
    };
    const Node *film = root.find("film"), *written = film ? film->find("fps") : nullptr;
    if (written && std::holds_alternative<std::string>(written->value)) {
        problems_.push_back({written->where, "film.fps cannot be computed", "a plain number: the parameter t follows from it", {}, {}});
        return;
    }
    const double fps = value(written).value_or(24.0);
    const std::optional<double> frame = value(params.find("frame"));
    if (frame && fps > 0.0) *child(params, "t") = number_node(*frame / fps, Node{});
}

double SceneParameters::number(const std::string& name) const
{
    const auto found = values_.find(name);
    if (found == values_.end()) return 0.0;
    if (const auto* i = std::get_if<std::int64_t>(&found->second.value)) return static_cast<double>(*i);
    const auto* x = std::get_if<double>(&found->second.value);
    return x ? *x : 0.0;
}

void SceneParameters::define(const std::string& name, Node node)
{
    if (!Expressions::valid_name(name)) {
        problems_.push_back(
            {node.key_where, fmt::format("\"{}\" cannot be the name of a parameter", name), "letters, digits and _, no function's name", {}, {}});
        return;
    }
    substitute(node, 1);
    if (const auto* i = std::get_if<std::int64_t>(&node.value)) expressions_.define(name, static_cast<double>(*i));
    if (const auto* x = std::get_if<double>(&node.value)) expressions_.define(name, *x);
    values_[name] = std::move(node);
}

std::string SceneParameters::nearest(const std::string& name) const
{
    // Of the first problems only: the search costs as much as there are parameters.
    if (name.empty() || problems_.size() >= 100) return {};
    std::vector<std::string> names;
    for (const auto& entry : values_) names.push_back(entry.first);
    return nearest_name(name, names);
}

void SceneParameters::substitute(Node& node, int depth)
{
    if (auto* items = std::get_if<Node::Array>(&node.value))
        for (Node& item : *items) substitute(item, depth + 1);
    else if (auto* table = std::get_if<Node::Table>(&node.value))
        for (auto& entry : *table) substitute(entry.second, depth + 1);
    else if (const auto* text = std::get_if<std::string>(&node.value))
        substitute_text(node, std::string(*text), depth);
}

void SceneParameters::compute(Node& node, const std::string& expression)
{
    const auto result = expressions_.evaluate(expression);
    if (result.problem.empty()) {
        node = number_node(result.value, node);
        return;
    }
    node.broken = true;
    const auto named = values_.find(result.token);
    if (named != values_.end() && named->second.broken) return;  // that parameter has its own Problem

    // The caret stands where the expression is wrong: behind the "=" and, in a file, the opening quote.
    Source where = node.where;
    where.column += static_cast<int>(result.position) + (where.file == "-D" || where.file == "--set" ? 1 : 2);
    const bool no_number = named != values_.end();
    problems_.push_back({where,
                         no_number ? "a parameter in an expression is no number" : result.problem,
                         {},
                         result.token.empty() ? std::string() : "\"" + result.token + "\"",
                         no_number ? std::string() : nearest(result.token)});
}

void SceneParameters::substitute_text(Node& node, const std::string& text, int depth)
{
    if (!text.empty() && text[0] == '=') return compute(node, text.substr(1));

    // "${name}": the parameter itself, whatever its type. It keeps its own position: a path in it is relative to the file that wrote it.
    const auto open = text.find("${");
    if (open == std::string::npos) return;
    node.broken = true;  // until it is replaced
    if (open != 0 || text.find('}') != text.size() - 1) {
        problems_.push_back({node.where, "a parameter stands alone in its text", "\"${name}\"", "\"" + text + "\"", {}});
        return;
    }
    const std::string name = text.substr(2, text.size() - 3);
    const auto found = values_.find(name);
    if (found == values_.end()) {
        problems_.push_back({node.where, fmt::format("unknown parameter \"{}\"", name.substr(0, 64)), {}, {}, nearest(name)});
        return;
    }
    std::size_t bytes = 0, nodes = 0;
    measure(found->second, bytes, nodes);
    if (!budget_.take(bytes, nodes) || depth + depth_of(found->second) > max_nesting) {
        problems_.push_back({node.where, "the parameters make the scene too large", "at most 100000 values, 64 MB, 64 levels", {}, {}});
        return;
    }
    const Source key_where = node.key_where;
    node = found->second;
    node.key_where = key_where;
}

}  // namespace hoodoo
