// Distances from skeletons. Each is convex or a minimum of convex ones, which bounds how its gradient can turn.
//
// The distance d from a convex set has a gradient (p - foot) / d, and feet move no faster than points, so it turns by at most 1 / d a metre. A round
// cone is a ball's sweep; with its least radius taken off both ends it is the distance from a convex set, so its curvature is at most
// 1 / (F + least radius). A curve is the minimum of its pieces: over a box in which one piece is certainly the nearest it has that one's bounds, else
// its gradient may jump between those of the pieces that can be nearest. Skeletons as in Wyvill1999; there potentials fall off with the distance,
// here the distance itself is kept (its zero is the same), since it is 1-Lipschitz and has a unit. Deviation: curves are flattened before they come
// here.
#include "terrain/fields/blob_tree.h"
#include "terrain/fields/round_cone.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// What all primitives share: a box, a material.
class Primitive : public BlobNode
{
public:
    Primitive(const Box3d& box, std::int32_t material) : box_(box), material_(material) {}
    /// Outside of its matter a distance is at least that to the matter's box.
    double lower_bound(const Vec3d& p) const override
    {
        const double away = distance_to_box(p, box_);
        return away > 0.0 ? away : -kInfinity;
    }
    void shares(const Vec3d&, double weight, BlobShares& out) const override { out.add(material_, weight); }
    Box3d bounds() const override { return box_; }

private:
    Box3d box_;
    std::int32_t material_;
};

Box3d box_of(const std::vector<RoundCone>& pieces)
{
    Box3d box;
    for (const RoundCone& piece : pieces) box.extendBy(piece.bounds());
    return box;
}

class Curve final : public Primitive
{
public:
    Curve(std::vector<RoundCone> pieces, std::int32_t material) : Primitive(box_of(pieces), material), pieces_(std::move(pieces))
    {
        for (const RoundCone& piece : pieces_) boxes_.push_back(piece.bounds());
    }

    double value(const Vec3d& p) const override { return nearest(p).value; }
    Vec3d gradient(const Vec3d& p) const override { return nearest(p).towards; }

    LocalField local(const Box3d& box) const override
    {
        const Vec3d centre = box.center();
        const double reach = box.size().length();  // two half diagonals: one piece may gain as much as another loses
        const RoundCone::Sample best = nearest(centre);
        LocalField known;
        bool first = true;
        for (std::size_t n = 0; n < pieces_.size(); ++n) {
            const double away = distance_to_box(centre, boxes_[n]);
            if (away > 0.0 && away > best.value + reach) continue;
            const RoundCone::Sample s = pieces_[n].sample(centre);
            if (s.value > best.value + reach) continue;
            const double from_core = s.value - 0.5 * reach + pieces_[n].least_radius();
            const LocalField own = local_from_centre(box, s.value, s.towards, 1.0, from_core > 0.0 ? 1.0 / from_core : kInfinity);
            if (first) {
                known = own;
                first = false;
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) known.gradient[k] = Interval::hull(known.gradient[k], own.gradient[k]);
            known.value = {std::min(known.value.lo, own.value.lo), std::min(known.value.hi, own.value.hi)};
            known.curvature = known.upright = kInfinity;
        }
        known.centre = best.value;
        return known;
    }

private:
    RoundCone::Sample nearest(const Vec3d& p) const
    {
        RoundCone::Sample best{kInfinity, Vec3d(0.0), 0.0};
        for (std::size_t n = 0; n < pieces_.size(); ++n) {
            if (distance_to_box(p, boxes_[n]) > std::max(best.value, 0.0)) continue;
            const RoundCone::Sample s = pieces_[n].sample(p);
            if (s.value < best.value) best = s;
        }
        return best;
    }

    std::vector<RoundCone> pieces_;
    std::vector<Box3d> boxes_;
};

/// The distance from a flat skeleton in a plane, less a radius. `Flat` knows the skeleton in the plane's coordinates.
struct Foot {
    Vec2d outward{0.0};     ///< unit, from the skeleton's rim to the point; 0 over the skeleton
    double distance = 0.0;  ///< in the plane; 0 over the skeleton
    double rim = 0.0;       ///< over the skeleton: how far its rim is
};

class FlatPrimitive : public Primitive
{
public:
    FlatPrimitive(const Box3d& box, std::int32_t material, const Vec3d& centre, const Vec3d& normal, double radius, bool convex)
        : Primitive(box, material), centre_(centre), normal_(normal.normalized()), radius_(radius), convex_(convex)
    {
        orthonormal_frame(normal_, right_, up_);
    }

