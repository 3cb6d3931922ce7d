// Any terrain that has a field, carried along a flow and met by rays where it went: overhangs from what had none (Gamito2001, sections 2 and 3).
// F(p) = base(Psi(p)), Psi the inverse warp (fields/warp.h); patches with proved bounds (march/field_patches.h). The normal is J^T grad base, the
// exact gradient of the discrete map: the paper's advected tangents give the same (its eq. 4 and 5; the signs of 6 cancel). Where that vanishes
// central differences stand in. Materials, uv and texture point are the base's own at the undeformed point, so strata and image maps follow the flow
// (3.2). Warps stack: the base may be `warped` itself. The intensity may change while the shutter is open: a ray carries its time, and the patches
// enclose all of it. Deviations: the paper's search is the option mode = "paper"; its bases are planes and height fields, here anything with a field,
// in which the surface ends where its base ends. Rocks on the base are moved, not bent. Missing: rocks that turn with the flow, or move while the
// shutter is open; coarser forms of implicit trees, voxels and landforms; meshes as bases.
// Level of detail: flows fade their octaves and the base passes over into coarser forms of itself (fields/detail_field.h), each by the distance of
// the place where it acts, less the farthest that the warp carries anything: what is seen is never coarser than its pixel. A function of the place
// alone, so that all rays meet one surface, and bounds are those of the faded functions.
#include "terrain/error.h"
#include "terrain/field.h"
#include "terrain/fields/detail_field.h"
#include "terrain/fields/warped_field.h"
#include "terrain/surfaces/flow_tables.h"
#include "terrain/surfaces/marched_surface.h"
#include "terrain/surfaces/patch_parameters.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

/// Union of a surface's patches, and a little more: where a box ends with the surface a crossing must not fall outside by its own error.
Box3d bounds_of(const Surface& surface)
{
    Box3d box;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
        for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) box.extendBy(surface.patch_bounds({tile, i}));
    const Vec3d pad(1e-6 * (1.0 + box.size().length()));
    return {box.min - pad, box.max + pad};
}

class WarpedSurface final : public MarchedSurface
{
public:
    WarpedSurface(std::shared_ptr<const Surface> base, Warp warp, Interval intensity, const std::optional<DetailView>& view)
        : base_(std::move(base)),
          inner_(dynamic_cast<const WarpedSurface*>(base_.get())),
          ground_(bounds_of(*base_)),
          detail_(view ? detailed(base_, ground_, *view) : nullptr),
          field_(detail_ ? std::shared_ptr<const Field>(detail_) : std::shared_ptr<const Field>(base_, base_->field()), std::move(warp),
                 intensity.lo),
          open_(intensity.lo),
          close_(intensity.hi)
    {
    }

    /// The rocks that lie on the base go with it, each as a whole, to where the middle of its cell is carried when the shutter opens.
    void carry_rocks()
    {
        const Instances* lying = base_->instances();
        if (!lying) return;
        rocks_ = *lying;
        for (Instance& rock : rocks_.instances) rock.position = field_.warp().forward(rock.position, open_);
    }

    /// Where the warped surface can be.
    Box3d domain() const
    {
        // Forwards a point goes as far as backwards: the speed is the same.
        const double reach = field_.warp().reach(ground_);
        return {ground_.min - Vec3d(reach), ground_.max + Vec3d(reach)};
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = crossing_at(ray, hit, settings().accuracy);
        const double duration = duration_at(ray.time);
        const Carried rest = field_.warp().inverse_with_jacobian(at.position, duration);
        const Vec3d slope = field_.base().gradient(rest.point);
        at.geometric_normal = apply_transposed(rest.jacobian, slope);
        if (!(at.geometric_normal.length() > 1e-12)) at.geometric_normal = differences(at.position, duration);
        at.geometric_normal.normalize();

        wear(rest, slope, at);
        at.spawn_offset = air_above(at, ray.time);
        return at;
    }

    void dress(Interaction& at) const override
    {
        const Carried rest = field_.warp().inverse_with_jacobian(at.position, open_);
        wear(rest, field_.base().gradient(rest.point), at);
    }

    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0 && exists(p, 0.0); }
    std::vector<std::string> materials() const override { return base_->materials(); }
    bool closed() const override { return base_->closed(); }
    const Field* field() const override { return &field_; }
    const Instances* instances() const override { return rocks_.instances.empty() ? nullptr : &rocks_; }

    SurfaceInfo info() const override
    {
        SurfaceInfo info = base_->info();
        info.patches = 0;
        add_patches(info);
        return info;
    }

