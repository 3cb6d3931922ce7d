// Scene text -> Description. The order: files and includes, --set, parameters and expressions, then every section against its schema.
// What is wrong is collected and thrown at once, in the order of the file; only a text that cannot be parsed ends the search early.
// The hash is over the merged data with keys sorted and numbers as they compare, so that comments, order and the place of a file do not matter.
#include "renderer/scene/read.h"

#include "renderer/scene/load.h"
#include "renderer/scene/parameters.h"
#include "renderer/scene/sections.h"
#include "terrain/math/hash.h"
#include "terrain/schema_values.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace hoodoo
{
namespace
{

// -- The hash -----------------------------------------------------------------------------------------------------------

/// A canonical text of the data: a letter for the kind, then the size, then the content.
void serialise(const Node& node, std::string& out)
{
    const auto bits = [&](double x) {
        std::uint64_t u = 0;
        std::memcpy(&u, &x, sizeof u);
        out += fmt::format("n{:016x}", u);
    };
    if (const auto* b = std::get_if<bool>(&node.value))
        out += *b ? "b1" : "b0";
    else if (const auto* i = std::get_if<std::int64_t>(&node.value)) {
        const bool exact = *i >= -(1ll << 53) && *i <= (1ll << 53);
        if (exact)
            bits(static_cast<double>(*i));
        else
            out += fmt::format("i{}", *i);
    } else if (const auto* x = std::get_if<double>(&node.value))
        bits(*x == 0.0 ? 0.0 : *x);
    else if (const auto* s = std::get_if<std::string>(&node.value))
        out += fmt::format("s{}:{}", s->size(), *s);
    else if (const auto* items = std::get_if<Node::Array>(&node.value)) {
        out += fmt::format("a{}:", items->size());
        for (const Node& item : *items) serialise(item, out);
    } else if (const auto* table = std::get_if<Node::Table>(&node.value)) {
        std::vector<const std::pair<std::string, Node>*> entries;
        for (const auto& entry : *table) entries.push_back(&entry);
        std::sort(entries.begin(), entries.end(), [](const auto* a, const auto* b) { return a->first < b->first; });
        out += fmt::format("t{}:", entries.size());
        for (const auto* entry : entries) {
            out += fmt::format("k{}:{}", entry->first.size(), entry->first);
            serialise(entry->second, out);
        }
    }
}

}  // namespace

std::uint64_t hash_of(const Node& root, std::uint64_t seed)
{
    std::string canonical = fmt::format("seed{}:", seed);
    serialise(root, canonical);
    return XXH64(canonical.data(), canonical.size(), 0);
}

namespace
{

// -- The sections -------------------------------------------------------------------------------------------------------

/// Takes a key out of a table.
std::optional<Node> take(Node& node, const std::string& key)
{
    auto* table = std::get_if<Node::Table>(&node.value);
    if (!table) return std::nullopt;
    const auto found = std::find_if(table->begin(), table->end(), [&](const auto& entry) { return entry.first == key; });
    if (found == table->end()) return std::nullopt;
    Node out = std::move(found->second);
    table->erase(found);
    return out;
}

std::optional<bool> take_visible(Node& node, std::vector<Problem>& problems)
{
    const auto taken = take(node, "visible");
    if (!taken) return std::nullopt;
    const Parameter visible{.name = "visible", .type = ParameterType::boolean, .doc = {}};
    return ValueReader(visible, *taken, problems).boolean();
}

std::optional<std::uint64_t> take_seed(Node& node, std::vector<Problem>& problems)
{
    const auto taken = take(node, "seed");
    if (!taken) return std::nullopt;
    const Parameter seed{.name = "seed", .type = ParameterType::integer, .doc = {}, .minimum = 0};
    const auto value = ValueReader(seed, *taken, problems).integer();
    return value ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

bool plain_name(const std::string& name)
{
    return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
}

/// Turns the merged tree into a Description, section by section.
class SceneChecker
{
public:
    SceneChecker(Description& scene, std::vector<Problem>& problems) : scene_(scene), problems_(problems) {}

    void check_all(Node root)
    {
        for (const Section& section : scene_sections()) {
            const auto node = take(root, section.name);
            if (section.named)
                check_named(section, node);
            else
                values_of(section.name) = check(*section.schemas.front(), node ? *node : nothing(), problems_);
        }
        const auto* rest = std::get_if<Node::Table>(&root.value);
        for (const auto& [key, node] : *rest)
            problems_.push_back({node.key_where,
                                 fmt::format("unknown key \"{}\" in the scene", key),
                                 {},
                                 {},
                                 problems_.size() < 100 ? nearest_name(key, known()) : ""});
        check_sizes();
    }

private:
    Node nothing() const
    {
        Node node;
        node.where = {scene_.file, 1, 1, {}};
        return node;
    }

    Values& values_of(const std::string& section)
    {
        return section == "camera" ? scene_.camera : section == "film" ? scene_.film : section == "haze" ? scene_.haze : scene_.render;
    }

    std::vector<DescribedNode>& nodes_of(const std::string& section)
    {
        if (section == "medium") return scene_.media;
        return section == "terrain" ? scene_.terrains : section == "material" ? scene_.materials : scene_.lights;
    }

    static std::vector<std::string> known()
    {
        std::vector<std::string> names{"version", "seed", "include", "params"};
        for (const Section& section : scene_sections()) names.push_back(section.name);
        return names;
    }

    void check_named(const Section& section, const std::optional<Node>& nodes)
    {
        if (!nodes) return;
        const auto* table = std::get_if<Node::Table>(&nodes->value);
        if (!table) {
            problems_.push_back(
                {nodes->where, section.name + " has the wrong type", fmt::format("named tables [{}.NAME]", section.name), quoted_value(*nodes), {}});
            return;
        }
        for (const auto& [name, node] : *table) check_node(section, name, node);
    }

    void check_node(const Section& section, const std::string& name, Node node)
    {
        if (!std::holds_alternative<Node::Table>(node.value)) {
            problems_.push_back({node.where,
                                 fmt::format("{}.{} has the wrong type", section.name, name),
                                 fmt::format("a table [{}.NAME]", section.name),
                                 quoted_value(node),
                                 {}});
            return;
        }
        if (!plain_name(name))
            problems_.push_back({node.key_where,
                                 fmt::format("\"{}\" cannot be the name of a {}", name, section.name),
                                 "letters, digits, _ and -, at most 64",
                                 {},
                                 {}});
        DescribedNode described{name, {}, {}, hash_name(scene_.seed, name), node.where, {}};
        const Schema* schema = choose(section, name, node, described.type);
        if (!schema) return;
        const auto own_seed = std::any_of(schema->parameters.begin(), schema->parameters.end(), [](const Parameter& p) { return p.name == "seed"; });
        if (!own_seed)
            if (const auto seed = take_seed(node, problems_)) described.seed = *seed;
        if (section.name == "terrain") described.visible = take_visible(node, problems_);
        Schema titled = *schema;
        titled.name = section.name + "." + name;  // an error names the table, not its type
        described.values = check(titled, node, problems_);
        nodes_of(section.name).push_back(std::move(described));
    }

    const Schema* choose(const Section& section, const std::string& name, Node& node, std::string& type)
    {
        if (section.types.empty()) return section.schemas.front();
        const Parameter types{.name = "type", .type = ParameterType::choice, .doc = {}, .choices = section.types};
        const auto taken = take(node, "type");
        if (!taken) {
            problems_.push_back({node.where, fmt::format("{}.{} lacks the key \"type\"", section.name, name), expected_text(types), {}, {}});
            return nullptr;
        }
        const auto chosen = ValueReader(types, *taken, problems_).text();
        if (!chosen) return nullptr;
        type = *chosen;
        return section.schemas[static_cast<std::size_t>(std::find(section.types.begin(), section.types.end(), type) - section.types.begin())];
    }

    /// Products of values that are fine each.
    void check_sizes()
    {
        const Values &film = scene_.film, &render = scene_.render;
        if (film.has("width") && film.has("height"))
            if (const auto what = too_large(film.integer("width"), film.integer("height"), 1); !what.empty())
                problems_.push_back({film.where("width"), what, {}, {}, {}});
        if (render.has("spp") && render.has("replicates"))
            if (render.integer("replicates") > render.integer("spp"))
                problems_.push_back({render.where("replicates"),
                                     "there are more replicates than samples",
                                     fmt::format("at most spp = {}", render.integer("spp")),
                                     std::to_string(render.integer("replicates")),
                                     {}});
    }

    Description& scene_;
    std::vector<Problem>& problems_;
};

void check_version(Node& root, const std::string& file, std::vector<Problem>& problems)
{
    const auto version = take(root, "version");
    const auto* number = version ? std::get_if<std::int64_t>(&version->value) : nullptr;
    if (number && *number == 1) return;
    const Source where = version ? version->where : Source{file, 1, 1, {}};
    problems.push_back({where,
                        version ? "this version of the format is unknown" : "the scene lacks the key \"version\"",
                        "version = 1",
                        version ? quoted_value(*version) : std::string(),
                        {}});
}

[[noreturn]] void throw_all(ErrorKind kind, std::vector<Problem> problems)
{
    std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
        return std::tie(a.where.file, a.where.line, a.where.column) < std::tie(b.where.file, b.where.line, b.where.column);
    });
    throw Error(kind, std::move(problems));
}

}  // namespace

