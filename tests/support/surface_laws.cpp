// The laws of surfaces. What counts as a fault is certified in double precision by means the surface does not use itself.

#include "tests/support/surface_laws.h"

#include "tests/support/numbers.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <sstream>

namespace hoodoo::testing
{
namespace
{

template <class... Parts>
Verdict fault(const Ray& ray, const Parts&... parts)
{
    std::ostringstream out;
    out.precision(17);
    (out << ... << parts);
    out << " (ray from " << ray.origin << " along " << ray.direction << ", t in (" << ray.t_min << ", " << ray.t_max << "))";
    return {out.str()};
}

/// Rounding of a point ray.at(t), metres.
double coordinate_rounding(const Ray& ray, double t)
{
    return 0x1p-49 * (ray.origin.length() + std::abs(t));
}

double size_of(const Surface& surface)
{
    return surface_bounds(surface).size().length();
}

/// Searches [a, b] for a change of side certified by |f| > margin. The slope bound prunes; a piece too short to decide is left undecided.
std::optional<double> certified_change(const Field& field, const Ray& ray, double a, double fa, double b, double fb, double margin, int depth)
{
    const bool sure_a = std::abs(fa) > margin, sure_b = std::abs(fb) > margin;
    if (sure_a && sure_b && (fa < 0.0) != (fb < 0.0) && (ray.crossing == Crossing::any || fb < 0.0)) return a;
    if (depth == 0) return std::nullopt;
    // No zero between, or none of either sign: |f| on the piece is within slope * distance of the ends.
    const double slope = field.slope_bound({ray.at(a), ray.at(b)});
    if (sure_a && sure_b && (fa < 0.0) == (fb < 0.0) && std::abs(fa) + std::abs(fb) > slope * (b - a) + 2.0 * margin) return std::nullopt;
    if (slope * (b - a) + std::max(std::abs(fa), std::abs(fb)) < margin) return std::nullopt;
    const double m = 0.5 * (a + b), fm = field.value(ray.at(m));
    if (const auto left = certified_change(field, ray, a, fa, m, fm, margin, depth - 1)) return left;
    return certified_change(field, ray, m, fm, b, fb, margin, depth - 1);
}

/// The part of a ray that can meet the surface, a little shortened where it enters and leaves its bounds.
std::optional<Interval> inside_bounds(const Surface& surface, const Ray& ray, double share)
{
    Box3d box = surface_bounds(surface);
    const Vec3d rim = box.size() * (0.5 * (1.0 - share));
    box = Box3d(box.min + rim, box.max - rim);
    double t0 = ray.t_min, t1 = ray.t_max;
    for (int k = 0; k < 3; ++k) {
        const double d = ray.direction[k];
        if (d == 0.0) {
            if (ray.origin[k] < box.min[k] || ray.origin[k] > box.max[k]) return std::nullopt;
            continue;
        }
        const double a = (box.min[k] - ray.origin[k]) / d, b = (box.max[k] - ray.origin[k]) / d;
        t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
    }
    const double hair = 1e-6 * box.size().length();
    t0 = t0 > ray.t_min ? t0 + hair : t0, t1 = t1 < ray.t_max ? t1 - hair : t1;
    return t0 < t1 ? std::optional(Interval{t0, t1}) : std::nullopt;
}

/// A change of side before t, by the field or by dense sampling.
std::optional<double> earlier_change(const Surface& surface, const Ray& ray, double t, double margin, double trusted)
{
    const std::optional<Interval> part = inside_bounds(surface, ray, trusted);
    if (!part) return std::nullopt;
    const double a = part->lo, b = std::min(part->hi, t);
    if (!(a < b)) return std::nullopt;
    if (const Field* field = surface.field())
        return certified_change(*field, ray, a, field->value(ray.at(a)), b, field->value(ray.at(b)), margin, 16);
    constexpr int samples = 400;
    bool before = surface.contains(ray.at(a));
    const double hair = 1e-6 * size_of(surface);
    for (int k = 1; k < samples; ++k) {
        const double u = a + (b - hair - a) * k / samples;
        const bool now = surface.contains(ray.at(u));
        if (now != before && (now || ray.crossing == Crossing::any)) return u;
        before = now;
    }
    return std::nullopt;
}

}  // namespace

Verdict bounds_contain_hits(const Surface& surface, const std::vector<Ray>& rays)
{
    for (const Ray& ray : rays) {
        for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile) {
            for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) {
                Hit hit;
                hit.t = ray.t_max;
                if (!surface.intersect({tile, i}, ray, hit)) continue;
                const Vec3d p = ray.at(hit.t);
                const Box3d box = surface.patch_bounds({tile, i});
                const double rounding = coordinate_rounding(ray, hit.t);
                for (int k = 0; k < 3; ++k) {
                    if (!(p[k] >= box.min[k] - rounding && p[k] <= box.max[k] + rounding))
                        return fault(ray, "hit at t ", hit.t, " lies outside the box ", box.min, " to ", box.max);
                }
            }
        }
    }
    return {};
}

