// Dry ground: any terrain that is a height, torn along the borders of a Voronoi diagram (Li2023), traced as it is: exact walls, no mesh, no grid.
//
// n sites are drawn in the rectangle `region`, and some around it; the ground within width / 2 of a border between their cells is lowered to
// h' = (1 - kappa iota(h)) h (fields/crack_network.h), where h is the elevation between `zero` (h = 0) and `one` (h = 1). How rays meet it:
// march/cracked_patches.cpp. Units: the paper gives heights in [0, 1] and lambda = 0.1 without saying of what. As a width in the unit square it would
// tear 98 % of the ground with the paper's own n = 200; here the width is lambda times the mean spacing of the sites, sqrt(area / n), which
// tears 18.3 to 18.8 % for n = 100 to 800. Materials follow: `inside` on walls and floors, `above` beyond the border line. Layers as ground are the
// tops of their columns (column_ground.h). Plates may curl (fields/curled_height.h), which the paper's do
// not. Deviations: sites may be even (the paper's are random); the shape ends at the region. Missing: meshes and
// warped terrains as ground; soft edges; level of detail.
#include "terrain/surfaces/cracked.h"

#include "terrain/edit/crack_parameters.h"
#include "terrain/error.h"
#include "terrain/fields/curled_height.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/column_ground.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <queue>

