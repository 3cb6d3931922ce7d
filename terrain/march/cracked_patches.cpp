// A ray over cracked ground is cut where it enters and leaves cracks; on each stretch one continuous height is met, and where two stretches disagree
// about the side there is a wall.
// The cuts are quotients of two numbers (fields/crack_network.h), the same for every patch that the ray crosses, so a wall is met at one place to the
// last bit and its normal is that of the border it belongs to. On a stretch (of a crack: between the
// elevations where its floor's formula changes) the search is that of first_crossing.h, with bounds of the ground's slope
// and curvature over the patch, and closer ones where these do not decide. A patch is one rectangle of the region, as high as the heights over it:
// from the floor of the deepest crack that may be in it to the highest ground. Rectangles overlap by a hair, so that what happens on their common
// side lies well inside one of them. Missing: triangles of a height map are met as any other height, not by their planes.
#include "terrain/march/cracked_patches.h"

#include "terrain/error.h"
#include "terrain/march/first_crossing.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

float above(double x)
{
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}
float below(double x)
{
    return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

bool clip(const Box3d& box, const Ray& ray, double& a, double& b)
{
    for (int k = 0; k < 3; ++k) {
        const double d = ray.direction[k], o = ray.origin[k];
        if (d == 0.0) {
            if (o < box.min[k] || o > box.max[k]) return false;
            continue;
        }
        const double t0 = (box.min[k] - o) / d, t1 = (box.max[k] - o) / d;
        a = std::max(a, std::min(t0, t1));
        b = std::min(b, std::max(t0, t1));
    }
    return a < b && b < kInfinity;
}

}  // namespace

