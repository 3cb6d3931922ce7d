// From a described terrain to the catalogue row that makes it: the one place where names of terrains and of types meet what they name.
#include "renderer/scene/terrain.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

const CatalogueEntry& terrain_row(const DescribedNode& node)
{
    if (const CatalogueEntry* entry = find_in_catalogue(node.type)) return *entry;
    std::vector<std::string> names;
    for (const CatalogueEntry& entry : catalogue()) names.push_back(entry.name);
    throw Error(ErrorKind::scene, Problem{node.where, "unknown terrain type", {}, "\"" + node.type + "\"", nearest_name(node.type, names)});
}

BuildContext terrain_context(const DescribedNode& node, const Description& description, int threads,
                             const std::function<void(double, const std::string&)>& progress)
{
    BuildContext context;
    context.name = node.name;
    context.seed = node.seed;
    context.threads = threads;
    if (description.resolve) context.resolve = description.resolve;
    if (progress)
        context.progress = [progress, name = node.name](double fraction, const std::string& what) { progress(fraction, name + ": " + what); };
    return context;
}

const DescribedNode& choose_terrain(const Description& description, const std::string& name)
{
    const std::vector<DescribedNode>& all = description.terrains;
    if (name.empty() && all.size() == 1) return all.front();
    const auto found = std::find_if(all.begin(), all.end(), [&](const DescribedNode& node) { return node.name == name; });
    if (found != all.end()) return *found;
    std::vector<std::string> names;
    for (const DescribedNode& node : all) names.push_back(node.name);
    if (all.empty()) throw Error(ErrorKind::scene, fmt::format("{}: the scene has no terrain", description.file));
    const std::string what = name.empty() ? fmt::format("{}: the scene has {} terrains: say which", description.file, all.size())
                                          : fmt::format("{}: there is no terrain \"{}\"", description.file, name);
    throw Error(ErrorKind::scene, Problem{{}, what, fmt::format("one of {}", fmt::join(names, ", ")), {}, nearest_name(name, names)});
}

}  // namespace hoodoo
