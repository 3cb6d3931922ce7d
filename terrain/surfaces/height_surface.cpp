// F(p) = z - h(x, y), met in patches with proved bounds (march/field_patches.h): what any height needs to be traced.
// GalinCourse; a ray's second derivative of F is at most K c^2, K the height's curvature and c the horizontal share of the direction. Patches grow
// with the distance from the eye, so that a plain to the horizon costs no more than a few rings of them. Deviation: what is traced is a square about
// the eye.
#include "terrain/surfaces/height_surface.h"

#include "terrain/catalogue.h"
#include "terrain/surfaces/marched_surface.h"

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

class HeightSurface final : public MarchedSurface
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
        patches.accuracy = 1e-8 * settings.patch;
        patches.flat = 1e-9 * settings.patch;
        make_patches(patches);
        set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = crossing_at(ray, hit, settings().accuracy);
        at.geometric_normal = field_.gradient(at.position).normalized();
        at.spawn_offset = air_above(at, ray.time);
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
        info.trace_bytes = settings_.stored_bytes;
        add_patches(info);
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
