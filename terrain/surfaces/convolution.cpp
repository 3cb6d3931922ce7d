// A layer stack seen through its convolution field: smooth cliffs, arches and caves, met by rays directly, without a mesh.
// Peytavie2009, sections 3 and 5: f = 1 - V/(4 sigma^3) of the ground (stack/convolution.h); materials blended by their visible shares.
// Rock layers are filled with instanced rocks (rocks = "instances", terrain/rocks), which belong to the surface but are no part of its verbs.
// Bodies: the ground (`materials` of the stack, one field) and, with rocks = "surface", the rock layers as a second, smooth body of their own. Each
// has its own patches; tiles of the bodies follow one another. interact() refines the patch's hit on the field itself in double precision: a bracket
// around t, then bisection with secant steps. Geometric normal: the field's gradient (one-sided). Shading normal: central differences with half-width
// `normal_width` (continuous). Deviations: the paper polygonises; its triplanar weights belong to the renderer. Surfaces exist over the grid's
// rectangle only: with `extend` the edge columns go on for the field's sake (no wall at the edge), but rays beyond it meet nothing. Water is a body
// without a field, flat on top (march/water_patches.h), after all others.
#include "terrain/surfaces/convolution.h"

#include "terrain/error.h"
#include "terrain/march/exact_cells.h"
#include "terrain/march/sphere_bricks.h"
#include "terrain/march/water_patches.h"
#include "terrain/stack/columns_around.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rock_source.h"
#include "terrain/surfaces/stack_materials.h"
#include "terrain/surfaces/stack_source.h"

#include <chrono>

namespace hoodoo
{

namespace
{

using IntersectorFactory = std::unique_ptr<PatchIntersector> (*)(const ConvolutionField&);

struct Body {
    MaterialSet set;
    std::unique_ptr<const ConvolutionField> field;
    std::unique_ptr<PatchIntersector> patches;
    std::uint32_t first_tile;
};

/// What edit() needs; no stack: nobody may call it.
struct Editing {
    std::shared_ptr<MaterialStack> stack;
    EditContext how;
    std::uint64_t seed = 0;
    std::size_t number = 0;
};

class ConvolutionSurface final : public EditableSurface
{
public:
    ConvolutionSurface(std::shared_ptr<const MaterialStack> stack, double normal_width) : stack_(std::move(stack)), normal_width_(normal_width) {}

    void add_body(const Ground& ground, double sigma, IntersectorFactory make)
    {
        Body body{ground.materials(), std::make_unique<ConvolutionField>(ground, sigma), nullptr, tiles_};
        body.patches = make(*body.field);
        tiles_ += body.patches->tile_count();
        shown_.show(body.set);
        bodies_.push_back(std::move(body));
    }

    /// After all bodies: the water that stands on the first of them.
    void add_water()
    {
        water_ = std::make_unique<WaterPatches>(*bodies_.front().field);
        first_water_tile_ = tiles_;
        tiles_ += water_->tile_count();
        shown_.show(material_set({Material::water}));
    }

    Rebuilt rebuild(const ColumnSet& changed) override
    {
        Rebuilt rebuilt;
        std::vector<std::uint32_t>& tiles = rebuilt.tiles;
        for (Body& body : bodies_) {
            for (const std::uint32_t tile : body.patches->rebuild(changed)) tiles.push_back(body.first_tile + tile);
        }
        if (lying_) rebuilt.rocks = lying_->follow(changed);
        if (!water_ || !(has_water() || holds(changed, Material::water))) return rebuilt;
        // Water levels reach far: its boxes are made anew, all of them.
        const auto before = std::move(water_);
        water_ = std::make_unique<WaterPatches>(*bodies_.front().field);
        for (std::uint32_t tile = 0; tile < water_->tile_count(); ++tile) {
            if (before->patch_count(tile) > 0 || water_->patch_count(tile) > 0) tiles.push_back(first_water_tile_ + tile);
        }
        return rebuilt;
    }

    Box3d room() const override
    {
        // A surface never leaves its block by a whole kernel, nor the heights that the stack can hold.
        const double sigma = bodies_.front().field->sigma(), floor = bodies_.front().field->ground().floor();
        const Vec3d size(stack_->size().x * stack_->cell(), stack_->size().y * stack_->cell(), MaterialStack::max_top * stack_->unit());
        const double below = bodies_.front().field->ground().border() == Border::cut ? -floor * stack_->unit() : 0.0;
        const double around = std::max(sigma, lying_ ? lying_->overhang() : 0.0);
        return Box3d(stack_->origin() - Vec3d(around, around, around + below), stack_->origin() + size + Vec3d(around));
    }

