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

/// Of a polygon's signed distance at a point.
struct Flat {
    double value;    ///< negative inside
    Vec2d gradient;  ///< unit, but 0 on the outline
    double margin;   ///< as far as this around the point the same edge's line is the nearest part of the outline
};

Flat polygon_distance(const std::vector<Vec2d>& corners, const Vec2d& q)
{
    bool inside = false;
    double least = kInfinity, second = kInfinity, to_ends = 0.0;
    Vec2d to(0.0);
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2d &a = corners[n], &b = corners[(n + 1) % corners.size()];
        if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) * (b.x - a.x) / (b.y - a.y)) inside = !inside;
        const Vec2d edge = b - a;
        const double length = edge.length(), t = length > 0.0 ? std::clamp((q - a).dot(edge) / (length * length), 0.0, 1.0) : 0.0;
        const Vec2d away = q - a - edge * t;
        const double distance = away.length();
        second = std::min(second, std::max(distance, least));
        if (distance < least) least = distance, to = away, to_ends = std::min(t, 1.0 - t) * length;
    }
    if (!(least > 0.0)) return {0.0, Vec2d(0.0), 0.0};
    // Within the margin the foot stays on the edge, no other edge comes nearer, and the outline is not crossed.
    const double margin = std::min({to_ends, 0.5 * (second - least), least});
    return inside ? Flat{-least, to / -least, margin} : Flat{least, to / least, margin};
}

struct Prism {
    Vec3d from, to;         ///< on the path
    Vec3d t, right, up;     ///< orthonormal
    Vec3d enter, leave;     ///< unit normals of the end planes, both outwards
    double sigma0, sigma1;  ///< scales at the ends
    Box3d box;              ///< of its matter
};

class Sweep final : public BlobNode
{
public:
    Sweep(std::vector<Prism> prisms, std::vector<Vec2d> profile, double slope, const Box3d& box, std::int32_t material)
        : prisms_(std::move(prisms)), profile_(std::move(profile)), slope_(slope), box_(box), material_(material)
    {
    }

    double value(const Vec3d& p) const override { return nearest(p).value; }
    Vec3d gradient(const Vec3d& p) const override { return nearest(p).gradient; }
    LocalField local(const Box3d& box) const override
    {
        const Here here = nearest(box.center());
        // Walls and ends are planes, as far as one of them is certainly the nearest.
        return local_from_centre(box, here.value, here.gradient, slope_, here.margin > 0.5 * box.size().length() ? 0.0 : kInfinity);
    }
    void shares(const Vec3d&, double weight, BlobShares& out) const override { out.add(material_, weight); }
    double lower_bound(const Vec3d& p) const override
    {
        const double away = distance_to_box(p, box_);
        return away > 0.0 ? away : -kInfinity;
    }
    Box3d bounds() const override { return box_; }

private:
    struct Here {
        double value;
        Vec3d gradient;
        double margin;  ///< as far as this around the point the function is linear
    };

    Here in_prism(const Prism& prism, const Vec3d& p) const
    {
        const Vec3d q = p - prism.from;
        const double length = (prism.to - prism.from).length(), s = q.dot(prism.t), grow = (prism.sigma1 - prism.sigma0) / length;
        const double sigma = prism.sigma0 + grow * std::clamp(s, 0.0, length);
        const Vec2d x(q.dot(prism.right) / sigma, q.dot(prism.up) / sigma);
        const Flat flat = polygon_distance(profile_, x);
        Here wall{sigma * flat.value, prism.right * flat.gradient.x + prism.up * flat.gradient.y, 0.0};
        if (s > 0.0 && s < length) wall.gradient += prism.t * ((flat.value - x.dot(flat.gradient)) * grow);
        // A move of m changes q / sigma by at most m (1 + |x| |grow|) / sigma, with the smallest sigma there is.
        const double reach = x.length() + flat.margin, least = std::min(prism.sigma0, prism.sigma1);
        wall.margin = flat.margin * least / (1.0 + reach * std::abs(grow));
        if (grow != 0.0) wall.margin = std::min({wall.margin, std::abs(s), std::abs(length - s)});
        const Here enter{q.dot(prism.enter), prism.enter, kInfinity}, leave{(p - prism.to).dot(prism.leave), prism.leave, kInfinity};
        std::array<Here, 3> parts{wall, enter, leave};
        std::sort(parts.begin(), parts.end(), [](const Here& a, const Here& b) { return a.value > b.value; });
        parts[0].margin = std::min(parts[0].margin, (parts[0].value - parts[1].value) / (2.0 * slope_));
        return parts[0];
    }

    Here nearest(const Vec3d& p) const
    {
        // The piece whose box is nearest first, so that most of the others are far from it and need only a look at their planes.
        std::size_t first = 0;
        double least = kInfinity;
        for (std::size_t n = 0; n < prisms_.size() && least > 0.0; ++n) {
            const double bound = at_least(prisms_[n], p);
            if (bound < least) least = bound, first = n;
        }
        Here best{kInfinity, Vec3d(0.0), 0.0};
        double second = kInfinity;
        take(prisms_[first], p, best, second);
        for (std::size_t n = 0; n < prisms_.size(); ++n) {
            if (n != first) take(prisms_[n], p, best, second);
        }
        best.margin = std::min(best.margin, (second - best.value) / (2.0 * slope_));
        return best;
    }

    /// No more than the value of the piece at `p`: it is a maximum with its end planes, and in air at least the distance to its box.
    static double at_least(const Prism& prism, const Vec3d& p)
    {
        const double ends = std::max((p - prism.from).dot(prism.enter), (p - prism.to).dot(prism.leave)), away = distance_to_box(p, prism.box);
        return away > 0.0 ? std::max(ends, away) : ends;
    }

    /// Counts a piece in; `second` stays at most the value of every piece but the best.
    void take(const Prism& prism, const Vec3d& p, Here& best, double& second) const
    {
        const double bound = at_least(prism, p);
        if (bound > best.value) {
            second = std::min(second, bound);
            return;
        }
        // In air a prism is at least as far as its box, which its walls and planes alone would not say.
        const Vec3d near(std::clamp(p.x, prism.box.min.x, prism.box.max.x), std::clamp(p.y, prism.box.min.y, prism.box.max.y),
                         std::clamp(p.z, prism.box.min.z, prism.box.max.z));
        const double away = (p - near).length();
        Here here = in_prism(prism, p);
        // The box says nothing within itself; beyond, it may take over as soon as the two are near.
        double inside = kInfinity;
        for (int k = 0; k < 3; ++k) inside = std::min({inside, p[k] - prism.box.min[k], prism.box.max[k] - p[k]});
        here.margin = std::min(here.margin, std::max(inside, 0.5 * (here.value - away) / slope_));
        if (away > 0.0 && away > here.value) here = {away, (p - near) / away, 0.0};
        second = std::min(second, std::max(here.value, best.value));
        if (here.value < best.value) best = here;
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
        Prism prism{points[n], points[n + 1], (points[n + 1] - points[n]).normalized(), {}, {}, {}, {}, scales[n], scales[n + 1], {}};
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
        for (const Vec3d& end : {points[n], points[n + 1]}) prism.box.extendBy(Box3d(end - around, end + around));
        all.extendBy(prism.box);
        prisms.push_back(prism);
    }
    return std::make_shared<Sweep>(std::move(prisms), std::move(profile), std::sqrt(1.0 + steepest * steepest), all, material);
}

}  // namespace hoodoo
