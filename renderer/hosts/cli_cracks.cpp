// The pictures behind a cracked ground (Li2023): the crack map, the heights h', the diagram. They are read off the surface that is traced.
#include "renderer/hosts/cli.h"

#include "terrain/io/crack_maps.h"
#include "renderer/scene/terrain.h"
#include "renderer/survey.h"
#include "terrain/surfaces/cracked.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace hoodoo::cli
{

int run_bake_cracks(const ExportArguments& arguments)
{
    for (const std::string& path : {arguments.crack_map, arguments.height, arguments.diagram})
        if (!path.empty()) check_output(path);
    Progress progress(arguments.scene.quiet);
    const LoadedScene loaded = load(arguments.scene, progress);
    const DescribedNode& node = choose_terrain(loaded.description, arguments.terrain);
    const auto* surface = dynamic_cast<const CrackedSurface*>(survey(loaded, arguments.terrain).surface);
    if (!surface)
        throw Error(ErrorKind::scene,
                    Problem{node.where, "a terrain without cracks has no crack map", "type = \"cracked\"", '"' + node.type + '"', {}});
    const CrackedField& field = surface->cracks();
    const Vec2d size = field.region().size();
    const double cell = arguments.cell > 0.0 ? arguments.cell : std::max(size.x, size.y) / 1024.0;
    std::vector<std::string> said;
    if (!arguments.crack_map.empty()) {
        const HeightImage map = crack_map(field, cell);
        write_height_image(arguments.crack_map, map);
        const auto torn = std::count(map.values.begin(), map.values.end(), 1.0f);
        said.push_back(fmt::format("wrote {}: {} x {} pixels of {:.6g} m, {:.4g} % in cracks", arguments.crack_map, map.width, map.height, cell,
                                   100.0 * static_cast<double>(torn) / static_cast<double>(map.values.size())));
    }
    if (!arguments.height.empty()) {
        const HeightImage heights = cracked_heights(field, cell);
        write_height_image(arguments.height, heights);
        said.push_back(fmt::format("wrote {}: {} x {} heights of {:.6g} m; h = 0 at {:.6g} m, h = 1 at {:.6g} m", arguments.height, heights.width,
                                   heights.height, cell, field.zero(), field.one()));
    }
    if (!arguments.diagram.empty()) {
        crack_diagram(field).write(arguments.diagram);
        said.push_back(
            fmt::format("wrote {}: {} sites, width {:.6g} m", arguments.diagram, field.network().diagram().sites().size(), field.network().width()));
    }
    progress.finish();
    if (!arguments.scene.quiet)
        for (const std::string& line : said) fmt::print(stderr, "{}\n", line);
    return 0;
}

}  // namespace hoodoo::cli
