// A ground whose plates, between cracks, curl up along their edges.
#pragma once

#include "terrain/fields/crack_network.h"
#include "terrain/fields/height.h"

#include <memory>

namespace hoodoo
{

/// height = ground + rise (1 - s / reach)^2 for s < reach, s a smooth distance to the borders of the point's cell: continuous everywhere, and smooth
/// but on the borders themselves, which lie in cracks. Immutable, thread-safe.
class CurledHeight final : public Height
{
public:
    /// The diagram's places count from `corner` (world). `rise`, metres, may be below 0: plates that bulge. `reach` > 0, metres.
    CurledHeight(std::shared_ptr<const Height> ground, VoronoiDiagram diagram, const Vec2d& corner, double rise, double reach);

    double height(const Vec2d& p) const override;
    Vec2d gradient(const Vec2d& p) const override;
    Interval range(const Box2d& area) const override;
    double slope_bound(const Box2d& area) const override;
    Box2d domain() const override { return ground_->domain(); }
    double curvature_bound(const Box2d& area) const override;

    /// s = (sum over the cell's borders of distance^-4)^(-1/4), metres: at most the distance to the nearest one, 0 on it, infinite with a single
    /// site. 1-Lipschitz.
    double smooth_distance(const Vec2d& p) const { return smooth_distance(p, nullptr); }

private:
    double smooth_distance(const Vec2d& p, Vec2d* gradient) const;
    /// Enclosure of the smooth distance over an area.
    Interval distance_range(const Box2d& area) const;
    Vec2d inside(const Vec2d& p) const;

    std::shared_ptr<const Height> ground_;
    VoronoiDiagram diagram_;
    Vec2d corner_;
    double rise_, reach_;
};

}  // namespace hoodoo
