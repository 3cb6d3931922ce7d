// Terrain that is a height over the plane: z = h(x, y). What cracks, landforms and analyses ask of any representation that has one.
#pragma once

#include "terrain/field.h"

#include <array>

namespace hoodoo
{

using Box2d = Imath::Box2d;

/// All that is proved of a height over an area, as Height's functions have it one by one.
struct HeightBounds {
    Interval value;
    double slope = 0.0, curvature = kInfinity;
    std::array<Interval, 2> gradient;
};

/// Height over the world's plane. Matter is where z < height. Pure and thread-safe. Metres, world space.
class Height
{
public:
    virtual ~Height() = default;

    /// Height at a point of the domain, metres, continuous. Outside of the domain: that of the nearest point in it.
    virtual double height(const Vec2d& p) const = 0;

    /// Its gradient (metres a metre); one-sided at creases; 0 across the domain's edge outside of it.
    virtual Vec2d gradient(const Vec2d& p) const = 0;

    /// A proved enclosure of the heights over the area.
    virtual Interval range(const Box2d& area) const = 0;

    /// A proved upper bound of |height(p) - height(q)| / |p - q| over all p, q in the area.
    virtual double slope_bound(const Box2d& area) const = 0;

    /// Where the height says something; infinite sides are allowed.
    virtual Box2d domain() const = 0;

    /// Proved enclosures of the gradient's components over the area, one-sided gradients included.
    virtual std::array<Interval, 2> gradient_range(const Box2d& area) const
    {
        const double slope = slope_bound(area);
        return {Interval{-slope, slope}, Interval{-slope, slope}};
    }

    /// A proved upper bound of |gradient(p) - gradient(q)| / |p - q| in the area; infinite where the gradient jumps or nothing is known.
    virtual double curvature_bound(const Box2d&) const { return kInfinity; }

    /// All of it at once: where the parts share their work, an override saves it.
    virtual HeightBounds bounds(const Box2d& area) const { return {range(area), slope_bound(area), curvature_bound(area), gradient_range(area)}; }
};

/// A height as an implicit function: F = z - h(x, y). Keeps a reference.
class HeightAsField final : public Field
{
public:
    explicit HeightAsField(const Height& height) : height_(height) {}

    double value(const Vec3d& p) const override { return p.z - height_.height({p.x, p.y}); }
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;
    std::array<Interval, 3> gradient_range(const Box3d& box) const override;
    double curvature_bound(const Box3d& box) const override;

private:
    const Height& height_;
};

/// The area that a box or a segment stands over.
inline Box2d area_under(const Box3d& box)
{
    return {{box.min.x, box.min.y}, {box.max.x, box.max.y}};
}
Box2d area_under(const Segment& segment);

}  // namespace hoodoo