namespace hoodoo
{

CrackedSurface::CrackedSurface(std::shared_ptr<const Surface> base, CrackedField field, const CrackedPatchSettings& settings, const Looks& looks)
    : base_(std::move(base)), field_(std::move(field)), patches_(field_, settings), materials_(base_->materials())
{
    const auto index = [&](const std::string& name) {
        const auto known = std::find(materials_.begin(), materials_.end(), name);
        const auto at = static_cast<std::size_t>(known - materials_.begin());
        if (known == materials_.end()) materials_.push_back(name);
        return at;
    };
    constexpr std::size_t none = ~std::size_t{0};
    inside_ = looks.inside.empty() ? none : index(looks.inside);
    above_ = looks.above.empty() ? none : index(looks.above);
}

std::vector<std::string> CrackedSurface::materials() const
{
    return materials_;
}

Interaction CrackedSurface::interact(const Ray& ray, const Hit& hit) const
{
    Interaction at;
    at.t = hit.t;
    at.position = ray.at(hit.t);
    const double rounding = 2.0 * patches_.rounding() + 16.0 * 0x1p-52 * ((ray.origin - at.position).length() + std::abs(hit.t));
    const CrackedPatches::Met met = patches_.met(ray, hit.t);
    Part part = Part::wall;
    if (met.wall) {
        at.position_error = rounding;
        at.geometric_normal = Vec3d(met.into.x, met.into.y, 0.0);
    } else {
        at.position_error = patches_.accuracy() + rounding;
        const Vec2d q(at.position.x, at.position.y);
        const double h = field_.ground().height(q);
        const Vec2d slope = field_.ground().gradient(q);
        // Of top and floor the one that is here; where they coincide they have one normal, too.
        part = std::abs(field_.lifted(at.position.z, true) - h) < std::abs(at.position.z - h) ? Part::floor : Part::top;
        at.geometric_normal = Vec3d(-slope.x, -slope.y, part == Part::floor ? field_.lifted_slope(at.position.z) : 1.0);
        if (!(at.geometric_normal.length() > 0.0)) at.geometric_normal = Vec3d(0.0, 0.0, 1.0);
        at.geometric_normal.normalize();
    }
    wear(at, part);

    // Doubled until the field says air for certain; in the corner of a floor and a wall it may never, and any offset is as good.
    const double first = 2.0 * at.position_error;
    const double most = 1e4 * patches_.accuracy();
    at.spawn_offset = first;
    while (at.spawn_offset < most && !(field_.value(at.position + at.geometric_normal * at.spawn_offset) > 0.0)) at.spawn_offset *= 2.0;
    if (!(at.spawn_offset < most)) at.spawn_offset = first;
    return at;
}

void CrackedSurface::dress(Interaction& at) const
{
    const Vec2d q(at.position.x, at.position.y);
    const double h = field_.ground().height(q);
    const bool floor = std::abs(field_.lifted(at.position.z, true) - h) < std::abs(at.position.z - h);
    wear(at, std::abs(at.geometric_normal.z) < 1e-9 ? Part::wall : floor ? Part::floor : Part::top);
}

void CrackedSurface::wear(Interaction& at, Part part) const
{
    const Vec2d q(at.position.x, at.position.y), slope = field_.ground().gradient(q);
    // The base's looks above or at this place, where the base has a surface.
    Interaction ground;
    ground.position = Vec3d(q.x, q.y, field_.ground().height(q));
    ground.geometric_normal = Vec3d(-slope.x, -slope.y, 1.0).normalized();
    base_->dress(ground);
    at.uv = ground.uv;
    at.texture_point = part == Part::top ? ground.texture_point : ground.texture_point + (at.position - ground.position);
    // A ground that was reshaped no longer has the base's shading.
    const bool own = part == Part::top && &field_.ground() == base_->height();
    at.shading_normal = own ? into_hemisphere(ground.shading_normal, at.geometric_normal) : at.geometric_normal;
    if (part != Part::top && inside_ < materials_.size()) {
        at.materials.add(static_cast<std::uint8_t>(inside_), 1.0f);
        return;
    }
    const auto share = above_ < materials_.size() ? static_cast<float>(field_.iota(q)) : 1.0f;
    for (std::size_t k = 0; k < ground.materials.count; ++k)
        if (share > 0.0f) at.materials.add(ground.materials.index[k], share * ground.materials.weight[k]);
    if (share < 1.0f) at.materials.add(static_cast<std::uint8_t>(above_), 1.0f - share);
}

SurfaceInfo CrackedSurface::info() const
{
    SurfaceInfo info = base_->info();
    info.trace_bytes = info.trace_bytes + patches_.memory_bytes() + field_.network().diagram().memory_bytes();
    info.patches = patches_.patch_count();
    info.build_seconds += build_seconds_;
    return info;
}

namespace
{

/// The lowest height in the area (sign = 1), or minus the highest (sign = -1): best first over proved ranges, until no better one can be, but for
/// `tolerance`, or after a fixed effort.
double extreme(const Height& height, const Box2d& area, double sign, double tolerance)
{
    struct Candidate {
        double bound;
        Box2d area;
        bool operator<(const Candidate& o) const { return bound > o.bound; }
    };
    const auto bound = [&](const Box2d& part) {
        const Interval range = height.range(part).scaled(sign);
        return range.lo;
    };
    std::priority_queue<Candidate> open;
    open.push({bound(area), area});
    double best = kInfinity;
    for (int effort = 0; effort < 20000 && !open.empty() && open.top().bound < best - tolerance; ++effort) {
        const Box2d part = open.top().area;
        open.pop();
        for (int quarter = 0; quarter < 4; ++quarter) {
            const Vec2d middle = (part.min + part.max) * 0.5;
            Box2d q = part;
            (quarter & 1 ? q.min.x : q.max.x) = middle.x;
            (quarter & 2 ? q.min.y : q.max.y) = middle.y;
            for (const Vec2d& p : {q.min, q.max, (q.min + q.max) * 0.5}) best = std::min(best, sign * height.height(p));
            open.push({bound(q), q});
        }
    }
    return best;
}

/// What may stand in a [[ground]] table: heights, and layers by the tops of their columns.
std::vector<CatalogueEntry> ground_rows()
{
    std::vector<CatalogueEntry> rows = height_rows();
    rows.push_back(convolution_row());
    return rows;
}

std::shared_ptr<const Surface> ground_of(const Values& values, const BuildContext& context)
{
    const bool named = values.has("base"), inline_ground = !values.tables("ground").empty();
    if (named == inline_ground)
        throw Error(ErrorKind::scene,
                    Problem{values.where(), "what is cracked", "either base = \"NAME\" or one [[ground]] table", named ? "both" : "neither", {}});
    std::shared_ptr<const Surface> base;
    const std::string key = named ? "base" : "ground";
    if (named) {
        const std::string& name = values.text("base");
        if (!context.base) throw values.problem("base", "there is no other terrain to crack", "the name of a terrain", "\"" + name + "\"");
        base = context.base(name, values.where("base"));
    } else {
        const Values& ground = values.tables("ground")[0];
        BuildContext inner = context;
        inner.seed = hash_name(context.seed, "ground");
        for (const CatalogueEntry& row : ground_rows()) {
            if (row.name != ground.variant()) continue;
            if (row.stack)
                base = std::make_shared<ColumnGround>(*row.stack(ground, inner));
            else
                base = std::move(std::get<std::unique_ptr<Surface>>(row.make(ground, inner)));
        }
    }
    if (!base->height())
        throw values.problem(key, "this terrain cannot be cracked: it is no height over the plane", "a terrain such as heightfield or elevation",
                             named ? "\"" + values.text("base") + "\"" : "\"" + values.tables("ground")[0].variant() + "\"");
    return base;
}

Box2d region_of(const Values& values, const Height& height)
{
    const Box2d domain = height.domain();
    Box2d region = domain;
    if (values.has("region_min")) region.min = values.vec2("region_min");
    if (values.has("region_max")) region.max = values.vec2("region_max");
    const auto text = [](const Vec2d& v) { return fmt::format("[{:.6g}, {:.6g}]", v.x, v.y); };
    for (int k = 0; k < 2; ++k) {
        if (!std::isfinite(region.min[k]) || !std::isfinite(region.max[k]))
            throw values.problem(values.has("region_min") ? "region_max" : "region_min", "this ground has no end: say which part is cracked",
                                 "region_min and region_max");
        if (!(region.min[k] < region.max[k]))
            throw values.problem("region_max", "the region that is cracked is empty", "region_min below region_max",
                                 text(region.min) + " to " + text(region.max));
        if (region.min[k] < domain.min[k] || region.max[k] > domain.max[k])
            throw values.problem(region.max[k] > domain.max[k] ? "region_max" : "region_min", "the region reaches beyond the ground",
                                 text(domain.min) + " to " + text(domain.max), text(region.min) + " to " + text(region.max));
    }
    return region;
}

Interval levels_of(const Values& values, const Height& height, const Box2d& region)
{
    const Interval range = height.range(region);
    const double tolerance = 1e-4 * (range.hi - range.lo);
    const double zero = values.has("zero") ? values.number("zero") : extreme(height, region, 1.0, tolerance);
    const double one = values.has("one") ? values.number("one") : -extreme(height, region, -1.0, tolerance);
    if (!(zero < one))
        throw values.problem(values.has("one") ? "one" : "zero", "the elevations of h = 0 and h = 1", "zero below one (flat ground needs both)",
                             fmt::format("{:.6g} m and {:.6g} m", zero, one));
    return {zero, one};
}

Shape make_cracked(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const Surface> base = ground_of(values, context);
    const std::shared_ptr<const Height> height(base, base->height());
    const Box2d region = region_of(values, *height);
    const Vec2d size = region.size();
    const Interval level = levels_of(values, *height, region);
    if (context.progress) context.progress(0.2, "cracks");
    CrackNetwork network = crack_network(values, context.seed, size);
    const CrackDepth depth{values.number("kappa"), values.number("psi"), values.number("epsilon")};
    std::shared_ptr<const Height> ground = height;
    if (const double curl = values.number("curl"); curl != 0.0) {
        const double spacing = network.width() / values.number("lambda");
        ground = std::make_shared<CurledHeight>(height, network.diagram(), region.min, curl, values.number("curl_reach") * spacing);
    }
    CrackedField field(std::move(ground), std::move(network), depth, region, level.lo, level.hi);

    CrackedPatchSettings settings;
    settings.size = values.has("patch") ? values.number("patch") : std::max(size.x, size.y) / 256.0;
    settings.accuracy = 1e-9 * std::max(size.x, size.y);
    if (context.progress) context.progress(0.5, "patches");
    auto surface =
        std::make_unique<CrackedSurface>(base, std::move(field), settings, CrackedSurface::Looks{values.text("inside"), values.text("above")});
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

std::vector<Schema> ground_schemas()
{
    std::vector<Schema> schemas;
    for (const CatalogueEntry& row : ground_rows()) schemas.push_back(row.schema);
    return schemas;
}

}  // namespace

CatalogueEntry cracked_row()
{
    Schema schema{
        "cracked", "Any terrain that is a height over the plane, torn by dry cracks with vertical walls. Its base is not rendered itself.", {}};
    schema.parameters = {
        {.name = "base", .type = ParameterType::text, .doc = "Name of the terrain that is cracked."},
        {.name = "ground",
         .type = ParameterType::tables,
         .doc = "The ground itself, instead of a base: one table, whose `type` is a terrain with a height; of layers (convolution) the tops of "
                "their columns.",
         .max_count = 1,
         .discriminator = "type",
         .items = ground_schemas()},
    };
    const auto append = [&](std::vector<Parameter> more) { std::move(more.begin(), more.end(), std::back_inserter(schema.parameters)); };
    append(crack_parameters(SiteKind::random, 0.3, 0.99, "Depth of a crack, share of the height h there."));
    append({
        {.name = "psi",
         .type = ParameterType::number,
         .doc = "Border line: up to this height h cracks have their full depth.",
         .fallback = 0.4,
         .minimum = 0,
         .maximum = 1},
        {.name = "epsilon",
         .type = ParameterType::number,
         .doc = "Border error: over this much above the border line cracks vanish; 0: at once.",
         .fallback = 0.2,
         .minimum = 0,
         .maximum = 1},
        {.name = "zero", .type = ParameterType::length, .doc = "Elevation of h = 0; by default the ground's lowest, to 1e-4.", .unit = "m"},
        {.name = "one", .type = ParameterType::length, .doc = "Elevation of h = 1; by default the ground's highest, to 1e-4.", .unit = "m"},
    });
    append(crack_region_parameters("that is shown and cracked; by default the ground's own."));
    append({
        {.name = "curl",
         .type = ParameterType::length,
         .doc = "By how much the rims of plates rise above the ground; below 0 they sink.",
         .fallback = 0.0,
         .unit = "m"},
        {.name = "curl_reach",
         .type = ParameterType::number,
         .doc = "How far from their rims plates curl, share of the mean spacing of the sites.",
         .fallback = 0.35,
         .minimum = 0,
         .maximum = 10,
         .above_minimum = true},
        {.name = "inside", .type = ParameterType::text, .doc = "Material of walls and floors; by default the ground's.", .fallback = std::string()},
        {.name = "above",
         .type = ParameterType::text,
         .doc = "Material beyond the border line, such as a vegetation; by default the ground's.",
         .fallback = std::string()},
        {.name = "patch",
         .type = ParameterType::length,
         .doc = "Side of the boxes that rays are tested against; by default the longest side of the region by 256.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    });
    return {"cracked", "Li2023", std::move(schema), make_cracked};
}

}  // namespace hoodoo