    /// The next edits are those of a terrain with that seed that has had `number` of them.
    void allow_edits(std::shared_ptr<MaterialStack> stack, EditContext how, std::uint64_t seed, std::size_t number)
    {
        editing_ = {std::move(stack), std::move(how), seed, number};
    }
    bool takes_edits() const override { return editing_.stack != nullptr; }
    ColumnSet edit(const std::string& tool, const Node& parameters) override
    {
        if (!takes_edits()) throw Error(ErrorKind::internal, "the stack of this surface is edited by its owner");
        ColumnSet changed = apply_edit(*editing_.stack, tool, parameters, editing_.seed, editing_.number, editing_.how);
        ++editing_.number;
        return changed;
    }

    /// Rocks that lie on the ground; their material joins the names.
    void add_rocks(std::unique_ptr<LyingRocks> lying)
    {
        lying_ = std::move(lying);
        lying_->rocks.material_index = shown_.show("rock");
    }

    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t tile_count() const override { return tiles_; }
    std::uint32_t patch_count(std::uint32_t tile) const override
    {
        if (is_water(tile)) return water_->patch_count(tile - first_water_tile_);
        const Body& body = body_of(tile);
        return body.patches->patch_count(tile - body.first_tile);
    }
    Box3d patch_bounds(PatchId patch) const override
    {
        if (is_water(patch.tile)) return water_->patch_bounds({patch.tile - first_water_tile_, patch.index});
        const Body& body = body_of(patch.tile);
        return body.patches->patch_bounds({patch.tile - body.first_tile, patch.index});
    }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        if (is_water(patch.tile)) {
            if (!water_->intersect({patch.tile - first_water_tile_, patch.index}, ray, hit)) return false;
            hit.patch = patch;
            return true;
        }
        const Body& body = body_of(patch.tile);
        if (!body.patches->intersect({patch.tile - body.first_tile, patch.index}, ray, hit)) return false;
        hit.patch = patch;
        return true;
    }
    bool occluded(PatchId patch, const Ray& ray) const override
    {
        if (is_water(patch.tile)) return Surface::occluded(patch, ray);
        const Body& body = body_of(patch.tile);
        return body.patches->occluded({patch.tile - body.first_tile, patch.index}, ray);
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        if (is_water(hit.patch.tile)) return on_water(ray, hit);
        const Body& body = body_of(hit.patch.tile);
        Interaction at;
        // All questions are about points near the hit: a hair along the ray, a hair along the normal, normal_width along the axes.
        const Vec3d hit_point = ray.at(hit.t);
        const double hair = 2e-3 * stack_->cell() + std::numeric_limits<float>::epsilon() * hit_point.length();
        const ColumnsAround near(*body.field, hit_point, normal_width_ + hair);
        const auto value = [&](const Vec3d& p) { return is_within(p, hit_point, hair) ? near.value(p) : body.field->value(p); };
        const Refined refined = refine_crossing(value, ray, hit.t, body.patches->value_error(), stack_->cell());
        at.t = refined.t;
        at.position = ray.at(refined.t);
        at.position_error = refined.error;
        const ConvolutionField::Neighbourhood around = near.neighbourhood(at.position, normal_width_);
        const Vec3d smooth = around.smoothed;
        at.geometric_normal = around.gradient;
        if (!(at.geometric_normal.length() > 1e-9 / body.field->sigma())) at.geometric_normal = smooth;
        at.geometric_normal.normalize();
        at.shading_normal = into_hemisphere(smooth.normalized(), at.geometric_normal);
        at.spawn_offset = spawn_offset(body, value, at);
        at.texture_point = at.position;
        shown_.blend(*body.field, body.set, near, at);
        return at;
    }

    void dress(Interaction& at) const override
    {
        const Body& body = bodies_.front();
        const ColumnsAround near(*body.field, at.position, normal_width_);
        const Vec3d smooth = near.neighbourhood(at.position, normal_width_).smoothed;
        at.shading_normal = into_hemisphere(smooth.normalized(), at.geometric_normal);
        at.texture_point = at.position;
        shown_.blend(*body.field, body.set, near, at);
    }

    bool contains(const Vec3d& p) const override
    {
        for (const Body& body : bodies_) {
            if (body.field->value(p) <= 0.0) return true;
        }
        return water_ && water_->contains(p);
    }

    std::vector<std::string> materials() const override { return shown_.names(); }
    const Instances* instances() const override { return lying_ ? &lying_->rocks : nullptr; }
    bool closed() const override { return bodies_.front().field->ground().border() == Border::cut; }