Verdict nearest_is_nearest(const Surface& surface, const std::vector<Ray>& rays, double trusted)
{
    const double size = size_of(surface);
    for (const Ray& ray : rays) {
        const Hit hit = nearest_hit(surface, ray);
        // Of the field: a millionth of what it changes by over the surface's size; a graze this shallow may be seen or not.
        double margin = 1e-6;
        if (std::isfinite(hit.t)) {
            if (!(hit.t > ray.t_min && hit.t < ray.t_max)) return fault(ray, "hit at ", hit.t, " outside the interval");
            const Interaction at = surface.interact(ray, hit);
            const double allowed = at.position_error + coordinate_rounding(ray, hit.t);
            if (!((at.position - ray.at(at.t)).length() <= allowed + 1e-9 * size)) return fault(ray, "position is off the ray at ", at.t);
            // With a field, what a graze is worth is decided by the field's value below.
            if (std::abs(at.t - hit.t) > allowed + (surface.field() ? 2e-3 : 1e-7) * size)
                return fault(ray, "hit at ", hit.t, " is not where the interaction is: ", at.t);
            if (const Field* field = surface.field()) {
                const double slope = field->slope_bound({ray.at(hit.t - allowed), ray.at(hit.t + allowed)});
                const double f = field->value(ray.at(hit.t));
                if (!(std::abs(f) <= slope * allowed + 3e-7)) return fault(ray, "false hit at ", hit.t, ": field ", f);
                margin = std::max(margin, 2.0 * slope * allowed);
            }
        }
        if (const auto earlier = earlier_change(surface, ray, hit.t, margin, trusted))
            return fault(ray, "a crossing after ", *earlier, " was missed; reported t ", hit.t);
    }
    return {};
}

Verdict occluded_agrees(const Surface& surface, const std::vector<Ray>& rays)
{
    for (const Ray& ray : rays) {
        for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile) {
            for (std::uint32_t i = 0; i < surface.patch_count(tile); ++i) {
                Hit hit;
                hit.t = ray.t_max;
                const bool met = surface.intersect({tile, i}, ray, hit);
                if (surface.occluded({tile, i}, ray) != met)
                    return fault(ray, "patch ", tile, "/", i, " is ", met ? "met but does not occlude" : "not met but occludes");
            }
        }
    }
    return {};
}

