// Cracks on any height, without a mesh and without a grid (Li2023, equation 1, solved for the height of the ground).
// With g(h) the elevation of a crack's floor in ground of elevation h, and G its inverse continued over the jump that epsilon = 0 makes:
//     F(p) = min( G(z) - h(x, y),  max( z - h(x, y),  width / 2 - d(x, y) ) ),     negative where z < h'.
// The first term is the floor, the second the ground between cracks, and where width / 2 - d decides there is a wall, whose gradient has no z.
// G(z) - h instead of the obvious z - g(h): it is continuous for every epsilon, its slope in z is at most 1 / (1 - kappa), and bounds of h are its
// own. Missing: level of detail (the base has what detail it has).
#include "terrain/fields/cracked_field.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

CrackedField::CrackedField(std::shared_ptr<const Height> ground, CrackNetwork network, const CrackDepth& depth, const Box2d& region, double zero,
                           double one)
    : ground_(std::move(ground)), network_(std::move(network)), depth_(depth), region_(region), zero_(zero), span_(one - zero)
{
}

double CrackedField::height(const Vec2d& p) const
{
    const double h = ground_->height(p);
    return cracked(p) ? floor(h) : h;
}

std::array<double, 3> CrackedField::kinks() const
{
    std::array<double, 3> at = depth_.kinks();
    for (double& z : at) z = zero_ + span_ * z;
    return at;
}

double CrackedField::value(const Vec3d& p) const
{
    const Vec2d q(p.x, p.y);
    const double h = ground_->height(q), d = network_.distance(local(q));
    return std::min(lifted(p.z, true) - h, std::max(p.z - h, 0.5 * network_.width() - d));
}

Vec3d CrackedField::gradient(const Vec3d& p) const
{
    const Vec2d q(p.x, p.y);
    const double h = ground_->height(q), d = network_.distance(local(q));
    const double top = p.z - h, wall = 0.5 * network_.width() - d;
    const bool at_floor = lifted(p.z, true) - h < std::max(top, wall);
    if (!at_floor && wall > top) {
        const Vec2d into = network_.towards(local(q));
        return {into.x, into.y, 0.0};
    }
    const Vec2d slope = ground_->gradient(q);
    return {-slope.x, -slope.y, at_floor ? lifted_slope(p.z) : 1.0};
}

double CrackedField::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length(), flat = Vec2d(along.x, along.y).length();
    const double slope = ground_->slope_bound(area_under(segment));
    if (!(length > 0.0)) return std::max(1.0, slope + depth_.most_ground_slope());
    return std::max(flat, slope * flat + depth_.most_ground_slope() * std::abs(along.z)) / length;
}

Interval CrackedField::range(const Box3d& box) const
{
    const Box2d area = area_under(box);
    const Interval h = ground_->range(area), d = network_.distance_range({local(area.min), local(area.max)});
    const double half = 0.5 * network_.width();
    const auto least = [&](double z, double ground, double distance) {
        return std::min(lifted(z, true) - ground, std::max(z - ground, half - distance));
    };
    return {least(box.min.z, h.hi, d.hi), least(box.max.z, h.lo, d.lo)};
}

Box3d CrackedField::bounds() const
{
    const Interval h = ground_->range(region_);
    return {Vec3d(region_.min.x, region_.min.y, -kInfinity), Vec3d(region_.max.x, region_.max.y, h.hi)};
}

}  // namespace hoodoo
