// F(p) = z - h(x, y), met in patches with proved bounds (march/field_patches.h): what any height needs to be traced.
// GalinCourse; a ray's second derivative of F is at most K c^2, K the height's curvature and c the horizontal share of the direction. Patches grow
// with the distance from the eye, so that a plain to the horizon costs no more than a few rings of them. Deviation: what is traced is a square about
// the eye.
#include "terrain/surfaces/height_surface.h"

#include "terrain/catalogue.h"

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

class HeightSurface final : public Surface, private MarchedField
{
public:
    HeightSurface(std::unique_ptr<const Height> height, const HeightSurfaceSettings& settings)
        : height_(std::move(height)), field_(*height_), settings_(settings)
    {
        const auto start = std::chrono::steady_clock::now();
        PatchSettings patches;
        const Interval range = height_->range(settings.area);
        const double pad = 1e-6 * (1.0 + range.hi - range.lo);
        patches.domain = {Vec3d(settings.area.min.x, settings.area.min.y, range.lo - pad),
                          Vec3d(settings.area.max.x, settings.area.max.y, range.hi + pad)};
        patches.size = settings.patch;
        patches.growth = settings.growth;
        patches.focus = Vec3d(settings.focus.x, settings.focus.y, 0.0);
        patches.accuracy = accuracy_ = 1e-8 * settings.patch;
        patches.flat = flat_ = 1e-9 * settings.patch;
        patches_ = make_field_patches(*this, patches);
        build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    std::uint32_t tile_count() const override { return patches_->tile_count(); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return patches_->patch_count(tile); }
    Box3d patch_bounds(PatchId patch) const override { return patches_->patch_bounds(patch); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return patches_->intersect(patch, ray, hit); }
    bool occluded(PatchId patch, const Ray& ray) const override { return patches_->occluded(patch, ray); }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at;
        at.t = hit.t;
        at.position = ray.at(hit.t);
        const double size = std::abs(ray.origin.x) + std::abs(ray.origin.y) + std::abs(ray.origin.z) + hit.t;
        at.position_error = accuracy_ + 64.0 * 0x1p-52 * size;
        at.geometric_normal = field_.gradient(at.position).normalized();
        at.spawn_offset = 2.0 * at.position_error;
        while (at.spawn_offset < settings_.patch && !(field_.value(at.position + at.geometric_normal * at.spawn_offset) > 2.0 * flat_))
            at.spawn_offset *= 2.0;
        dress(at);
        return at;
    }

    void dress(Interaction& at) const override
    {
        at.shading_normal = at.geometric_normal;
        at.texture_point = at.position;
        at.uv = Vec2d(at.position.x, at.position.y) * (1.0 / settings_.texture);
        at.materials.add(0, 1.0f);
    }

    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0; }
    std::vector<std::string> materials() const override { return {settings_.material}; }
    bool closed() const override { return false; }
    const Field* field() const override { return &field_; }
    const Height* height() const override { return height_.get(); }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.trace_bytes = patches_->memory_bytes() + settings_.stored_bytes;
        for (std::uint32_t t = 0; t < patches_->tile_count(); ++t) info.patches += patches_->patch_count(t);
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    double value(const Vec3d& p, double) const override { return field_.value(p); }
    LocalField local(const Box3d& box) const override
    {
        const HeightBounds bounds = height_->bounds(area_under(box));
        LocalField known;
        const double rounding = 0x1p-50 * (std::max(std::abs(box.min.z), std::abs(box.max.z)) + bounds.value.magnitude());
        known.value = {box.min.z - bounds.value.hi - rounding, box.max.z - bounds.value.lo + rounding};
        known.centre = field_.value(box.center());
        known.gradient = {-bounds.gradient[0], -bounds.gradient[1], Interval{1.0, 1.0}};
        known.curvature = bounds.curvature;
        known.mixed = 0.0;
        known.upright = std::isfinite(known.curvature) ? 0.0 : kInfinity;
        return known;
    }
    bool exists(const Vec3d&, double) const override { return true; }
    Vec3d inverse(const Vec3d& p, double) const override { return p; }
    double base_value(const Vec3d& q) const override { return field_.value(q); }

    std::unique_ptr<const Height> height_;
    HeightAsField field_;
    HeightSurfaceSettings settings_;
    double accuracy_ = 0.0, flat_ = 0.0, build_seconds_ = 0.0;
    std::unique_ptr<const FieldIntersector> patches_;
};

}  // namespace

std::unique_ptr<Surface> make_height_surface(std::unique_ptr<const Height> height, const HeightSurfaceSettings& settings)
{
    return std::make_unique<HeightSurface>(std::move(height), settings);
}

std::vector<Parameter> height_surface_parameters(double extent)
{
    return {
        {.name = "centre",
         .type = ParameterType::vector,
         .doc = "Middle (x, y) of what is traced; by default below the eye.",
         .unit = "m",
         .min_count = 2,
         .max_count = 2},
        {.name = "extent",
         .type = ParameterType::length,
         .doc = "Half the side of the square that is traced.",
         .fallback = extent,
         .unit = "m",
         .minimum = 0,
         .maximum = 1e7,
         .above_minimum = true},
        {.name = "patch",
         .type = ParameterType::length,
         .doc = "Side of the boxes that rays are tested against, near the centre.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "growth",
         .type = ParameterType::number,
         .doc = "How much larger boxes are a metre of distance from the centre.",
         .fallback = 0.02,
         .minimum = 0,
         .maximum = 1},
        {.name = "material", .type = ParameterType::text, .doc = "Its material.", .fallback = std::string("ground")},
    };
}

HeightSurfaceSettings read_height_surface(const Values& values, const Viewpoint* view, const Vec2d& middle, double usual)
{
    HeightSurfaceSettings settings;
    settings.focus = values.has("centre") ? values.vec2("centre") : view ? Vec2d(view->eye.x, view->eye.y) : middle;
    const Vec2d reach(values.number("extent"));
    settings.area = {settings.focus - reach, settings.focus + reach};
    settings.patch = values.has("patch") ? values.number("patch") : usual;
    settings.growth = values.number("growth");
    settings.material = values.text("material");
    return settings;
}

}  // namespace hoodoo