namespace
{

/// The gradient by central differences, unless a kink lies within reach (one-sided differences disagree).
std::optional<Vec3d> difference_normal(const Field& field, const Vec3d& p, double h)
{
    Vec3d g;
    const double f = field.value(p);
    for (int k = 0; k < 3; ++k) {
        Vec3d e(0.0);
        e[k] = h;
        const double up = (field.value(p + e) - f) / h, down = (f - field.value(p - e)) / h;
        if (std::abs(up - down) > 1e-3 * (std::abs(up) + std::abs(down)) + 1e-4 / h * 1e-6) return std::nullopt;
        g[k] = 0.5 * (up + down);
    }
    if (!(g.length() > 0.0)) return std::nullopt;
    return g.normalized();
}

/// Across two neighbouring hits: the way for surfaces without a field.
std::optional<Vec3d> neighbour_normal(const Surface& surface, const Ray& ray, const Interaction& at, double h)
{
    Vec3d u, v;
    orthonormal_frame(ray.direction, u, v);
    std::array<Vec3d, 2> edge;
    for (int k = 0; k < 2; ++k) {
        Ray beside = ray;
        beside.t_max = kInfinity;
        beside.origin += (k == 0 ? u : v) * h;
        const Hit hit = nearest_hit(surface, beside);
        if (!std::isfinite(hit.t)) return std::nullopt;
        edge[static_cast<std::size_t>(k)] = surface.interact(beside, hit).position - at.position;
        if (edge[static_cast<std::size_t>(k)].length() > 30.0 * h) return std::nullopt;
    }
    const Vec3d n = edge[0].cross(edge[1]);
    return n.length() > 0.0 ? std::optional(n.normalized()) : std::nullopt;
}

}  // namespace

Verdict normals_are_gradients(const Surface& surface, const std::vector<Ray>& rays)
{
    const double h = 1e-5 * std::min(1.0, size_of(surface) / 50.0);
    int compared = 0, hits = 0, kinks = 0;
    for (const Ray& ray : rays) {
        const Hit hit = nearest_hit(surface, ray);
        if (!std::isfinite(hit.t)) continue;
        ++hits;
        const Interaction at = surface.interact(ray, hit);
        for (const Vec3d& n : {at.geometric_normal, at.shading_normal})
            if (!(std::abs(n.length() - 1.0) < 1e-9)) return fault(ray, "normal of length ", n.length());
        if (at.geometric_normal.dot(at.shading_normal) < 0.0) return fault(ray, "shading normal on the other side");
        double sum = 0.0;
        for (std::size_t m = 0; m < at.materials.count; ++m) {
            if (!(at.materials.weight[m] >= 0.0f) || at.materials.index[m] >= surface.materials().size())
                return fault(ray, "material share of ", at.materials.weight[m]);
            sum += at.materials.weight[m];
        }
        if (!(std::abs(sum - 1.0) < 1e-5)) return fault(ray, "material shares sum to ", sum);
        if (!(at.spawn_offset > 0.0) || !is_finite(at.position + at.texture_point)) return fault(ray, "no spawn offset or no position");

        const Field* field = surface.field();
        const std::optional<Vec3d> n = field ? difference_normal(*field, at.position, h) : neighbour_normal(surface, ray, at, h);
        if (!n) continue;
        ++compared;
        const double agreement = field ? n->dot(at.geometric_normal) : std::abs(n->dot(at.geometric_normal));
        // One in fifty may straddle a kink that the differences did not see.
        if (agreement < 1.0 - 1e-4 && ++kinks > 1 + compared / 50) return fault(ray, "normal ", at.geometric_normal, " but the surface's is ", *n);
    }
    if (compared * 4 < hits) return {"too few normals could be compared"};
    return {};
}

Verdict spawned_rays_leave(const Surface& surface, const std::vector<Ray>& rays)
{
    std::uint64_t n = 0;
    for (const Ray& ray : rays) {
        const Hit hit = nearest_hit(surface, ray);
        if (!std::isfinite(hit.t)) continue;
        const Interaction at = surface.interact(ray, hit);
        Numbers random(99, ++n);
        for (int k = 0; k < 4; ++k) {
            Ray spawned;
            spawned.crossing = Crossing::entering;
            spawned.origin = at.position + at.geometric_normal * at.spawn_offset;
            spawned.direction = random.direction();
            if (spawned.direction.dot(at.geometric_normal) < 0.0) spawned.direction = -spawned.direction;
            // Every other one grazes.
            if (k % 2) {
                const Vec3d flat = spawned.direction - at.geometric_normal * spawned.direction.dot(at.geometric_normal);
                if (flat.length() > 0.1) spawned.direction = (flat.normalized() + at.geometric_normal * 1e-3).normalized();
            }
            const Hit again = nearest_hit(surface, spawned);
            if (again.t <= 4.0 * at.spawn_offset) return fault(spawned, "left a hit and met it again at ", again.t, ", offset ", at.spawn_offset);
        }
    }
    return {};
}

