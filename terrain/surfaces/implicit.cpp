// A blob tree as a terrain: what is built of skeletons, and what they carve out of any terrain that has a field: cliffs, overhangs, caves.
// Wyvill1999 for the tree, Galin2020 for tracing by bounds of the slope over a segment: patches are boxes with a proved
// zero (march/field_patches.h), and a ray in one is halved until slopes or curvatures over its pieces prove that nothing was missed. A point shows
// the material of the node whose surface it is; what is carved by a node without a material shows what it was carved out of. Where a terrain shows,
// it keeps its own looks, shading normal included. What is traced is the tree's own box; a terrain without an end is cut off at the sides of its
// rectangle, and below whatever carves it. Deviation: distances, not potentials, are combined. Missing: motion; level of detail.
#include "terrain/error.h"
#include "terrain/surfaces/implicit_nodes.h"
#include "terrain/surfaces/marched_surface.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

class ImplicitSurface final : public MarchedSurface
{
public:
    ImplicitSurface(ImplicitTree tree, std::string material, bool closed) : tree_(std::move(tree)), closed_(closed)
    {
        names_.push_back(std::move(material));
        const auto number = [&](const std::string& name) {
            const auto found = std::find(names_.begin(), names_.end(), name);
            const auto n = static_cast<std::uint8_t>(found - names_.begin());
            if (found == names_.end()) names_.push_back(name);
            return n;
        };
        for (const std::string& name : tree_.materials) own_.push_back(number(name));
        for (const auto& terrain : tree_.terrains) {
            std::vector<std::uint8_t>& theirs = theirs_.emplace_back();
            for (const std::string& name : terrain->materials()) theirs.push_back(number(name));
        }
    }

    std::size_t material_count() const { return names_.size(); }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = crossing_at(ray, hit, settings().accuracy);
        at.geometric_normal = tree_.root->gradient(at.position);
        if (!(at.geometric_normal.length() > 1e-12)) at.geometric_normal = -ray.direction;
        at.geometric_normal.normalize();
        dress(at);
        at.spawn_offset = air_above(at, ray.time);
        return at;
    }

    void dress(Interaction& at) const override
    {
        BlobShares shares;
        tree_.root->shares(at.position, 1.0, shares);
        at.shading_normal = at.geometric_normal;
        at.texture_point = at.position;
        std::vector<double> weights(names_.size(), 0.0);
        double sum = 0.0;
        for (const BlobShares::Share& share : shares.list) {
            sum += share.weight;
            if (share.source < BlobShares::kTerrain) {
                weights[share.source == BlobShares::kNoSource ? 0 : own_[static_cast<std::size_t>(share.source)]] += share.weight;
            } else {
                wear(static_cast<std::size_t>(share.source - BlobShares::kTerrain), share.weight, shares.list.size() == 1, weights, at);
            }
        }
        // The heaviest, as many as there is room for.
        std::vector<std::size_t> order;
        for (std::size_t m = 0; m < weights.size(); ++m)
            if (weights[m] > 0.0) order.push_back(m);
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
        order.resize(std::min(order.size(), MaterialWeights::capacity));
        double kept = 0.0;
        for (const std::size_t m : order) kept += weights[m];
        for (const std::size_t m : order) at.materials.add(static_cast<std::uint8_t>(m), static_cast<float>(weights[m] / kept));
    }

    bool contains(const Vec3d& p) const override { return tree_.root->value(p) <= 0.0 && settings().domain.intersects(p); }
    std::vector<std::string> materials() const override { return names_; }
    bool closed() const override { return closed_; }
    const Field* field() const override { return tree_.root.get(); }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        for (const auto& terrain : tree_.terrains) {
            const SurfaceInfo own = terrain->info();
            info.columns += own.columns;
            info.layers += own.layers;
            info.stack_bytes += own.stack_bytes;
            info.trace_bytes += own.trace_bytes;
        }
        add_patches(info);
        return info;
    }