    double value(const Vec3d& p) const override { return sample(p).first; }
    Vec3d gradient(const Vec3d& p) const override { return sample(p).second; }
    LocalField local(const Box3d& box) const override
    {
        const Vec3d centre = box.center();
        const auto [value, gradient] = sample(centre);
        const double radius = 0.5 * box.size().length(), from_core = value - radius + radius_;
        // Over the skeleton, on one side of it, the distance is the height: a plane's.
        if (foot(in_plane(centre)).rim > radius && std::abs((centre - centre_).dot(normal_)) > radius)
            return local_from_centre(box, value, gradient, 1.0, 0.0);
        return local_from_centre(box, value, gradient, 1.0, convex_ && from_core > 0.0 ? 1.0 / from_core : kInfinity);
    }

protected:
    Vec2d in_plane(const Vec3d& p) const { return {(p - centre_).dot(right_), (p - centre_).dot(up_)}; }
    virtual Foot foot(const Vec2d& q) const = 0;

private:
    std::pair<double, Vec3d> sample(const Vec3d& p) const
    {
        const double height = (p - centre_).dot(normal_);
        const Foot foot = this->foot(in_plane(p));
        const double distance = std::hypot(foot.distance, height);
        if (!(distance > 0.0)) return {-radius_, Vec3d(0.0)};
        const Vec3d flat = right_ * foot.outward.x + up_ * foot.outward.y;
        return {distance - radius_, (flat * foot.distance + normal_ * height) / distance};
    }

    Vec3d centre_, normal_, right_, up_;
    double radius_;
    bool convex_;
};

class Disc final : public FlatPrimitive
{
public:
    Disc(const Box3d& box, std::int32_t material, const Vec3d& centre, const Vec3d& normal, double extent, double radius)
        : FlatPrimitive(box, material, centre, normal, radius, true), extent_(extent)
    {
    }

private:
    Foot foot(const Vec2d& q) const override
    {
        const double away = q.length();
        return away > extent_ ? Foot{q / away, away - extent_, 0.0} : Foot{Vec2d(0.0), 0.0, extent_ - away};
    }
    double extent_;
};

class Polygon final : public FlatPrimitive
{
public:
    Polygon(const Box3d& box, std::int32_t material, const std::vector<Vec3d>& corners, const Vec3d& normal, double radius, bool convex)
        : FlatPrimitive(box, material, corners.front(), normal, radius, convex)
    {
        for (const Vec3d& corner : corners) corners_.push_back(in_plane(corner));
    }

private:
    Foot foot(const Vec2d& q) const override
    {
        bool inside = false;
        double least = kInfinity;
        Vec2d to(0.0);
        for (std::size_t n = 0; n < corners_.size(); ++n) {
            const Vec2d &a = corners_[n], &b = corners_[(n + 1) % corners_.size()];
            if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) * (b.x - a.x) / (b.y - a.y)) inside = !inside;
            const Vec2d edge = b - a;
            const double t = edge.length2() > 0.0 ? std::clamp((q - a).dot(edge) / edge.length2(), 0.0, 1.0) : 0.0;
            const Vec2d away = q - a - edge * t;
            if (away.length2() < least) least = away.length2(), to = away;
        }
        const double distance = std::sqrt(least);
        if (inside) return {Vec2d(0.0), 0.0, distance};
        return distance > 0.0 ? Foot{to / distance, distance, 0.0} : Foot{};
    }
    std::vector<Vec2d> corners_;
};

/// Twice the area, as a vector along the normal (Newell's sum).
Vec3d area_vector(const std::vector<Vec3d>& corners)
{
    Vec3d sum(0.0);
    for (std::size_t n = 0; n < corners.size(); ++n) sum += (corners[n] - corners[0]).cross(corners[(n + 1) % corners.size()] - corners[0]);
    return sum;
}

bool is_convex(const std::vector<Vec3d>& corners, const Vec3d& normal)
{
    const std::size_t n = corners.size();
    // One turn at each corner, all the same way; without crossings that is once round.
    for (std::size_t k = 0; k < n; ++k) {
        const Vec3d a = corners[(k + 1) % n] - corners[k], b = corners[(k + 2) % n] - corners[(k + 1) % n];
        if (a.cross(b).dot(normal) < 0.0) return false;
    }
    return true;
}

}  // namespace

BlobPtr blob_curve(std::vector<Vec3d> points, std::vector<double> radii, std::int32_t material)
{
    std::vector<RoundCone> pieces;
    for (std::size_t n = 0; n + 1 < points.size(); ++n) pieces.push_back({points[n], points[n + 1], radii[n], radii[n + 1]});
    if (pieces.empty()) pieces.push_back({points[0], points[0], radii[0], radii[0]});
    return std::make_shared<Curve>(std::move(pieces), material);
}

BlobPtr blob_disc(const Vec3d& centre, const Vec3d& normal, double extent, double radius, std::int32_t material)
{
    const Vec3d n = normal.normalized();
    Vec3d half;
    for (int k = 0; k < 3; ++k) half[k] = extent * std::sqrt(std::max(0.0, 1.0 - n[k] * n[k])) + radius;
    return std::make_shared<Disc>(Box3d(centre - half, centre + half), material, centre, n, extent, radius);
}

BlobPtr blob_polygon(std::vector<Vec3d> corners, double radius, std::int32_t material)
{
    Box3d box;
    for (const Vec3d& corner : corners) box.extendBy(corner);
    const Vec3d normal = area_vector(corners);
    return std::make_shared<Polygon>(Box3d(box.min - Vec3d(radius), box.max + Vec3d(radius)), material, corners, normal, radius,
                                     is_convex(corners, normal));
}

}  // namespace hoodoo
