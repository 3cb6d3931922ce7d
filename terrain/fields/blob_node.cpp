// Bounds that every node's own follow from: the mean value theorem about a box's centre, to first and to second order.
// With h the half sides and r half the diagonal: F lies in F(c) +- sum_k |G_k| h_k for gradients G in the box; where the gradient turns by at most K
// a metre, G lies in grad F(c) +- K r and F in F(c) +- (sum_k |dF(c)_k| h_k + K r^2 / 2).
#include "terrain/fields/blob_node.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// Of a few roundings of numbers of this size: what every bound is widened by.
double rounding(const Box3d& box, double value)
{
    double far = std::abs(value);
    for (int k = 0; k < 3; ++k) far = std::max({far, std::abs(box.min[k]), std::abs(box.max[k])});
    return 0x1p-46 * far;
}

}  // namespace

void BlobShares::add(std::int32_t source, double weight)
{
    const auto known = std::find_if(list.begin(), list.end(), [&](const Share& s) { return s.source == source; });
    if (known != list.end()) {
        known->weight += weight;
    } else {
        list.push_back({source, weight});
    }
}

double BlobNode::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length();
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const LocalField known = local(box);
    return (length > 0.0 ? known.slope_along(along / length) : known.slope()) * (1.0 + 1e-12);
}

void narrow_by_gradient(const Box3d& box, const Vec3d& gradient, LocalField& known)
{
    const Vec3d half = box.size() * 0.5;
    double straight = 0.0, linear = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double steepest = known.gradient[static_cast<std::size_t>(k)].magnitude();
        straight += half[k] > 0.0 ? steepest * half[k] : 0.0;
        linear += std::abs(gradient[k]) * half[k];
    }
    double reach = straight;
    if (std::isfinite(known.curvature)) reach = std::min(reach, linear + 0.5 * known.curvature * half.length2());
    reach += rounding(box, known.centre);
    known.value = Interval::common(known.value, {known.centre - reach, known.centre + reach});
}

LocalField local_from_centre(const Box3d& box, double value, const Vec3d& gradient, double slope, double curvature)
{
    const double radius = 0.5 * box.size().length();
    LocalField known;
    known.centre = value;
    known.curvature = known.upright = curvature;
    const double reach = slope * radius + rounding(box, value);
    known.value = {value - reach, value + reach};
    for (int k = 0; k < 3; ++k) {
        Interval& g = known.gradient[static_cast<std::size_t>(k)];
        g = {-slope, slope};
        if (!std::isfinite(curvature)) continue;
        const double turn = curvature * radius + 1e-12 * slope;
        g = Interval::common(g, {gradient[k] - turn, gradient[k] + turn});
    }
    narrow_by_gradient(box, gradient, known);
    return known;
}

double distance_to_box(const Vec3d& p, const Box3d& box)
{
    Vec3d away(0.0);
    for (int k = 0; k < 3; ++k) away[k] = std::max({box.min[k] - p[k], 0.0, p[k] - box.max[k]});
    return away.length();
}

}  // namespace hoodoo
