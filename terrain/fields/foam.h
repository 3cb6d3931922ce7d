// Foam and spray of a breaking sea: white lines and patches on the water, and a density of droplets over lip, seam and white water.
#pragma once

#include "terrain/density.h"
#include "terrain/fields/breaking_sea.h"

#include <cstdint>

namespace hoodoo
{

struct FoamShape {
    double cover = 1.0;   ///< on the water; 0: none
    double lace = 1.5;    ///< meshes of the foam that has come to rest, metres
    double spray = 1.0;   ///< density at its thickest, in [0, 1]
    double height = 0.6;  ///< of the spray over the water, metres
    double puff = 0.8;    ///< largest scale of its clouds, metres
    std::uint32_t seed = 0;
};

/// Immutable, thread-safe; keeps a reference to the sea, whose own coordinates are `origin` less than the world's. Times are Ray::time: 0 and 1 are
/// the seconds `open` and `close`.
class SeaFoam final : public Density
{
public:
    SeaFoam(const BreakingSea& sea, const FoamShape& shape, const Vec3d& origin, double open, double close);

    double value(const Vec3d& p, double time) const override;
    double majorant(const Box3d& box, const Interval& times) const override;
    Box3d bounds() const override { return bounds_; }

    /// Share of the water's surface that is white at `p` (sea coordinates, on the surface), where the water was at rest at `rest`; in [0, 1].
    /// Details under twice the footprint are replaced by their mean.
    double cover(const Vec3d& p, const Vec3d& rest, double t, double footprint) const;

private:
    double weight(const BreakerPoint& at, const Breaker& b) const;
    double weight_bound(const Breaker& b, const Box3d& box, const Interval& times) const;
    double seconds(double time) const { return open_ + (close_ - open_) * time; }
    Box3d find_bounds() const;

    const BreakingSea& sea_;
    FoamShape shape_;
    Vec3d origin_;
    double open_, close_;
    Box3d bounds_;
};

}  // namespace hoodoo