private:
    /// The base's looks at the point that `rest` says, `slope` being its gradient there; its shading normal carried along.
    void wear(const Carried& rest, const Vec3d& slope, Interaction& at) const
    {
        Interaction below;
        below.position = rest.point;
        below.geometric_normal = slope.length() > 0.0 ? slope.normalized() : at.geometric_normal;
        base_->dress(below);
        // Where the base is coarser than its looks know, so is the light on it.
        const double fine = detail_ ? detail_->fineness(rest.point) : 1.0;
        Vec3d smooth = apply_transposed(rest.jacobian, below.shading_normal);
        if (smooth.length() > 0.0) smooth = smooth.normalized() * fine + at.geometric_normal * (1.0 - fine);
        at.shading_normal = smooth.length() > 0.0 ? into_hemisphere(smooth.normalized(), at.geometric_normal) : at.geometric_normal;
        at.uv = below.uv;
        at.texture_point = below.texture_point;
        at.materials = below.materials;
    }
    double duration_at(double time) const { return open_ + (close_ - open_) * time; }

    double value(const Vec3d& p, double time) const override { return field_.value(p, duration_at(time)); }
    LocalField local(const Box3d& box) const override
    {
        Box3d image;
        LocalField known = field_.local(box, {std::min(open_, close_), std::max(open_, close_)}, &image);
        if (!ground_.intersects(image)) known.value = {kInfinity, -kInfinity};
        return known;
    }
    bool exists(const Vec3d& p, double time) const override
    {
        const Vec3d rest = inverse(p, time);
        return ground_.intersects(rest) && (!inner_ || inner_->exists(rest, 0.0));
    }
    Vec3d inverse(const Vec3d& p, double time) const override { return field_.warp().inverse(p, duration_at(time)); }
    double base_value(const Vec3d& q) const override { return field_.base().value(q); }

    Vec3d differences(const Vec3d& p, double duration) const
    {
        const double h = 1e-4 * settings().size;
        Vec3d g;
        for (int k = 0; k < 3; ++k) {
            Vec3d step(0.0);
            step[k] = h;
            g[k] = field_.value(p + step, duration) - field_.value(p - step, duration);
        }
        return g.length() > 0.0 ? g : Vec3d(0.0, 0.0, 1.0);
    }

    /// The base with its coarser forms, as many as are seen in the box; nullptr if there are none. Grows the box by how far they may lie off.
    static std::shared_ptr<const DetailField> detailed(const std::shared_ptr<const Surface>& base, Box3d& ground, const DetailView& view)
    {
        const std::vector<CoarserField> coarser = base->coarser_fields(2.0 * view.footprint(distances(ground, view.eye).hi));
        if (coarser.empty()) return nullptr;
        std::vector<std::shared_ptr<const Field>> levels{std::shared_ptr<const Field>(base, base->field())};
        std::vector<double> widths;
        for (const CoarserField& c : coarser) {
            levels.push_back(c.field);
            // From four pixels wide, where it begins, to two, where it is all there is: as octaves fade.
            widths.push_back(0.25 * c.width);
        }
        ground.min.z -= coarser.back().width, ground.max.z += coarser.back().width;
        return std::make_shared<DetailField>(std::move(levels), std::move(widths), view);
    }

    std::shared_ptr<const Surface> base_;
    const WarpedSurface* inner_;
    Box3d ground_;
    std::shared_ptr<const DetailField> detail_;  ///< of the base; nullptr: it is as it is everywhere
    WarpedField field_;
    double open_, close_;
    Instances rocks_;
};

std::shared_ptr<const Surface> base_of(const Values& values, const BuildContext& context)
{
    const std::string& name = values.text("base");
    if (!context.base) throw values.problem("base", "there is no other terrain to warp", "the name of a terrain", "\"" + name + "\"");
    std::shared_ptr<const Surface> base = context.base(name, values.where("base"));
    if (!base->field())
        throw values.problem("base", "this terrain cannot be warped: it has no field", "a terrain with one field", "\"" + name + "\"");
    return base;
}

