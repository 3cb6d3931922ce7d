// Any field carried along a flow: its zero set is the warped surface.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/warp.h"

#include <memory>

namespace hoodoo
{

class BlobNode;

/// What is known of a field over a box (and a span of durations).
struct LocalField {
    Interval value{-kInfinity, kInfinity};
    double centre = 0.0;               ///< the value at the centre (and at the middle of the span)
    std::array<Interval, 3> gradient;  ///< its components
    /// Bounds of the second derivative along a unit direction with a horizontal part c and a vertical part s: curvature c^2 + mixed 2 c |s| + upright
    /// s^2. Where all directions are alike upright = curvature, mixed = 0.
    double curvature = kInfinity, mixed = 0.0, upright = kInfinity;
    double sway = kInfinity;  ///< |value at the centre - centre| over the span is at most this; infinite: unknown

    double slope() const;                         ///< the largest length of a gradient
    double slope_along(const Vec3d& unit) const;  ///< the largest derivative along a direction, as a magnitude
    double curvature_along(const Vec3d& unit) const { return curvature_along(curvature, mixed, upright, unit); }
    static double curvature_along(double curvature, double mixed, double upright, const Vec3d& unit);
};

/// F(p) = base(Phi^-1(p)): value, gradient and bounds of a base carried along a flow (Gamito2001). As a Field it has one duration; an animated warp
/// asks with its own.
class WarpedField final : public Field
{
public:
    WarpedField(std::shared_ptr<const Field> base, Warp warp, double duration);

    double value(const Vec3d& p) const override { return value(p, duration_); }
    Vec3d gradient(const Vec3d& p) const override { return gradient(p, duration_); }
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;
    std::array<Interval, 3> gradient_range(const Box3d& box) const override { return local(box, {duration_, duration_}).gradient; }
    double curvature_bound(const Box3d& box) const override { return local(box, {duration_, duration_}).curvature; }

    double value(const Vec3d& p, double duration) const { return base_->value(warp_.inverse(p, duration)); }
    Vec3d gradient(const Vec3d& p, double duration) const;
    /// `image`, if wanted, becomes a box around where the points came from.
    LocalField local(const Box3d& box, const Interval& durations, Box3d* image = nullptr) const;

    const Field& base() const { return *base_; }
    const Warp& warp() const { return warp_; }
    double duration() const { return duration_; }

private:
    LocalField base_local(const Box3d& box) const;

    std::shared_ptr<const Field> base_;
    const WarpedField* inner_;  ///< the base, if it is warped itself, or
    const BlobNode* blob_;      ///< if it is a node: it knows all about a box at once
    Warp warp_;
    double duration_;
};

}  // namespace hoodoo
