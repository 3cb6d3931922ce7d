// Commands that write a terrain for other programs, or for another scene.
#include "renderer/hosts/cli.h"

#include "renderer/mesh_export.h"
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

int run_mesh(const ExportArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const auto tell = [&](double fraction, const std::string& what) { progress.update(fraction, what); };
    const SceneArguments& scene = arguments.scene;
    const LoadedScene loaded = load_scene(scene.scene, false, scene.overrides, scene.threads, scene.colorconfig, tell);
    const MeshExportReport report = export_mesh(loaded, arguments.output, {arguments.terrain, arguments.spacing, tell});
    progress.finish();
    fmt::print(
        "{{\"triangles\": {}, \"vertices\": {}, \"spacing\": {:.6g}, \"mean_error\": {:.6g}, \"maximum_error\": {:.6g}, "
        "\"unrefined\": {}, \"far_triangles\": {}, \"without_material\": {}}}\n",
        report.triangles, report.vertices, report.spacing, report.mean_error, report.maximum_error, report.unrefined, report.far_triangles,
        report.without_material);
    if (!scene.quiet) fmt::print(stderr, "wrote {}\n", arguments.output);
    return 0;
}

}  // namespace hoodoo::cli
