// Mud cracks in what lies on top of a stack: bands along the borders of a Voronoi diagram, sunk into the sand or soil (Li2023, equation 1).
// In a column whose middle lies in a crack the layers of the chosen materials at its top lose the share kappa iota of their thickness: equation 1
// with the thickness for the height, so that nothing cracks where nothing lies, and bedrock is never reached unless kappa is 1. The border line is an
// elevation here, because a stack has no lowest and highest that an edit elsewhere would leave alone. Under water nothing dries.
// Deviations: cracks are as sharp as columns are wide (a width of less than a column leaves gaps); dried mud stands by itself, so this tool lets
// nothing slide. Missing: curled edges.
#include "terrain/edit/crack_parameters.h"
#include "terrain/edit/overwrite.h"
#include "terrain/edit/rows.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

namespace
{

struct Cracking {
    Vec2d low, high;       ///< what is cracked, world
    CrackNetwork network;  ///< counts from `low`
    double kappa;
    MaterialSet materials;
    double border = kInfinity, border_error = 0.0;  ///< metres of elevation

    double iota(double z) const
    {
        if (z <= border) return 1.0;
        return z - border >= border_error ? 0.0 : 1.0 - (z - border) / border_error;
    }
};

Cracking cracking_of(const MaterialStack& stack, const Values& edit, const EditContext& context)
{
    const Vec2d origin(stack.origin().x, stack.origin().y);
    Box2d region(origin, origin + Vec2d(stack.size()) * stack.cell());
    const Box2d grid = region;
    if (edit.has("region_min")) region.min = edit.vec2("region_min");
    if (edit.has("region_max")) region.max = edit.vec2("region_max");
    if (!(region.min.x < region.max.x && region.min.y < region.max.y))
        throw edit.problem("region_max", "the region that is cracked is empty", "region_min below region_max",
                           fmt::format("[{:.6g}, {:.6g}] to [{:.6g}, {:.6g}]", region.min.x, region.min.y, region.max.x, region.max.y));
    if (!grid.intersects(region))
        throw edit.problem("region_min", "the region lies outside of the terrain",
                           fmt::format("[{:.6g}, {:.6g}] to [{:.6g}, {:.6g}]", grid.min.x, grid.min.y, grid.max.x, grid.max.y));
    MaterialSet materials = 0;
    for (const std::string& name : edit.names("materials"))
        materials = static_cast<MaterialSet>(materials | material_set({material_from_name(name)}));
    Cracking cracking{region.min, region.max, crack_network(edit, context.seed, region.size()), edit.number("kappa"), materials};
    if (edit.has("border")) cracking.border = edit.number("border");
    cracking.border_error = edit.number("border_error");
    return cracking;
}

ColumnSet crack(MaterialStack& stack, const Cracking& cracking)
{
    return change_columns(stack, columns_within(stack, cracking.low, cracking.high), [&](int i, int j, std::vector<Layer> layers) {
        const Vec2d middle(stack.origin().x + (i + 0.5) * stack.cell(), stack.origin().y + (j + 0.5) * stack.cell());
        if (layers.empty() || !cracking.network.cracked(middle - cracking.low)) return layers;
        const std::int32_t top = layers.back().top;
        std::size_t k = layers.size();
        while (k > 0 && (cracking.materials >> static_cast<unsigned>(layers[k - 1].material)) & 1u) --k;
        const std::int32_t bottom = k > 0 ? layers[k - 1].top : 0;
        const double share = cracking.kappa * cracking.iota(stack.origin().z + top * stack.unit());
        const auto depth = static_cast<std::int32_t>(std::lround(share * (top - bottom)));
        if (depth == 0) return layers;
        const Run run{top - depth, top};
        return overwrite(layers, std::span(&run, 1), cracking.materials, Material::air);
    });
}

}  // namespace

EditTool crack_tool()
{
    Schema schema{"crack", "Cracks what lies on top, as mud does when it dries.", {}};
    schema.parameters = crack_parameters(SiteKind::even, 0.8, 1.0, "Depth of a crack, share of the thickness of what is cracked.");
    schema.parameters.push_back({.name = "materials",
                                 .type = ParameterType::names,
                                 .doc = "What cracks, where it lies on top.",
                                 .fallback = std::vector<std::string>{"sand", "soil"},
                                 .choices = {"sand", "soil", "rock", "bedrock"},
                                 .min_count = 1});
    schema.parameters.push_back(
        {.name = "border", .type = ParameterType::length, .doc = "Elevation above which cracks vanish; by default nowhere.", .unit = "m"});
    schema.parameters.push_back({.name = "border_error",
                                 .type = ParameterType::length,
                                 .doc = "Over this much above the border they do.",
                                 .fallback = 0.0,
                                 .unit = "m",
                                 .minimum = 0});
    for (Parameter& corner : crack_region_parameters("that is cracked; by default the terrain's.")) schema.parameters.push_back(std::move(corner));
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        return crack(stack, cracking_of(stack, edit, context));
    };
    return {std::move(schema), apply, true};
}

}  // namespace hoodoo