Verdict translation_moves_hits(const Surface& surface, const Surface& moved, const Vec3d& shift, const std::vector<Ray>& rays)
{
    const double size = size_of(surface);
    int grazes = 0, hits = 0;
    for (const Ray& ray : rays) {
        Ray there = ray;
        there.origin += shift;
        const double a = nearest_hit(surface, ray).t, b = nearest_hit(moved, there).t;
        if (std::isfinite(a)) ++hits;
        // Rounding of the shifted origin, which a slanted surface magnifies.
        const double tolerance = 1e-7 * size + 1e3 * 0x1p-52 * shift.length();
        if ((std::isfinite(a) == std::isfinite(b)) && (!std::isfinite(a) || std::abs(a - b) <= tolerance)) continue;
        // A tangent ray may be on either side of the surface by rounding alone.
        if (++grazes > 2 + static_cast<int>(rays.size()) / 50) return fault(ray, "hit at ", a, ", moved by ", shift, " at ", b);
    }
    if (hits == 0) return {"no ray hit"};
    return {};
}

Verdict same_bits(const Surface& a, const Surface& b, const std::vector<Ray>& rays)
{
    for (const Ray& ray : rays) {
        const Hit x = nearest_hit(a, ray), y = nearest_hit(b, ray);
        if (std::memcmp(&x.t, &y.t, sizeof x.t) != 0 || x.evaluations != y.evaluations) return fault(ray, "hits at ", x.t, " and ", y.t);
        if (!std::isfinite(x.t)) continue;
        const Interaction p = a.interact(ray, x), q = b.interact(ray, y);
        if (p.position != q.position || p.shading_normal != q.shading_normal || p.spawn_offset != q.spawn_offset)
            return fault(ray, "interactions differ at ", x.t);
    }
    return {};
}

Verdict closed_leaks_none(const Surface& surface, std::uint64_t seed, int count)
{
    if (!surface.closed()) return {};
    const Box3d box = surface_bounds(surface);
    int inside = 0;
    for (int n = 0; n < count; ++n) {
        Numbers random(seed, static_cast<std::uint64_t>(n));
        Ray ray;
        ray.origin = random.in(box);
        ray.direction = random.direction();
        const Field* field = surface.field();
        if (field ? !(field->value(ray.origin) < -1e-6) : !surface.contains(ray.origin)) continue;
        ++inside;
        if (!std::isfinite(nearest_hit(surface, ray).t)) return fault(ray, "escaped from inside");
    }
    if (inside * 50 < count) return {"too few rays began inside"};
    return {};
}

Verdict field_bounds_hold(const Field& field, const Box3d& where, std::uint64_t seed, int count)
{
    const double size = where.size().length();
    for (int n = 0; n < count; ++n) {
        Numbers random(seed, static_cast<std::uint64_t>(n));
        const Vec3d p = random.in(where);
        const double length = size * std::pow(10.0, -5.0 * random());
        const Segment segment{p, p + random.direction() * length};
        const double bound = field.slope_bound(segment);
        for (int k = 0; k < 16; ++k) {
            const double u = random(), v = random();
            const Vec3d a = segment.a + (segment.b - segment.a) * u, b = segment.a + (segment.b - segment.a) * v;
            const double rise = std::abs(field.value(a) - field.value(b));
            if (rise > bound * (a - b).length() + 1e-10)
                return fault({segment.a, segment.b - segment.a}, "slope ", rise / (a - b).length(), " above its bound ", bound);
        }
        Box3d box(p);
        box.extendBy(p + Vec3d(random() * length, random() * length, random() * length));
        const Interval range = field.range(box);
        for (int k = 0; k < 16; ++k) {
            const double f = field.value(random.in(box));
            if (f < range.lo - 1e-10 || f > range.hi + 1e-10)
                return fault({box.min, box.size()}, "value ", f, " outside its range ", range.lo, " to ", range.hi);
        }
    }
    return {};
}

}  // namespace hoodoo::testing
