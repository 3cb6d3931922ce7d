// Terrain from features: hills, ridges, valleys, rivers and patches of measured ground, each an elevation with a weight, combined in a tree.
// Genevaux2015 for the tree, Guerin2016 for its operators; fields/landform.h has the functions and their bounds,
// height_surface.h the tracing. Rays meet the tree itself: over every piece of a ray it proves a height interval, a slope and, away from creases, a
// curvature, and asks no node for that whose support ends before. Deviation: the papers make a mesh or a grid of heights. Missing: level of detail in
// noise (`elevation` has it); materials by landform.
#include "terrain/fields/landform.h"
#include "terrain/surfaces/height_surface.h"
#include "terrain/surfaces/landform_nodes.h"
#include "terrain/surfaces/landform_schemas.h"
#include "terrain/surfaces/rows.h"

namespace hoodoo
{

namespace
{

Shape make_landforms(const Values& values, const BuildContext& context)
{
    if (context.progress) context.progress(0.0, "landforms");
    LandformPtr root = make_landform_tree(values, context);
    HeightSurfaceSettings settings =
        read_height_surface(values, context.view ? &*context.view : nullptr, Vec2d(0.0), values.number("extent") / 200.0);
    settings.texture = values.number("extent");
    settings.stored_bytes = root->memory_bytes();
    return make_height_surface(std::make_unique<LandformHeight>(std::move(root)), settings);
}

}  // namespace

CatalogueEntry landforms_row()
{
    Schema schema{"landforms", "Hills, ridges, valleys and measured patches with weights, blended, replaced, added and warped in a tree.", {}};
    schema.parameters = {
        {.name = "node",
         .type = ParameterType::tables,
         .doc = "The nodes of the tree, in any order.",
         .required = true,
         .min_count = 1,
         .max_count = 65536,
         .discriminator = "kind",
         .items = landform_node_schemas()},
        {.name = "root", .type = ParameterType::text, .doc = "The node that is the terrain; by default the last one.", .fallback = std::string()},
    };
    for (Parameter& p : height_surface_parameters(10000.0)) schema.parameters.push_back(std::move(p));
    return {"landforms", "Genevaux2015", std::move(schema), make_landforms};
}

}  // namespace hoodoo
