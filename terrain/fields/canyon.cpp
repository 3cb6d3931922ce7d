// A canyon from a noise and its own gradient (Gamito2001, section 4.1): rock where the walls say so below the plateau, and a floor.
// Floor: height floor_amplitude (1 + fBm of 3 octaves). Plateau: the height, lifted by the vertical deformation (section 5) as the layers below it
// are.
#include "terrain/fields/canyon.h"

#include "terrain/math/noise_hessian.h"

#include <algorithm>

namespace hoodoo
{

CanyonField::CanyonField(const CanyonShape& shape) : shape_(shape), wall_(shape) {}

namespace
{

const Fractal kFloor{3.0, 2.0, 0.5};

}  // namespace

double CanyonField::floor(const Vec3d& p) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    const Noise2 n = fbm(Vec2d(p.x - shape_.origin.x, p.y - shape_.origin.y) * (1.0 / w), shape_.seed + 101u, kFloor);
    return p.z - shape_.origin.z - a * (1.0 + n.value);
}

Vec3d CanyonField::floor_gradient(const Vec3d& p) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    const Noise2 n = fbm(Vec2d(p.x - shape_.origin.x, p.y - shape_.origin.y) * (1.0 / w), shape_.seed + 101u, kFloor);
    return {-a / w * n.gradient.x, -a / w * n.gradient.y, 1.0};
}

LocalField CanyonField::floor_local(const Box3d& box) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    // Three octaves: slopes add (2 x 0.5)^k, second derivatives (4 x 0.5)^k.
    const double slope = a / w * 3.0 * kNoise2Derivatives.slope, curve = a / (w * w) * 7.0 * kNoise2Derivatives.hessian;
    const Vec3d half = box.size() * 0.5, g = floor_gradient(box.center());
    const double radius = std::hypot(half.x, half.y), turn = curve * radius, f = floor(box.center());
    LocalField known;
    for (int k = 0; k < 2; ++k) known.gradient[static_cast<std::size_t>(k)] = {std::max(g[k] - turn, -slope), std::min(g[k] + turn, slope)};
    known.gradient[2] = {1.0, 1.0};
    const double linear = std::abs(g.x) * half.x + std::abs(g.y) * half.y + 0.5 * curve * radius * radius;
    const double reach = std::min({linear, slope * radius, a * 1.75 * kNoise2Bound.value * 2.0}) + half.z + 1e-12 * shape_.cell;
    known.centre = f;
    known.value = {f - reach, f + reach};
    known.curvature = curve;
    known.mixed = known.upright = 0.0;
    return known;
}

Vec3d CanyonField::plateau_gradient(const Vec3d& p) const
{
    const Vec2d g = CanyonLift::at(shape_, p).gradient;
    return {-g.x, -g.y, 1.0};
}

LocalField CanyonField::plateau_local(const Box3d& box) const
{
    const Interval lift = CanyonLift::over(shape_, box).value;
    const CanyonLift::Bound most = CanyonLift::bound(shape_);
    const Vec3d half = box.size() * 0.5, g = plateau_gradient(box.center());
    const double turn = most.curve * std::hypot(half.x, half.y), top = shape_.origin.z + shape_.height;
    LocalField known;
    known.value = {box.min.z - top - lift.hi, box.max.z - top - lift.lo};
    known.centre = plateau(box.center());
    for (int k = 0; k < 2; ++k) known.gradient[static_cast<std::size_t>(k)] = {std::max(g[k] - turn, -most.slope), std::min(g[k] + turn, most.slope)};
    known.gradient[2] = {1.0, 1.0};
    known.curvature = most.curve;
    known.mixed = known.upright = 0.0;
    return known;
}

double CanyonField::value(const Vec3d& p) const
{
    const double top = plateau(p), ground = floor(p);
    // The walls need not be asked where the answer cannot depend on them.
    if (top >= ground) return ground;
    return std::min(ground, std::max(top, wall_.value(p)));
}

Vec3d CanyonField::gradient(const Vec3d& p) const
{
    const double top = plateau(p), ground = floor(p);
    if (top >= ground) return floor_gradient(p);
    const double wall = wall_.value(p);
    if (ground <= std::max(top, wall)) return floor_gradient(p);
    return top >= wall ? plateau_gradient(p) : wall_.gradient(p);
}

namespace
{

/// Of the parts that can be the value somewhere in the box.
struct Parts {
    LocalField wall, top, ground;
    bool has_wall, has_top, has_ground;
    Interval value;
};

Parts parts_of(const CanyonField& field, const Box3d& box)
{
    Parts p{field.wall().local(box), field.plateau_local(box), field.floor_local(box), true, true, true, {}};
    const Interval rock{std::max(p.wall.value.lo, p.top.value.lo), std::max(p.wall.value.hi, p.top.value.hi)};
    p.value = {std::min(rock.lo, p.ground.value.lo), std::min(rock.hi, p.ground.value.hi)};
    p.has_ground = p.ground.value.lo <= rock.hi;
    const bool has_rock = rock.lo <= p.ground.value.hi;
    p.has_wall = has_rock && p.wall.value.hi >= p.top.value.lo;
    p.has_top = has_rock && p.top.value.hi >= p.wall.value.lo;
    return p;
}

}  // namespace

double CanyonField::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length();
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const Parts p = parts_of(*this, box);
    double most = 0.0;
    for (const auto& [used, part] : {std::pair{p.has_wall, &p.wall}, std::pair{p.has_top, &p.top}, std::pair{p.has_ground, &p.ground}})
        if (used) most = std::max(most, length > 0.0 ? part->slope_along(along / length) : part->slope());
    return most * (1.0 + 1e-12);
}

Interval CanyonField::range(const Box3d& box) const
{
    return parts_of(*this, box).value;
}

Box3d CanyonField::bounds() const
{
    const Vec3d& o = shape_.origin;
    const double top = shape_.height + CanyonLift::bound(shape_).value;
    return {Vec3d(-kInfinity), Vec3d(kInfinity, kInfinity, o.z + std::max(top, shape_.height * shape_.floor_amplitude * 2.3))};
}

std::array<Interval, 3> CanyonField::gradient_range(const Box3d& box) const
{
    const Parts p = parts_of(*this, box);
    std::array<Interval, 3> hull{Interval{kInfinity, -kInfinity}, Interval{kInfinity, -kInfinity}, Interval{kInfinity, -kInfinity}};
    for (const auto& [used, part] : {std::pair{p.has_wall, &p.wall}, std::pair{p.has_top, &p.top}, std::pair{p.has_ground, &p.ground}})
        if (used)
            for (std::size_t k = 0; k < 3; ++k) hull[k] = Interval::hull(hull[k], part->gradient[k]);
    return hull;
}

}  // namespace hoodoo