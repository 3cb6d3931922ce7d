// A height as an implicit function, F = z - h(x, y): its bounds are those of the height over the area below.
// Galin's course (GalinCourse); grad F = (-h_x, -h_y, 1), so |grad F| <= sqrt(1 + L^2), and along a segment with the horizontal part c of its length
// and the vertical part s the slope is at most L c + |s|. Rounding of z - h is allowed for by 2^-50 of the larger.
#include "terrain/fields/height.h"

#include <algorithm>

namespace hoodoo
{

Box2d area_under(const Segment& segment)
{
    Box2d area(Vec2d(segment.a.x, segment.a.y));
    area.extendBy(Vec2d(segment.b.x, segment.b.y));
    return area;
}

Vec3d HeightAsField::gradient(const Vec3d& p) const
{
    const Vec2d g = height_.gradient({p.x, p.y});
    return {-g.x, -g.y, 1.0};
}

double HeightAsField::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length(), slope = height_.slope_bound(area_under(segment));
    if (!(length > 0.0)) return std::hypot(1.0, slope);
    return (std::hypot(along.x, along.y) * slope + std::abs(along.z)) / length * (1.0 + 0x1p-40);
}

Interval HeightAsField::range(const Box3d& box) const
{
    const Interval heights = height_.range(area_under(box));
    const double rounding = 0x1p-50 * (std::max(std::abs(box.min.z), std::abs(box.max.z)) + heights.magnitude());
    return {box.min.z - heights.hi - rounding, box.max.z - heights.lo + rounding};
}

Box3d HeightAsField::bounds() const
{
    const Box2d domain = height_.domain();
    return {{domain.min.x, domain.min.y, -kInfinity}, {domain.max.x, domain.max.y, height_.range(domain).hi}};
}

std::array<Interval, 3> HeightAsField::gradient_range(const Box3d& box) const
{
    const std::array<Interval, 2> g = height_.gradient_range(area_under(box));
    return {-g[0], -g[1], Interval{1.0, 1.0}};
}

double HeightAsField::curvature_bound(const Box3d& box) const
{
    return height_.curvature_bound(area_under(box));
}

}  // namespace hoodoo