Description read_scene(const std::string& path_or_text, bool is_text, const SceneOverrides& overrides)
{
    std::vector<Problem> problems;
    SceneBudget budget;
    SceneFiles files(overrides.allowed_roots);

    // Read the files. Nothing can be said of the sections while one of them is missing.
    SceneLoader loader(files, budget, problems);
    Node root = is_text ? loader.load_text(path_or_text) : loader.load_file(path_or_text);
    const ErrorKind kind = loader.only_files_missing() ? ErrorKind::file : ErrorKind::scene;
    if (!problems.empty()) throw_all(kind, std::move(problems));

    // Put in what the command line and the parameters say.
    apply_sets(root, overrides, problems);
    SceneParameters parameters(budget, problems);
    parameters.apply(root, overrides);

    // Check it.
    Description scene;
    scene.file = is_text ? "<text>" : path_or_text;
    check_version(root, scene.file, problems);
    const auto seed = take_seed(root, problems);
    scene.seed = overrides.seed.value_or(seed.value_or(0));
    scene.frame = std::llround(parameters.number("frame"));
    scene.time = parameters.number("t");
    scene.hash = hash_of(root, scene.seed);
    SceneChecker(scene, problems).check_all(std::move(root));
    if (!problems.empty()) throw_all(ErrorKind::scene, std::move(problems));
    scene.resolve = [files = std::move(files)](const std::string& path, const Source& where) { return files.resolve(path, where); };
    return scene;
}

}  // namespace hoodoo
