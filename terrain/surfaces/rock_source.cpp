// Rocks as a scene writes them: one tile's worth of parameters, the same names in every row.

#include "terrain/surfaces/rock_source.h"

#include "terrain/math/hash.h"
#include "terrain/rocks/rock_mesh.h"

#include <chrono>

namespace hoodoo
{

std::vector<Parameter> rock_parameters(double size)
{
    Parameter rock_size{.name = "rock_size",
                        .type = ParameterType::length,
                        .doc = "Mean diameter of a rock and the gaps around it.",
                        .unit = "m",
                        .minimum = 0,
                        .above_minimum = true};
    if (size > 0.0)
        rock_size.fallback = size;
    else
        rock_size.doc += " By default two columns.";
    const Parameter shares{.name = "", .type = ParameterType::points, .doc = "", .minimum = 0, .maximum = 1, .min_count = 1, .max_count = 4096};
    Parameter sites = shares, contacts = shares;
    sites.name = "rock_sites";
    sites.doc = "Seed points of the tile instead of random ones, as shares of its edge.";
    contacts.name = "rock_contact_points";
    contacts.doc = "Where rocks touch, instead of random points: shares of the tile's edge, each on a face between two cells.";
    return {
        rock_size,
        {.name = "rocks_per_tile",
         .type = ParameterType::integer,
         .doc = "Different rocks of the tile that is repeated; by default 50, or 150 in corner cubes.",
         .minimum = 1,
         .maximum = 4096},
        {.name = "rock_radius",
         .type = ParameterType::length,
         .doc = "Half the least distance of two seed points; by default 0.93 of what random placing reaches.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "rock_contacts",
         .type = ParameterType::integer,
         .doc = "About how many neighbours a rock touches.",
         .fallback = std::int64_t(6),
         .minimum = 3,
         .maximum = 14},
        {.name = "rock_roundness", .type = ParameterType::number, .doc = "0 freshly broken, 1 pebbles.", .fallback = 0.3, .minimum = 0, .maximum = 1},
        {.name = "rock_roughness",
         .type = ParameterType::number,
         .doc = "Amplitude of the detail of a rock's surface, as a share of rock_radius.",
         .fallback = 0.08,
         .minimum = 0,
         .maximum = 0.1},
        {.name = "rock_shape",
         .type = ParameterType::vector,
         .doc = "Lengths of a mean rock along x, y, z relative to each other: flat slabs, long blocks.",
         .fallback = std::vector<double>{1, 1, 1},
         .minimum = 0.25,
         .maximum = 4,
         .min_count = 3,
         .max_count = 3},
        {.name = "rock_tiling",
         .type = ParameterType::choice,
         .doc = "One tile repeated, or 256 tiles that never repeat (slower to build, several times the memory).",
         .fallback = std::string("periodic"),
         .choices = {"periodic", "corner_cubes"}},
        {.name = "rock_detail",
         .type = ParameterType::integer,
         .doc = "Finest level of detail of the meshes: 0 = 8000 triangles a rock, 1 = 2880, 2 = 720, 3 = 180.",
         .fallback = std::int64_t(0),
         .minimum = 0,
         .maximum = kRockLevels - 1},
        {.name = "rock_far_detail",
         .type = ParameterType::choice,
         .doc = "Rocks far from the camera: as coarse as no eye can tell, or as fine as near ones.",
         .fallback = std::string("by_distance"),
         .choices = {"by_distance", "full"}},
        sites,
        contacts,
    };
}

RockOptions rock_options(const Values& values, const BuildContext& context, double cell)
{
    RockOptions options;
    options.size = values.has("rock_size") ? values.number("rock_size") : 2.0 * cell;
    if (values.has("rocks_per_tile")) options.per_tile = static_cast<int>(values.integer("rocks_per_tile"));
    if (values.has("rock_radius")) options.radius = values.number("rock_radius");
    options.contacts = static_cast<int>(values.integer("rock_contacts"));
    options.roundness = values.number("rock_roundness");
    options.roughness = values.number("rock_roughness");
    options.shape = values.vec3("rock_shape");
    options.corner_cubes = values.text("rock_tiling") == "corner_cubes";
    options.level = static_cast<int>(values.integer("rock_detail"));
    if (context.view && values.text("rock_far_detail") == "by_distance") options.view = RockView{context.view->eye, context.view->spread};
    options.seed = hash_name(context.seed, "rocks");
    options.sites = values.points("rock_sites");
    options.contact_points = values.points("rock_contact_points");
    options.where = values.where(values.has("rock_radius") ? "rock_radius" : "rocks_per_tile");
    if (!options.sites.empty() && options.corner_cubes)
        throw values.problem("rock_sites", "seed points are given for corner cubes", "rock_tiling = \"periodic\"");
    if (!options.contact_points.empty() && options.sites.empty())
        throw values.problem("rock_contact_points", "contacts are given for random seed points", "rock_sites as well");
    return options;
}

LyingRocks::LyingRocks(std::shared_ptr<const MaterialStack> stack, Border border, const Values& values, const BuildContext& context)
    : stack_(std::move(stack))
{
    const auto start = std::chrono::steady_clock::now();
    volume_ = std::make_shared<StackRocks>(stack_, border);
    if (volume_->bounds().isEmpty() && !context.editable) return;
    if (context.progress) context.progress(0.6, "rocks");
    const double looking = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    placement_ = std::make_unique<RockPlacement>(rock_options(values, context, stack_->cell()), volume_, stack_->origin());
    rocks = placement_->place();
    rocks.rocks.instancing_seconds += looking;
    if (!context.editable) placement_.reset();
}

InstanceChange LyingRocks::follow(const ColumnSet& changed)
{
    if (!placement_ || changed.empty()) return InstanceChange::none;
    volume_->follow(changed);
    // Runs of columns along x.
    std::vector<Rectangle> parts;
    const Vec2d origin(stack_->origin().x, stack_->origin().y);
    const double cell = stack_->cell();
    for (std::size_t k = 0; k < changed.count();) {
        const Vec2i first = changed.column(changed.indices()[k]);
        int end = first.x;
        for (; k < changed.count() && changed.column(changed.indices()[k]) == Vec2i(end, first.y); ++k) ++end;
        parts.push_back({origin + Vec2d(first.x * cell, first.y * cell), origin + Vec2d(end * cell, (first.y + 1) * cell)});
    }
    return placement_->follow(parts, rocks);
}

}  // namespace hoodoo