    /// Two bodies have no common field.
    const Field* field() const override { return bodies_.size() == 1 && !water_ ? bodies_.front().field.get() : nullptr; }
    std::vector<CoarserField> coarser_fields(double width) const override
    {
        // Wider kernels over the same layers. A cube of 32 cells reads a thousand columns.
        std::vector<CoarserField> coarser;
        if (!field()) return coarser;
        const ConvolutionField& own = *bodies_.front().field;
        for (double side = 4.0 * own.sigma(); side <= 32.0 * stack_->cell() && side < 2.0 * width; side *= 2.0)
            coarser.push_back({side, std::make_shared<ConvolutionField>(own.ground(), 0.5 * side)});
        return coarser;
    }
    std::vector<const Field*> fields() const override
    {
        std::vector<const Field*> all;
        for (const Body& body : bodies_) all.push_back(body.field.get());
        return all;
    }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.columns = static_cast<std::uint64_t>(stack_->size().x) * static_cast<std::uint64_t>(stack_->size().y);
        info.layers = stack_->layer_count();
        info.stack_bytes = stack_->memory_bytes();
        for (const Body& body : bodies_) {
            info.trace_bytes += body.patches->memory_bytes();
            for (std::uint32_t t = 0; t < body.patches->tile_count(); ++t) info.patches += body.patches->patch_count(t);
        }
        if (water_) {
            info.trace_bytes += water_->memory_bytes();
            for (std::uint32_t t = 0; t < water_->tile_count(); ++t) info.patches += water_->patch_count(t);
        }
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    bool has_water() const
    {
        for (std::uint32_t tile = 0; tile < water_->tile_count(); ++tile)
            if (water_->patch_count(tile) > 0) return true;
        return false;
    }

    bool holds(const ColumnSet& columns, Material material) const
    {
        return std::any_of(columns.indices().begin(), columns.indices().end(), [&](std::uint32_t index) {
            const Vec2i c = columns.column(index);
            const auto words = stack_->words(c.x, c.y);
            return std::any_of(words.begin(), words.end(), [&](std::uint16_t word) { return MaterialStack::material_of(word) == material; });
        });
    }

    bool is_water(std::uint32_t tile) const { return water_ && tile >= first_water_tile_; }

    Interaction on_water(const Ray& ray, const Hit& hit) const
    {
        Hit own = hit;
        own.patch.tile -= first_water_tile_;
        Interaction at = water_->interact(ray, own);
        shown_.dress(Material::water, at);
        // Off the water; and off the ground too, where the shore is so near that its field cannot tell, unless the shore stands upright.
        const double least = std::max(2.0 * at.position_error, 1e-9 * stack_->cell()), most = 1e-3 * stack_->cell();
        const auto dry = [&](double offset) {
            const Vec3d p = at.position + at.geometric_normal * offset;
            return std::all_of(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.field->value(p) > 2.0 * b.patches->value_error(); });
        };
        at.spawn_offset = least;
        while (at.spawn_offset < most && !dry(at.spawn_offset)) at.spawn_offset *= 2.0;
        if (!(at.spawn_offset < most)) at.spawn_offset = least;
        return at;
    }

    const Body& body_of(std::uint32_t tile) const
    {
        std::size_t b = bodies_.size() - 1;
        while (bodies_[b].first_tile > tile) --b;
        return bodies_[b];
    }

    /// Doubles the offset until the field says air by more than the patches can err. Other bodies count as long as the point does not lie deep in
    /// them: where rock rests on ground the two surfaces coincide, and no offset leaves both.
    template <class Value>
    double spawn_offset(const Body& body, const Value& value, const Interaction& at) const
    {
        const auto point = [&](double offset) { return at.position + at.geometric_normal * offset; };
        const double most = body.field->sigma();
        double own = std::max(2.0 * at.position_error, 1e-9 * stack_->cell());
        while (own < most && !(value(point(own)) > 2.0 * body.patches->value_error())) own *= 2.0;
        for (double offset = own; offset < most; offset *= 2.0) {
            bool all = true;
            for (const Body& b : bodies_)
                all = all && ((&b == &body && offset == own) || b.field->value(point(offset)) > 2.0 * b.patches->value_error());
            if (all) return offset;
        }
        return own;
    }

    static bool is_within(const Vec3d& p, const Vec3d& centre, double reach)
    {
        const Vec3d d = p - centre;
        return std::abs(d.x) <= reach && std::abs(d.y) <= reach && std::abs(d.z) <= reach;
    }

