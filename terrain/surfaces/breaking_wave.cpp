// A sea on which waves break: one implicit function of space and time to the horizon, in patches with proved boxes (march/field_patches.h).
// Gamito2001, section 4.2; fields/breaking_sea.h has the function, fields/foam.h what is white. The hit is the certified one of the whole function,
// so that there is no seam between wave, swell and the flat sea far out. The normal is the exact gradient; the velocity the surface's own, across
// itself: -dF/dt grad F / |grad F|^2. uv and texture point are those of the water at rest (u across the crest, v along it, metres), so that what is
// painted on it follows it down. Ripples bend the shading normal by the relief of the rest place, J^T grad b (Mikkelsen2020's surface gradient); what
// the footprint hides becomes slope variance. The water has no ground: rays downwards never leave it, so it is not closed; whoever wants one puts a
// terrain below. Time is Ray::time between the shutter's ends. Missing: the paper's area test (its mode is the canyon's and the warp's).
#include "terrain/error.h"
#include "terrain/field.h"
#include "terrain/surfaces/marched_surface.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"
#include "terrain/surfaces/sea_parameters.h"

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

/// A box in the sea's coordinates, wider by what the subtraction rounds.
Box3d sea_box(const Box3d& box, const Vec3d& origin)
{
    Box3d out;
    for (int k = 0; k < 3; ++k) {
        const double lo = box.min[k] - origin[k], hi = box.max[k] - origin[k];
        out.min[k] = lo - 0x1p-52 * std::abs(lo);
        out.max[k] = hi + 0x1p-52 * std::abs(hi);
    }
    return out;
}

/// The sea at one time, in the world's coordinates.
class SeaField final : public Field
{
public:
    SeaField(const BreakingSea& sea, const Vec3d& origin, double seconds) : sea_(sea), origin_(origin), seconds_(seconds) {}

    double value(const Vec3d& p) const override { return sea_.value(p - origin_, seconds_); }
    Vec3d gradient(const Vec3d& p) const override { return sea_.gradient(p - origin_, seconds_); }
    double slope_bound(const Segment& segment) const override
    {
        Box3d box(segment.a);
        box.extendBy(segment.b);
        const Vec3d along = segment.b - segment.a;
        const double length = along.length();
        const LocalField known = local(box);
        return length > 0.0 ? std::min(known.slope(), known.slope_along(along / length)) : known.slope();
    }
    Interval range(const Box3d& box) const override { return local(box).value; }
    Box3d bounds() const override { return {Vec3d(-kInfinity), Vec3d(kInfinity, kInfinity, origin_.z + sea_.heights().hi)}; }
    std::array<Interval, 3> gradient_range(const Box3d& box) const override { return local(box).gradient; }
    double curvature_bound(const Box3d& box) const override { return local(box).curvature; }

private:
    LocalField local(const Box3d& box) const { return sea_.local(sea_box(box, origin_), {seconds_, seconds_}); }

    const BreakingSea& sea_;
    Vec3d origin_;
    double seconds_;
};

class BreakingWave final : public MarchedSurface
{
public:
    BreakingWave(const SeaDescription& d, const Vec3d& origin, double open, double close)
        : sea_(d.breakers, d.swell, 0.0),
          origin_(origin),
          open_(open),
          close_(close),
          ripples_(d.ripples),
          field_(sea_, origin, open),
          foam_(sea_, d.foam, origin, open, close),
          sprays_(d.foam.spray > 0.0 && !d.breakers.empty())
    {
    }

    Interval heights() const { return sea_.heights(); }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = crossing_at(ray, hit, settings().accuracy);
        const double t = seconds(ray.time);
        double by_time = 0.0;
        Vec3d slope = sea_.gradient(at.position - origin_, t, &by_time);
        if (!(slope.length() > 1e-9)) slope = Vec3d(0.0, 0.0, 1.0);
        at.geometric_normal = slope.normalized();
        at.velocity = slope * (-by_time / slope.length2() * (close_ - open_));
        // A pixel covers more of water seen at a slant; ten times its width at most.
        const double slant = std::max(0.1, std::abs(at.geometric_normal.dot(ray.direction)));
        wear(t, ray.footprint(hit.t) / slant, at);
        at.spawn_offset = air_above(at, ray.time);
        return at;
    }

    void dress(Interaction& at) const override { wear(open_, 0.0, at); }
    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0; }
    std::vector<std::string> materials() const override { return {"water", "foam"}; }
    bool closed() const override { return false; }
    const Field* field() const override { return &field_; }
    const Density* density() const override { return sprays_ ? &foam_ : nullptr; }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        add_patches(info);
        return info;
    }

