// The ground of the golden crack values, as a height and as the smallest surface that has one.
#pragma once

#include "terrain/fields/height.h"
#include "terrain/surface.h"

#include <cmath>

namespace hoodoo::testing
{

/// h(u, v) = level + 0.25 sin(5u + 1) cos(4v), (u, v) from a corner.
class WavyHeight final : public Height
{
public:
    explicit WavyHeight(double level = 0.45, const Vec2d& corner = Vec2d(0.0)) : level_(level), corner_(corner) {}
    double height(const Vec2d& p) const override
    {
        const Vec2d q = inside(p) - corner_;
        return level_ + 0.25 * std::sin(5.0 * q.x + 1.0) * std::cos(4.0 * q.y);
    }
    Vec2d gradient(const Vec2d& p) const override
    {
        const Vec2d q = inside(p) - corner_;
        return {1.25 * std::cos(5.0 * q.x + 1.0) * std::cos(4.0 * q.y), -std::sin(5.0 * q.x + 1.0) * std::sin(4.0 * q.y)};
    }
    Interval range(const Box2d& area) const override
    {
        const Vec2d low = inside(area.min), high = inside(area.max);
        const double h = height((low + high) * 0.5), reach = 1.25 * 0.5 * (high - low).length();
        return {std::max(h - reach, level_ - 0.25), std::min(h + reach, level_ + 0.25)};
    }
    /// (1.25 c c')^2 + (s s')^2 <= 1.25^2.
    double slope_bound(const Box2d&) const override { return 1.25; }
    /// Rows of the Hessian: 6.25 + 5 and 5 + 4.
    double curvature_bound(const Box2d&) const override { return 11.25; }
    Box2d domain() const override { return {corner_, corner_ + Vec2d(1.0)}; }

private:
    Vec2d inside(const Vec2d& p) const
    {
        return {std::min(std::max(p.x, corner_.x), corner_.x + 1.0), std::min(std::max(p.y, corner_.y), corner_.y + 1.0)};
    }
    double level_;
    Vec2d corner_;
};

/// Nothing to hit, but a height to stand on.
class WavyGround final : public Surface
{
public:
    explicit WavyGround(double level = 0.45, const Vec2d& corner = Vec2d(0.0)) : height_(level, corner) {}
    std::uint32_t patch_count(std::uint32_t) const override { return 0; }
    Box3d patch_bounds(PatchId) const override { return {}; }
    bool intersect(PatchId, const Ray&, Hit&) const override { return false; }
    Interaction interact(const Ray&, const Hit&) const override { return {}; }
    bool contains(const Vec3d& p) const override { return p.z <= height_.height({p.x, p.y}); }
    std::vector<std::string> materials() const override { return {"ground"}; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override { return {}; }
    const Height* height() const override { return &height_; }

private:
    WavyHeight height_;
};

}  // namespace hoodoo::testing