Shape make_warped(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const Surface> base = base_of(values, context);
    const double rate = values.number("intensity_rate"), open = values.number("intensity") + rate * context.shutter[0];
    const double close = values.has("intensity_close") ? values.number("intensity_close") : values.number("intensity") + rate * context.shutter[1];
    if (!(open >= 0.0 && close >= 0.0))
        throw values.problem("intensity_rate", "the intensity of a warp", "at least 0", fmt::format("{:.6g}", std::min(open, close)));
    const double longest = std::max(open, close);
    FlowPtr flow = make_flow(values.tables("flow"), context.seed);
    const auto check_flow = [&] {
        const std::string why_not = Warp::why_not(*flow, longest);
        if (!why_not.empty()) throw values.problem(open >= close ? "intensity" : "intensity_close", why_not, "a weaker or wider flow");
    };
    check_flow();
    std::optional<DetailView> view;
    if (values.boolean("lod") && context.view && context.view->spread > 0.0) {
        view = DetailView{context.view->eye, context.view->spread, Warp(flow, longest).reach(bounds_of(*base))};
        flow = make_flow(values.tables("flow"), context.seed, view, longest);
        check_flow();
    }
    auto surface = std::make_unique<WarpedSurface>(base, Warp(std::move(flow), longest), Interval{open, close}, view);

    PatchSettings settings;
    settings.domain = surface->domain();
    settings.moving = open != close;
    if (values.has("region_min")) settings.domain.min = values.vec3("region_min");
    if (values.has("region_max")) settings.domain.max = values.vec3("region_max");
    for (int k = 0; k < 3; ++k)
        if (!(settings.domain.min[k] < settings.domain.max[k]))
            throw values.problem(values.has("region_max") ? "region_max" : "base", "the region to trace is empty", "min below max");
    const Vec3d size = settings.domain.size();
    settings.size = values.has("patch") ? values.number("patch") : std::max({size.x, size.y, size.z}) / 160.0;
    if (context.view) settings.focus = context.view->eye, settings.growth = values.number("growth");
    read_search(values, settings);
    settings.epsilon_distance = values.number("epsilon_distance");
    if (context.progress) context.progress(0.3, "patches");
    surface->make_patches(settings);
    surface->carry_rocks();
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

}  // namespace

CatalogueEntry warped_row()
{
    Schema schema{"warped", "Any terrain with a field, carried along a flow: overhangs from what had none. Its base is not rendered itself.", {}};
    schema.parameters = {
        {.name = "base", .type = ParameterType::text, .doc = "Name of the terrain that is warped; a warped one too.", .required = true},
        {.name = "flow",
         .type = ParameterType::tables,
         .doc = "Flows; they act together.",
         .required = true,
         .min_count = 1,
         .max_count = 16,
         .discriminator = "kind",
         .items = flow_schemas()},
        {.name = "intensity", .type = ParameterType::number, .doc = "For how long the flow carries the surface.", .fallback = 1.0, .minimum = 0},
        {.name = "intensity_rate",
         .type = ParameterType::number,
         .doc = "How much the intensity grows in a second of the scene's time; while the shutter is open too.",
         .fallback = 0.0,
         .unit = "1/s"},
        {.name = "intensity_close",
         .type = ParameterType::number,
         .doc = "The intensity when the shutter closes; by default what the rate makes of it.",
         .minimum = 0},
        {.name = "patch",
         .type = ParameterType::length,
         .doc = "Side of the boxes that rays are tested against; by default the longest side of the region by 160.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "growth",
         .type = ParameterType::number,
         .doc = "How much larger boxes are a metre of horizontal distance from the eye.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 1},
        {.name = "lod",
         .type = ParameterType::boolean,
         .doc = "Fades out octaves of flows, and takes coarser forms of a base of layers or sampled heights, where a pixel does not resolve them.",
         .fallback = true},
        {.name = "region_min", .type = ParameterType::vector, .doc = "Lower corner of what is traced.", .unit = "m", .min_count = 3, .max_count = 3},
        {.name = "region_max", .type = ParameterType::vector, .doc = "Upper corner of what is traced.", .unit = "m", .min_count = 3, .max_count = 3},
        {.name = "epsilon_distance",
         .type = ParameterType::length,
         .doc = "Paper mode: at this distance from the base's surface (in its field's own measure) the area may be twice as large.",
         .fallback = 1.0,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    for (Parameter& p : search_parameters("the base's surface", 1e-3)) schema.parameters.push_back(std::move(p));
    return {"warped", "Gamito2001", std::move(schema), make_warped};
}

}  // namespace hoodoo
