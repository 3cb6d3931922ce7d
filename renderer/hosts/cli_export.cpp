// Commands that write a terrain for other programs, or for another scene.
#include "renderer/hosts/cli.h"

#include "renderer/scene/read.h"
#include "renderer/scene/terrain.h"
#include "terrain/io/stack_file.h"

#include <fmt/format.h>

#include <cstdio>

namespace hoodoo::cli
{

int run_bake(const ExportArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const Description description = read_scene(arguments.scene.scene, false, arguments.scene.overrides);
    const DescribedNode& node = choose_terrain(description, arguments.terrain);
    const CatalogueEntry& row = terrain_row(node);
    if (!row.stack)
        throw Error(ErrorKind::scene,
                    Problem{node.where, "a terrain without layers cannot be baked", "type = \"convolution\"", "\"" + node.type + "\"", {}});
    const auto tell = [&](double fraction, const std::string& what) { progress.update(fraction, what); };
    tell(0.0, node.name);
    const auto stack = row.stack(node.values, terrain_context(node, description, arguments.scene.threads, tell));
    write_stack_file(arguments.output, *stack);
    progress.finish();
    if (!arguments.scene.quiet)
        fmt::print(stderr, "wrote {}: {} x {} columns of {:.6g} m, {} layers in steps of {:.6g} m\n", arguments.output, stack->size().x,
                   stack->size().y, stack->cell(), stack->layer_count(), stack->unit());
    return 0;
}

}  // namespace hoodoo::cli
