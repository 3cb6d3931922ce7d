// A scene file and what it includes, merged into one tree. Includes are read depth first; a file that is still open above is a cycle.
// A file costs 100 of the budget's nodes beside its own, so that empty files cannot be included without end. At most 16 deep.
#include "renderer/scene/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace hoodoo
{
namespace fs = std::filesystem;
namespace
{

constexpr std::size_t max_include_depth = 16;
constexpr std::size_t nodes_a_file = 100;

/// Tables merge, everything else of `over` replaces what `base` has. New keys keep their order behind the old ones.
void merge(Node& base, Node over)
{
    auto* below = std::get_if<Node::Table>(&base.value);
    auto* above = std::get_if<Node::Table>(&over.value);
    if (!below || !above) {
        base = std::move(over);
        return;
    }
    base.where = over.where;
    base.key_where = over.key_where;
    std::unordered_map<std::string, std::size_t> index;  // a scan for each key would be quadratic in a hostile file
    for (std::size_t i = 0; i < below->size(); ++i) index.emplace((*below)[i].first, i);
    for (auto& [key, node] : *above) {
        if (const auto same = index.find(key); same != index.end())
            merge((*below)[same->second].second, std::move(node));
        else
            below->emplace_back(key, std::move(node));
    }
}

}  // namespace

Node SceneLoader::load_text(const std::string& text)
{
    const fs::path here = fs::current_path();
    files_.set_folder("<text>", here);
    files_.allow(here);
    return parse(text, "<text>");
}

Node SceneLoader::load_file(const std::string& path)
{
    const std::string text = read_regular_file(path, budget_.bytes, {});
    const fs::path folder = fs::canonical(fs::absolute(path).parent_path());
    files_.set_folder(path, folder);
    files_.allow(folder);
    open_.push_back(fs::canonical(path).string());
    return parse(text, path);
}

Node SceneLoader::parse(const std::string& text, const std::string& file)
{
    Node root = parse_toml(text, file, budget_, problems_);
    include(root, file);
    return root;
}

void SceneLoader::include(Node& root, const std::string& file)
{
    auto* table = std::get_if<Node::Table>(&root.value);
    if (!table) return;
    const auto entry = std::find_if(table->begin(), table->end(), [](const auto& e) { return e.first == "include"; });
    if (entry == table->end()) return;
    const Node list = std::move(entry->second);
    table->erase(entry);
    const auto* paths = std::get_if<Node::Array>(&list.value);
    if (!paths) {
        problems_.push_back({list.where, "include has the wrong type", "a list of paths", {}, {}});
        return;
    }
    Node base;
    for (const Node& path : *paths)
        if (const auto* text = std::get_if<std::string>(&path.value))
            merge(base, included(*text, path.where, file));
        else
            problems_.push_back({path.where, "include has the wrong type", "a list of paths", {}, {}});
    merge(base, std::move(root));
    root = std::move(base);
}

Node SceneLoader::included(const std::string& path, const Source& where, const std::string& file)
{
    try {
        const std::string real = files_.resolve(path, where);
        if (std::find(open_.begin(), open_.end(), real) != open_.end())
            throw Error(ErrorKind::scene, Problem{where, fmt::format("\"{}\" includes itself", path), {}, {}, {}});
        if (open_.size() >= max_include_depth || !budget_.take(0, nodes_a_file))
            throw Error(ErrorKind::scene,
                        Problem{where, "too many includes", fmt::format("at most {} deep and about 1000 in all", max_include_depth), {}, {}});
        const std::string text = read_regular_file(real, budget_.bytes, where);

        // Errors name the file as a reader of the scene would: relative to where the scene was named.
        const fs::path above = file == "<text>" ? fs::path() : fs::path(file).parent_path();
        const std::string shown = (above / path).lexically_normal().string();
        files_.set_folder(shown, fs::path(real).parent_path());
        open_.push_back(real);
        Node node = parse(text, shown);
        open_.pop_back();
        return node;
    } catch (const Error& error) {
        problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
        missing_ += error.kind() == ErrorKind::file;
        return {};
    }
}

}  // namespace hoodoo
