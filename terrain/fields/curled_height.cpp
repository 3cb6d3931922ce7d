// Dried mud curls: a plate's top dries and shrinks first, so its rim bends up, most of all where two edges meet.
//
// No paper; the shape is ours. With d_j > 0 the distances from a point to the borders of its cell (straight lines),
//     s = N^(-1/4),  N = sum_j d_j^-4;      c(s) = (1 - s / R)^2 for s < R, else 0;      h = ground + rise c(s).
// s is a smooth minimum: s <= min d_j, s = 0 on a border from either side, so h is continuous although neighbouring cells sum over other borders. Its
// bounds follow from a_j = (s / d_j)^5 and sum_j (s / d_j)^4 = 1 (n_j is the unit normal towards border j, grad d_j = -n_j):
//     grad s = -sum_j a_j n_j,                                        |grad s| <= sum_j a_j <= 1;
//     Hess s = 5 ( grad s grad s^T / s - sum_j a_j / d_j n_j n_j^T ),  a difference of two matrices that are not negative, of norms at most 1 / s and
//     sum_j (s / d_j)^6 / s <= 1 / s:                                 |Hess s| <= 5 / s.
// Then |grad c| <= 2 (1 - s / R) / R and |Hess c| <= 2 / R^2 + 2 (1 - s / R) / R * 5 / s, largest where s is least. On a border itself the gradient
// jumps and there is no curvature bound. Deviation from nature: all plates of one size curl alike. Missing: undercut rims, which are no height.
#include "terrain/fields/curled_height.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

CurledHeight::CurledHeight(std::shared_ptr<const Height> ground, VoronoiDiagram diagram, const Vec2d& corner, double rise, double reach)
    : ground_(std::move(ground)), diagram_(std::move(diagram)), corner_(corner), rise_(rise), reach_(reach)
{
}

Vec2d CurledHeight::inside(const Vec2d& p) const
{
    const Box2d domain = ground_->domain();
    return {std::clamp(p.x, domain.min.x, domain.max.x), std::clamp(p.y, domain.min.y, domain.max.y)};
}

double CurledHeight::smooth_distance(const Vec2d& p, Vec2d* gradient) const
{
    const Vec2d q = inside(p) - corner_;
    const std::uint32_t site = diagram_.nearest(q);
    // In units of the least distance, so that no power over- or underflows.
    const double least = diagram_.border_distance(q, site);
    if (gradient) *gradient = Vec2d(0.0);
    if (!(least > 0.0 && least < kInfinity)) return least;
    double sum = 0.0;
    for (const VoronoiDiagram::Border& border : diagram_.borders(site)) {
        const double share = least / std::max(border.distance(q), least), square = share * share;
        sum += square * square;
        if (gradient) *gradient -= border.normal * (square * square * share);
    }
    const double s = least / std::sqrt(std::sqrt(sum));
    if (gradient) *gradient *= std::pow(s / least, 5.0);
    return s;
}

double CurledHeight::height(const Vec2d& p) const
{
    const double rest = std::max(0.0, 1.0 - smooth_distance(p) / reach_);
    return ground_->height(p) + rise_ * rest * rest;
}

Vec2d CurledHeight::gradient(const Vec2d& p) const
{
    Vec2d slope;
    const double rest = 1.0 - smooth_distance(p, &slope) / reach_;
    Vec2d out = ground_->gradient(p);
    if (!(rest > 0.0)) return out;
    const Box2d domain = ground_->domain();
    for (int k = 0; k < 2; ++k)  // nothing changes beyond the domain's edge
        if (p[k] >= domain.min[k] && p[k] <= domain.max[k]) out[k] -= rise_ * 2.0 * rest / reach_ * slope[k];
    return out;
}

Interval CurledHeight::distance_range(const Box2d& area) const
{
    if (!std::isfinite((area.max - area.min).length2())) return {0.0, kInfinity};
    const double s = smooth_distance((area.min + area.max) * 0.5), reach = 0.5 * (area.max - area.min).length() * (1.0 + 0x1p-40);
    return {std::max(0.0, s - reach), s + reach};
}

Interval CurledHeight::range(const Box2d& area) const
{
    const Interval s = distance_range(area);
    const auto curl = [&](double distance) {
        const double rest = std::max(0.0, 1.0 - distance / reach_);
        return rise_ * rest * rest;
    };
    const double a = curl(s.hi), b = curl(s.lo), rounding = 0x1p-48 * std::abs(rise_);
    const Interval ground = ground_->range(area);
    return {ground.lo + std::min(a, b) - rounding, ground.hi + std::max(a, b) + rounding};
}

double CurledHeight::slope_bound(const Box2d& area) const
{
    const double rest = std::max(0.0, 1.0 - distance_range(area).lo / reach_);
    return ground_->slope_bound(area) + std::abs(rise_) * 2.0 * rest / reach_ * (1.0 + 0x1p-40);
}

double CurledHeight::curvature_bound(const Box2d& area) const
{
    const double least = distance_range(area).lo, rest = 1.0 - least / reach_;
    const double ground = ground_->curvature_bound(area);
    if (!(rest > 0.0)) return ground;
    const Box2d domain = ground_->domain();
    if (!domain.intersects(area.min) || !domain.intersects(area.max)) return kInfinity;  // the slope jumps at its edge
    return ground + std::abs(rise_) * 2.0 / reach_ * (1.0 / reach_ + 5.0 * rest / least) * (1.0 + 0x1p-40);
}

}  // namespace hoodoo
