// A cross section moved along a path: prisms between mitre planes, each the maximum of a scaled plane distance and the distances of its end planes.
//
// In the frame (right, up, t) of a piece, with s along it and D the signed distance of the profile's polygon in the plane, the wall is
//   G = sigma D(q / sigma),   sigma linear in s,
// the distance from the polygon scaled by sigma. |grad_q G| <= 1, and dG/dsigma = D - (q/sigma).grad D is at most the largest distance of the profile
// from the path: with c the nearest point of the outline D = +-|x - c| and x.grad D = +-x.(x - c)/|x - c|, so the difference is +-c.(x - c)/|x - c|.
// So the slope is at most sqrt(1 + (reach sigma')^2). Frames are carried over a mitre by reflection in its plane, which leaves that plane's own
// points alone: the walls of two pieces meet there exactly while the scale stays, to second order of the turn while it changes. Prisms as sections of
// swept tools: Peytavie2009, section 4.2. Deviation: profiles are scaled, not turned into one another.
#include "terrain/fields/blob_tree.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

struct Flat {
    double value;
    Vec2d gradient;  ///< unit, but 0 on the outline
};

/// Signed distance of a polygon, negative inside.
Flat polygon_distance(const std::vector<Vec2d>& corners, const Vec2d& q)
{
    bool inside = false;
    double least = kInfinity;
    Vec2d to(0.0);
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2d &a = corners[n], &b = corners[(n + 1) % corners.size()];
        if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) * (b.x - a.x) / (b.y - a.y)) inside = !inside;
        const Vec2d edge = b - a;
        const double t = edge.length2() > 0.0 ? std::clamp((q - a).dot(edge) / edge.length2(), 0.0, 1.0) : 0.0;
        const Vec2d away = q - a - edge * t;
        if (away.length2() < least) least = away.length2(), to = away;
    }
    const double distance = std::sqrt(least);
    if (!(distance > 0.0)) return {0.0, Vec2d(0.0)};
    return inside ? Flat{-distance, to / -distance} : Flat{distance, to / distance};
}

struct Prism {
    Vec3d from, to;         ///< on the path
    Vec3d t, right, up;     ///< orthonormal
    Vec3d enter, leave;     ///< unit normals of the end planes, both outwards
    double sigma0, sigma1;  ///< scales at the ends
};

class Sweep final : public BlobNode
{
public:
    Sweep(std::vector<Prism> prisms, std::vector<Vec2d> profile, double slope, const Box3d& box, std::int32_t material)
        : prisms_(std::move(prisms)), profile_(std::move(profile)), slope_(slope), box_(box), material_(material)
    {
    }

    double value(const Vec3d& p) const override { return nearest(p).first; }
    Vec3d gradient(const Vec3d& p) const override { return nearest(p).second; }
    LocalField local(const Box3d& box) const override
    {
        const auto [value, gradient] = nearest(box.center());
        return local_from_centre(box, value, gradient, slope_, kInfinity);
    }
    void shares(const Vec3d&, double weight, BlobShares& out) const override { out.add(material_, weight); }
    bool paints() const override { return material_ != BlobShares::kNoSource; }
    Box3d bounds() const override { return box_; }

private:
    std::pair<double, Vec3d> in_prism(const Prism& prism, const Vec3d& p) const
    {
        const Vec3d q = p - prism.from;
        const double length = (prism.to - prism.from).length(), s = q.dot(prism.t), grow = (prism.sigma1 - prism.sigma0) / length;
        const double sigma = prism.sigma0 + grow * std::clamp(s, 0.0, length);
        const Vec2d x(q.dot(prism.right) / sigma, q.dot(prism.up) / sigma);
        const Flat flat = polygon_distance(profile_, x);
        std::pair<double, Vec3d> out{sigma * flat.value, prism.right * flat.gradient.x + prism.up * flat.gradient.y};
        if (s > 0.0 && s < length) out.second += prism.t * ((flat.value - x.dot(flat.gradient)) * grow);
        const double before = q.dot(prism.enter), after = (p - prism.to).dot(prism.leave);
        if (before > out.first) out = {before, prism.enter};
        if (after > out.first) out = {after, prism.leave};
        return out;
    }

    std::pair<double, Vec3d> nearest(const Vec3d& p) const
    {
        std::pair<double, Vec3d> best{kInfinity, Vec3d(0.0)};
        for (const Prism& prism : prisms_) {
            const auto here = in_prism(prism, p);
            if (here.first < best.first) best = here;
        }
        return best;
    }

    std::vector<Prism> prisms_;
    std::vector<Vec2d> profile_;
    double slope_;
    Box3d box_;
    std::int32_t material_;
};

Vec3d reflected(const Vec3d& v, const Vec3d& unit)
{
    return v - unit * (2.0 * v.dot(unit));
}

}  // namespace

BlobPtr blob_sweep(std::vector<Vec3d> points, std::vector<double> scales, std::vector<Vec2d> profile, std::int32_t material)
{
    double reach = 0.0, steepest = 0.0;
    for (const Vec2d& corner : profile) reach = std::max(reach, corner.length());

    std::vector<Prism> prisms;
    Box3d all;
    for (std::size_t n = 0; n + 1 < points.size(); ++n) {
        Prism prism{points[n], points[n + 1], (points[n + 1] - points[n]).normalized(), {}, {}, {}, {}, scales[n], scales[n + 1]};
        if (n == 0) {
            const Vec3d wanted = std::abs(prism.t.z) < 0.999 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0);
            prism.up = (wanted - prism.t * wanted.dot(prism.t)).normalized();
            prism.right = prism.t.cross(prism.up);
            prism.enter = -prism.t;
        } else {
            const Prism& last = prisms.back();
            const Vec3d mitre = (last.t + prism.t).normalized();
            prism.right = reflected(last.right, mitre);
            prism.up = reflected(last.up, mitre);
            prism.enter = -mitre;
        }
        prism.leave = n + 2 < points.size() ? (prism.t + (points[n + 2] - points[n + 1]).normalized()).normalized() : prism.t;
        steepest = std::max(steepest, reach * std::abs(scales[n + 1] - scales[n]) / (points[n + 1] - points[n]).length());
        // A mitred corner lies reach / cos(half the turn) from the path: twice the reach at 120 degrees.
        const Vec3d around(2.0 * reach * std::max(scales[n], scales[n + 1]));
        for (const Vec3d& end : {points[n], points[n + 1]}) all.extendBy(Box3d(end - around, end + around));
        prisms.push_back(prism);
    }
    return std::make_shared<Sweep>(std::move(prisms), std::move(profile), std::sqrt(1.0 + steepest * steepest), all, material);
}

}  // namespace hoodoo