private:
    double seconds(double time) const { return open_ + (close_ - open_) * time; }

    double value(const Vec3d& p, double time) const override { return sea_.value(p - origin_, seconds(time)); }
    bool batched() const override { return true; }
    void values(const Vec3d (&p)[batch], int count, double time, double* out) const override
    {
        Vec3d q[batch];
        double all[batch];
        for (int i = 0; i < batch; ++i) q[i] = p[std::min(i, count - 1)] - origin_;
        sea_.values(q, seconds(time), all);
        std::copy_n(all, count, out);
    }
    LocalField local(const Box3d& box) const override { return sea_.local(sea_box(box, origin_), {open_, close_}); }
    bool exists(const Vec3d&, double) const override { return true; }
    bool exists_throughout(const Box3d&) const override { return true; }
    Vec3d inverse(const Vec3d& p, double time) const override { return sea_.rest(p - origin_, seconds(time)).point; }
    double base_value(const Vec3d& q) const override { return q.z; }

    /// Ripples, foam and coordinates for the geometric normal and the place that `at` has.
    void wear(double t, double footprint, Interaction& at) const
    {
        const Vec3d p = at.position - origin_, &n = at.geometric_normal;
        const SeaRest rest = sea_.rest(p, t);
        at.texture_point = origin_ + rest.point;
        at.uv = Vec2d(rest.point.x, rest.point.y);

        // Where the water is drawn together its ripples are finer than they were.
        const double denser = std::max({rest.gradient[0].length(), rest.gradient[1].length(), rest.gradient[2].length()});
        const RippleSlope ripple = ripple_slope(ripples_, rest.point, t, footprint * denser);
        Vec3d relief(0.0);
        for (int k = 0; k < 3; ++k) relief += rest.gradient[k] * ripple.gradient[k];
        relief -= n * n.dot(relief);
        at.shading_normal = into_hemisphere((n - relief).normalized(), n);
        at.slope_variance = ripple.lost_variance;

        const auto foam = static_cast<float>(std::clamp(foam_.cover(p, rest.point, t, footprint), 0.0, 1.0));
        if (foam < 1.0f) at.materials.add(0, 1.0f - foam);
        if (foam > 0.0f) at.materials.add(1, foam);
    }

    BreakingSea sea_;
    Vec3d origin_;
    double open_, close_;
    RippleShape ripples_;
    SeaField field_;
    SeaFoam foam_;
    bool sprays_;
};

Shape make_breaking_wave(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    const SeaDescription sea = read_sea(values, context.seed);
    const Vec3d origin = values.vec3("origin");
    const double moment = values.number("time"), open = moment + context.shutter[0], close = moment + context.shutter[1];
    auto surface = std::make_unique<BreakingWave>(sea, origin, open, close);

    PatchSettings settings;
    const double extent = values.number("extent");
    const Interval heights = surface->heights();
    settings.domain = Box3d(origin + Vec3d(-extent, -extent, heights.lo - 0.01), origin + Vec3d(extent, extent, heights.hi + 0.01));
    double least = kInfinity;
    for (const Breaker& b : sea.breakers) least = std::min(least, b.shape.core);
    settings.size = values.has("patch") ? values.number("patch") : std::isfinite(least) ? least / 4.0 : extent / 64.0;
    settings.focus = values.has("centre") ? values.vec3("centre") : context.view ? context.view->eye : origin;
    settings.growth = values.number("growth");
    settings.moving = open != close;
    if (context.progress) context.progress(0.1, "patches");
    surface->make_patches(settings);
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

}  // namespace

CatalogueEntry breaking_wave_row()
{
    Schema schema{"breaking_wave", "A sea to the horizon with waves that curl, throw, fall and run on as white water.", {}};
    const auto place = [](const std::string& name, const std::string& doc) {
        return Parameter{.name = name, .type = ParameterType::vector, .doc = doc, .unit = "m", .min_count = 3, .max_count = 3};
    };
    Parameter origin = place("origin", "Where waves and swell are told from; its height is the sea's at rest.");
    origin.fallback = std::vector<double>{0, 0, 0};
    schema.parameters.push_back(origin);
    schema.parameters.push_back({.name = "time",
                                 .type = ParameterType::duration,
                                 .doc = "Seconds of the sea's time when the scene's time is 0: which moment a still shows.",
                                 .fallback = 0.0,
                                 .unit = "s"});
    for (Parameter& p : sea_parameters()) schema.parameters.push_back(std::move(p));
    schema.parameters.push_back({.name = "extent",
                                 .type = ParameterType::length,
                                 .doc = "Half the side of the square of sea that is traced.",
                                 .fallback = 20000.0,
                                 .unit = "m",
                                 .minimum = 1,
                                 .maximum = 1e6});
    schema.parameters.push_back(place("centre", "Where patches are smallest; by default the eye."));
    schema.parameters.push_back({.name = "patch",
                                 .type = ParameterType::length,
                                 .doc = "Side of the boxes that rays are tested against, near the centre; by default a quarter of the smallest core.",
                                 .unit = "m",
                                 .minimum = 0,
                                 .above_minimum = true});
    schema.parameters.push_back({.name = "growth",
                                 .type = ParameterType::number,
                                 .doc = "How much larger boxes are a metre of distance from the centre.",
                                 .fallback = 0.02,
                                 .minimum = 0,
                                 .maximum = 1});
    return {"breaking_wave", "Gamito2001", std::move(schema), make_breaking_wave};
}

}  // namespace hoodoo