    std::shared_ptr<const MaterialStack> stack_;
    double normal_width_;
    std::vector<Body> bodies_;
    std::unique_ptr<const WaterPatches> water_;
    std::uint32_t first_water_tile_ = 0;
    std::uint32_t tiles_ = 0;
    StackMaterials shown_;
    std::unique_ptr<LyingRocks> lying_;
    Editing editing_;
    double build_seconds_ = 0.0;
};

IntersectorFactory choose_intersector(const Values& values, const Ground& ground, double sigma)
{
    const std::string& wanted = values.text("intersector");
    if (wanted == "sphere") return make_sphere_bricks;
    const std::optional<std::string> why_not = why_not_exact(ConvolutionField(ground, sigma));
    if (!why_not) return make_exact_cells;
    if (wanted == "exact")
        throw values.problem("intersector", "the exact intersector cannot be used: " + *why_not, "intersector = \"sphere\" or another sigma");
    return make_sphere_bricks;
}

IntersectorFactory fastest(const Ground& ground, double sigma)
{
    return why_not_exact(ConvolutionField(ground, sigma)) ? make_sphere_bricks : make_exact_cells;
}

bool has_material(const MaterialStack& stack, Material material)
{
    for (int j = 0; j < stack.size().y; ++j) {
        for (int i = 0; i < stack.size().x; ++i) {
            for (const std::uint16_t word : stack.words(i, j)) {
                if (MaterialStack::material_of(word) == material) return true;
            }
        }
    }
    return false;
}

}  // namespace

Shape make_convolution(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    if (context.progress) context.progress(0.0, "layers");
    const std::shared_ptr<MaterialStack> stack = make_stack(values, context);
    const double sigma = stack_kernel(values, stack->cell());
    MaterialSet set = 0;
    for (const std::string& name : values.names("materials")) set = static_cast<MaterialSet>(set | material_set({material_from_name(name)}));
    const std::string& rocks = values.text("rocks");
    if (rocks == "ground") set = static_cast<MaterialSet>(set | material_set({Material::rock}));
    const bool cut = values.text("border") == "cut";
    // A cut block's default base is as thick as the kernel's cube is wide: a flat bottom, not a rounded one.
    const double base = cut ? std::ceil((values.has("base") ? values.number("base") : 2.0 * sigma) / stack->unit()) : 0.0;
    if (!(base <= 1e6)) throw values.problem("base", "the base of the block is too thick", "at most 1e6 height units");
    const Border border = cut ? Border::cut : Border::extend;

    if (context.progress) context.progress(0.3, "surface");
    auto surface = std::make_unique<ConvolutionSurface>(stack, values.number("normal_width") * stack->cell());
    const Ground ground(stack, set, border, static_cast<std::int32_t>(base));
    surface->add_body(ground, sigma, choose_intersector(values, ground, sigma));
    const auto shows = [&](Material m) { return !ground.contains(m) && (context.editable || has_material(*stack, m)); };
    if (rocks == "surface" && shows(Material::rock)) {
        const Ground rock(stack, material_set({Material::rock}), border, static_cast<std::int32_t>(base));
        surface->add_body(rock, sigma, choose_intersector(values, rock, sigma));
    }
    if (values.text("water") == "surface" && shows(Material::water)) surface->add_water();
    if (rocks == "instances" && !ground.contains(Material::rock)) {
        auto lying = std::make_unique<LyingRocks>(stack, border, values, context);
        if (context.editable || !lying->rocks.instances.empty()) surface->add_rocks(std::move(lying));
    }
    if (context.editable) surface->allow_edits(stack, edit_context(values, context, stack->cell()), context.seed, values.tables("edit").size());
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

std::unique_ptr<EditableSurface> make_convolution_surface(std::shared_ptr<const MaterialStack> stack, const ConvolutionOptions& options)
{
    const double sigma = options.sigma > 0.0 ? options.sigma : stack->cell();
    auto surface = std::make_unique<ConvolutionSurface>(stack, options.normal_width * stack->cell());
    const auto base = static_cast<std::int32_t>(std::min(std::ceil(options.base / stack->unit()), 1e9));
    const auto add = [&](MaterialSet set) {
        const Ground ground(stack, set, options.border, base);
        surface->add_body(ground, sigma, options.exact ? fastest(ground, sigma) : make_sphere_bricks);
    };
    add(options.materials);
    const MaterialSet rock = material_set({Material::rock});
    if (options.rocks && (options.materials & rock) == 0) add(rock);
    if (options.water && (options.materials & material_set({Material::water})) == 0) surface->add_water();
    return surface;
}

}  // namespace hoodoo