CrackedPatches::CrackedPatches(const CrackedField& field, const CrackedPatchSettings& settings) : field_(field)
{
    const Box2d region = field.region();
    const Vec2d size = region.size();
    const double far = std::max({std::abs(region.min.x), std::abs(region.min.y), std::abs(region.max.x), std::abs(region.max.y),
                                 std::abs(field.zero()), std::abs(field.one())});
    rounding_ = 0x1p-50 * far;
    hair_ = 1e-7 * settings.size + 8.0 * rounding_;
    accuracy_ = std::max(settings.accuracy, 4.0 * rounding_);
    base_ = field.zero();
    const double nx = std::ceil(size.x / settings.size), ny = std::ceil(size.y / settings.size);
    if (nx * ny > 16777216.0)
        throw Error(ErrorKind::memory, fmt::format("the cracked ground needs {:.0f} patches of {:.4g} m, more than 16777216: ask for larger ones",
                                                   nx * ny, settings.size));
    nx_ = std::max(1, static_cast<int>(nx));
    ny_ = std::max(1, static_cast<int>(ny));
    patches_.resize(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
    tbb::parallel_for(0, ny_, [&](int j) {
        for (int i = 0; i < nx_; ++i) {
            const auto index = static_cast<std::uint32_t>(j * nx_ + i);
            patches_[index] = measure(area(index));
        }
    });
}

Box2d CrackedPatches::area(std::uint32_t index) const
{
    const Box2d region = field_.region();
    const Vec2d size = region.size();
    const int i = static_cast<int>(index) % nx_, j = static_cast<int>(index) / nx_;
    const auto corner = [&](int x, int y) { return region.min + Vec2d(size.x * x / nx_, size.y * y / ny_); };
    const Vec2d hair(hair_);
    return {corner(i, j) - hair, corner(i + 1, j + 1) + hair};
}

CrackedPatches::Patch CrackedPatches::measure(const Box2d& area) const
{
    // Of quarters, because bounds of heights get better faster than areas get smaller.
    Interval z{kInfinity, -kInfinity};
    const Vec2d middle = (area.min + area.max) * 0.5;
    for (int quarter = 0; quarter < 4; ++quarter) {
        Box2d part = area;
        (quarter & 1 ? part.min.x : part.max.x) = middle.x;
        (quarter & 2 ? part.min.y : part.max.y) = middle.y;
        const Interval h = field_.ground().range(part);
        const Interval d = field_.network().distance_range({field_.local(part.min), field_.local(part.max)});
        const bool torn = d.lo <= 0.5 * field_.network().width(), whole = d.hi > 0.5 * field_.network().width();
        z = Interval::hull(z, {torn ? field_.floor(h.lo) : h.lo, whole ? h.hi : field_.floor(h.hi)});
    }
    return {below(z.lo - hair_ - base_), above(z.hi + hair_ - base_), above(field_.ground().slope_bound(area)),
            above(field_.ground().curvature_bound(area))};
}

Box3d CrackedPatches::patch_bounds(std::uint32_t index) const
{
    const Box2d a = area(index);
    const Patch& p = patches_[index];
    return {Vec3d(a.min.x, a.min.y, base_ + p.lo), Vec3d(a.max.x, a.max.y, base_ + p.hi)};
}

bool CrackedPatches::intersect(std::uint32_t index, const Ray& ray, Hit& hit) const
{
    // The whole of the box, whatever was found before: a crossing must not depend on the order in which boxes are met.
    double a = ray.t_min, b = ray.t_max;
    if (!clip(patch_bounds(index), ray, a, b) || a >= hit.t) return false;
    const Patch& patch = patches_[index];
    const Vec2d origin = field_.local({ray.origin.x, ray.origin.y}), direction(ray.direction.x, ray.direction.y);
    bool found = false, was_inside = false;
    double t = 0.0;
    field_.network().for_each_piece(origin, direction, a, b, [&](const CrackNetwork::Piece& piece) {
        const auto inside = [&](double s) {
            const Vec3d p = ray.at(s);
            return field_.lifted(p.z, piece.cracked) < field_.ground().height({p.x, p.y});
        };
        if (piece.wall && inside(piece.from) != was_inside && (ray.crossing == Crossing::any || !was_inside)) {
            t = piece.from;
            found = true;
        } else {
            found = search(patch, ray, piece, t, hit.evaluations);
        }
        was_inside = inside(piece.to);
        hit.evaluations += 2;
        return !found && piece.to < hit.t;
    });
    if (!found || !(t > ray.t_min && t < hit.t)) return false;
    hit.t = t;
    hit.patch = {0, index};
    return true;
}

bool CrackedPatches::search(const Patch& patch, const Ray& ray, const CrackNetwork::Piece& piece, double& t, std::uint32_t& evaluations) const
{
    if (!piece.cracked) return search_smooth(patch, ray, piece, t, evaluations);
    // Cut at the elevations where the floor's formula changes: between them it has a second derivative, without which a grazing ray takes for ever.
    std::array<double, 3> cuts = field_.kinks();
    for (double& cut : cuts) cut = ray.direction.z != 0.0 ? std::clamp((cut - ray.origin.z) / ray.direction.z, piece.from, piece.to) : piece.to;
    if (ray.direction.z < 0.0) std::swap(cuts[0], cuts[2]);
    CrackNetwork::Piece part = piece;
    for (const double cut : {cuts[0], cuts[1], cuts[2], piece.to}) {
        part.to = cut;
        if (part.from < part.to && search_smooth(patch, ray, part, t, evaluations)) return true;
        part.from = cut;
    }
    return false;
}

bool CrackedPatches::search_smooth(const Patch& patch, const Ray& ray, const CrackNetwork::Piece& piece, double& t, std::uint32_t& evaluations) const
{
    const double flat = std::hypot(ray.direction.x, ray.direction.y), steep = std::abs(ray.direction.z);
    const double z0 = ray.at(piece.from).z, z1 = ray.at(piece.to).z;
    const double rise = piece.cracked ? field_.depth().most_ground_slope() : 1.0;
    const double bend = piece.cracked ? field_.lifted_bend({std::min(z0, z1), std::max(z0, z1)}) : 0.0;
    const auto bound = [&](double slope, double curvature) {
        return PieceBound{slope * flat + rise * steep, curvature * flat * flat + bend * steep * steep};
    };
    const auto f = [&](double s) {
        const Vec3d p = ray.at(s);
        return field_.lifted(p.z, piece.cracked) - field_.ground().height({p.x, p.y});
    };
    const auto closer = [&](double from, double to) {
        Box2d area(Vec2d(ray.at(from).x, ray.at(from).y));
        area.extendBy(Vec2d(ray.at(to).x, ray.at(to).y));
        area = Box2d(area.min - Vec2d(rounding_), area.max + Vec2d(rounding_));
        return bound(field_.ground().slope_bound(area), field_.ground().curvature_bound(area));
    };
    const double accuracy = std::max(accuracy_, 16.0 * 0x1p-52 * std::abs(piece.to));
    evaluations += 2;
    return first_crossing(f, closer, {piece.from, f(piece.from), piece.to, f(piece.to)},
                          {ray.crossing == Crossing::entering, false, 0.1 * accuracy, accuracy}, bound(patch.slope, patch.curvature), t, evaluations);
}

CrackedPatches::Met CrackedPatches::met(const Ray& ray, double t) const
{
    Met met;
    const Vec2d origin = field_.local({ray.origin.x, ray.origin.y}), direction(ray.direction.x, ray.direction.y);
    const double around = 16.0 * (accuracy_ + 0x1p-50 * std::abs(t));
    field_.network().for_each_piece(origin, direction, t - around, t + around, [&](const CrackNetwork::Piece& piece) {
        if (piece.wall && piece.from == t) met = {true, piece.into};
        return piece.from <= t;
    });
    return met;
}

}  // namespace hoodoo
