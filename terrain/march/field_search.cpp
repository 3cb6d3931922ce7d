// Cheapest first: where the patch's quadratic proves a sign the field is not asked; where the field rises or falls all the way, its one root is
// pinned down by interval Newton steps from the quadratic's root; elsewhere the stretch is searched by first_crossing.h. In the paper's mode its area
// test takes the place of all that.
#include "terrain/march/field_search.h"

#include "terrain/march/area_march.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

bool clip(const Box3d& box, const Ray& ray, double& a, double& b)
{
    for (int k = 0; k < 3; ++k) {
        const double d = ray.direction[k], o = ray.origin[k];
        if (d == 0.0) {
            if (o < box.min[k] || o > box.max[k]) return false;
            continue;
        }
        const double inverse = 1.0 / d, t0 = (box.min[k] - o) * inverse, t1 = (box.max[k] - o) * inverse;
        a = std::max(a, std::min(t0, t1));
        b = std::min(b, std::max(t0, t1));
    }
    return a < b && b < kInfinity;
}

/// Air for certain, and further on rock for certain (either way round unless `entering`): no field need be asked where in between it begins.
bool plainly_crosses(const SignedPiece* pieces, int count, bool entering)
{
    int before = 0;
    for (int i = 0; i < count; ++i) {
        if (pieces[i].sign == 0) continue;
        if (before != 0 && before != pieces[i].sign && (!entering || before > 0)) return true;
        before = pieces[i].sign;
    }
    return false;
}

/// Many values along a ray.
auto values_along(const MarchedField& field, const Ray& ray)
{
    return [&field, &ray](const double* s, double* out) {
        Vec3d p[MarchedField::batch];
        for (int i = 0; i < MarchedField::batch; ++i) p[i] = ray.at(s[i]);
        field.values(p, MarchedField::batch, ray.time, out);
    };
}

}  // namespace

Interval FieldPatch::rise_along(const Vec3d& direction) const
{
    Interval sum{0.0, 0.0};
    for (int k = 0; k < 3; ++k)
        if (direction[k] != 0.0) sum = sum + Interval{least[k], most[k]}.scaled(direction[k]);
    return sum;
}

bool FieldSearch::first(const FieldPatch& patch, const Box3d& box, const Ray& ray, double limit, bool any, double& t,
                        std::uint32_t& evaluations) const
{
    // The whole of the box, whatever was found before: a crossing must not depend on the order in which boxes are met.
    double a = ray.t_min, b = ray.t_max;
    if (!clip(box, ray, a, b) || a >= limit) return false;
    if (settings_.mode == MarchMode::paper) return paper(ray, a, b, t, evaluations) && t > ray.t_min && t < limit;

    const Interval rise = patch.rise_along(ray.direction);
    const bool entering = ray.crossing == Crossing::entering, one_way = rise.lo > 0.0 || rise.hi < 0.0;
    if (entering && rise.lo >= 0.0) return false;
    SignedPiece pieces[5] = {{0.0, b - a, 0}};
    int count = 1;
    const bool modelled = std::isfinite(patch.model.error);
    // Without a quadratic a straight line that is zero half-way stands for it.
    const ModelAlong model = modelled ? patch.model.along(ray.at(a) - box.center(), ray.direction) : ModelAlong{-0.5 * (b - a), 1.0, 0.0};
    if (modelled) count = signed_pieces(model, patch.model.error, b - a, pieces);
    any = any && patch.everywhere;
    if (any && plainly_crosses(pieces, count, entering)) return true;
    for (int i = 0; i < count; ++i) {
        if (pieces[i].sign != 0) continue;
        if (a + pieces[i].from >= limit) return false;
        // A little wider, for the rounding of where pieces end.
        const double hair = 0x1p-44 * (std::abs(a) + std::abs(b));
        const double from = std::max(a, a + pieces[i].from - hair), to = std::min(b, a + pieces[i].to + hair);
        if (!(from < to)) continue;
        bool found = false;
        if (one_way) {
            const double middle = 0.5 * (pieces[i].from + pieces[i].to), slope = model.b + 2.0 * model.c * middle;
            found = pinned(patch, ray, {from, to, rise, patch.bend_along(ray.direction), a + middle - model.at(middle) / slope, slope}, any, t,
                           evaluations);
        } else {
            found = certified(patch, ray, from, to, any, t, evaluations);
        }
        if (found) return any || (t > ray.t_min && t < limit);
    }
    return false;
}

/// Where the field has one root at most: whether that lies in the stretch, and the surface exists there.
bool FieldSearch::pinned(const FieldPatch& patch, const Ray& ray, const PinnedRoot& root, bool any, double& t, std::uint32_t& evaluations) const
{
    const double accuracy = accuracy_at(root.from, root.to);
    bool found = false;
    if (field_.batched()) {
        found = pinned_root<MarchedField::batch>(values_along(field_, ray), root, any, accuracy, t, evaluations);
    } else {
        const auto one = [&](const double* s, double* out) { *out = field_.value(ray.at(*s), ray.time); };
        found = pinned_root<1>(one, root, any, accuracy, t, evaluations);
    }
    return found && (patch.everywhere || field_.exists(ray.at(t), ray.time));
}

/// The first crossing in the stretch that exists; if `any`, whether there is one: then all of them exist.
bool FieldSearch::certified(const FieldPatch& patch, const Ray& ray, double a, double b, bool any, double& t, std::uint32_t& evaluations) const
{
    const PieceBound bound{patch.rise_along(ray.direction).magnitude(), patch.bend_along(ray.direction)};
    const auto closer = [&](double from, double to) {
        Box3d box(ray.at(from));
        box.extendBy(ray.at(to));
        const LocalField known = field_.local(Box3d(box.min - Vec3d(rounding_), box.max + Vec3d(rounding_)));
        return PieceBound{known.slope_along(ray.direction), known.curvature_along(ray.direction)};
    };
    const auto one = [&](double s) { return field_.value(ray.at(s), ray.time); };
    const CrossingQuery query{ray.crossing == Crossing::entering, any, settings_.flat, accuracy_at(a, b)};
    while (a < b) {
        bool found = false;
        if (field_.batched()) {
            found = first_crossing_batched<MarchedField::batch>(values_along(field_, ray), closer, a, b, query, bound, t, evaluations);
        } else {
            evaluations += 2;
            found = first_crossing(one, closer, {a, one(a), b, one(b)}, query, bound, t, evaluations);
        }
        if (!found) return false;
        if (patch.everywhere || field_.exists(ray.at(t), ray.time)) return true;
        a = t + query.accuracy;
    }
    return false;
}

bool FieldSearch::paper(const Ray& ray, double a, double b, double& t, std::uint32_t& evaluations) const
{
    const auto place = [&](double s) { return field_.inverse(ray.at(s), ray.time); };
    const auto base = [&](const Vec3d& q) { return field_.base_value(q); };
    const AreaSettings area{settings_.epsilon, settings_.epsilon_distance, 20};
    const bool entering = ray.crossing == Crossing::entering;
    while (area_march(place, base, a, b, entering, area, t, evaluations)) {
        if (field_.exists(ray.at(t), ray.time)) return true;
        a = std::nextafter(t, kInfinity);
        if (!(a < b)) return false;
    }
    return false;
}

}  // namespace hoodoo