private:
    /// The looks of a terrain at the point. Its shading normal too if nothing else shows and the surface is its own, not one carved into it.
    void wear(std::size_t terrain, double weight, bool alone, std::vector<double>& weights, Interaction& at) const
    {
        Interaction theirs;
        theirs.position = at.position;
        theirs.geometric_normal = at.geometric_normal;
        const Surface& surface = *tree_.terrains[terrain];
        surface.dress(theirs);
        for (std::size_t m = 0; m < theirs.materials.count; ++m)
            weights[theirs_[terrain][theirs.materials.index[m]]] += weight * theirs.materials.weight[m];
        const Vec3d slope = surface.field()->gradient(at.position);
        if (!alone || !(slope.length() > 0.0) || !(slope.normalized().dot(at.geometric_normal) > 1.0 - 1e-9)) return;
        at.shading_normal = into_hemisphere(theirs.shading_normal, at.geometric_normal);
        at.uv = theirs.uv;
        at.texture_point = theirs.texture_point;
    }

    double value(const Vec3d& p, double) const override { return tree_.root->value(p); }
    LocalField local(const Box3d& box) const override { return tree_.root->local(box); }
    bool exists(const Vec3d&, double) const override { return true; }
    Vec3d inverse(const Vec3d& p, double) const override { return p; }
    double base_value(const Vec3d& q) const override { return tree_.root->value(q); }

    ImplicitTree tree_;
    bool closed_;
    std::vector<std::string> names_;
    std::vector<std::uint8_t> own_;
    std::vector<std::vector<std::uint8_t>> theirs_;
};

/// Where the tree's surface can be, in a finite box: what is endless ends with the terrains' patches across, and below what carves them.
Box3d natural_region(const ImplicitTree& tree)
{
    Box3d region = tree.root->bounds(), all = tree.primitives;
    all.extendBy(tree.ground);
    for (int k = 0; k < 3; ++k) {
        region.min[k] = std::isfinite(region.min[k]) ? region.min[k] : all.min[k];
        region.max[k] = std::isfinite(region.max[k]) ? region.max[k] : all.max[k];
    }
    const Vec3d pad(1e-6 * (1.0 + region.size().length()));
    return {region.min - pad, region.max + pad};
}

Shape make_implicit(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    if (context.progress) context.progress(0.0, "nodes");
    ImplicitTree tree = make_implicit_tree(values, context);
    PatchSettings settings;
    const Box3d natural = natural_region(tree);
    settings.domain = natural;
    if (values.has("region_min")) settings.domain.min = values.vec3("region_min");
    if (values.has("region_max")) settings.domain.max = values.vec3("region_max");
    bool whole = !tree.open;
    for (int k = 0; k < 3; ++k) {
        if (!(settings.domain.min[k] < settings.domain.max[k]))
            throw values.problem(values.has("region_max") ? "region_max" : "node", "the region to trace is empty", "min below max");
        whole = whole && settings.domain.min[k] <= natural.min[k] && settings.domain.max[k] >= natural.max[k];
    }
    const Vec3d size = settings.domain.size();
    settings.size = values.has("patch") ? values.number("patch") : std::max({size.x, size.y, size.z}) / 128.0;
    auto surface = std::make_unique<ImplicitSurface>(std::move(tree), values.text("material"), whole);
    if (surface->material_count() > 255)
        throw values.problem("node", "the materials of an implicit terrain", "at most 255", fmt::format("{}", surface->material_count()));
    if (context.progress) context.progress(0.3, "patches");
    surface->make_patches(settings);
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

}  // namespace

CatalogueEntry implicit_row()
{
    Schema schema{"implicit",
                  "Skeletons with flesh, joined, cut, blended, warped and roughened: solids of their own, or caves and overhangs in another terrain.",
                  {}};
    schema.parameters = {
        {.name = "node",
         .type = ParameterType::tables,
         .doc = "The nodes of the tree, in any order.",
         .required = true,
         .min_count = 1,
         .discriminator = "kind",
         .items = implicit_node_schemas()},
        {.name = "root", .type = ParameterType::text, .doc = "The node that is the terrain; by default the last one.", .fallback = std::string()},
        {.name = "material", .type = ParameterType::text, .doc = "Of what no node gives one.", .fallback = std::string("bedrock")},
        {.name = "patch",
         .type = ParameterType::length,
         .doc = "Side of the boxes that rays are tested against; by default the longest side of the region by 128.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "region_min",
         .type = ParameterType::vector,
         .doc = "Lower corner of what is traced; by default all.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "region_max", .type = ParameterType::vector, .doc = "Upper corner of what is traced.", .unit = "m", .min_count = 3, .max_count = 3},
    };
    return {"implicit", "Wyvill1999", std::move(schema), make_implicit};
}

}  // namespace hoodoo
