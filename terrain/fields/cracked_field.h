// A height with cracks in it, as one implicit function: matter is where z <= h'(x, y), and the walls between are exactly vertical.
#pragma once

#include "terrain/fields/crack_network.h"
#include "terrain/fields/height.h"

#include <memory>

namespace hoodoo
{

/// Immutable, thread-safe. World metres, except where a function says "local": then x and y count from the lower corner of region().
class CrackedField final : public Field
{
public:
    /// The network's places count from the lower corner of `region`; `zero` and `one` are the elevations that count as height 0 and 1, zero < one.
    CrackedField(std::shared_ptr<const Height> ground, CrackNetwork network, const CrackDepth& depth, const Box2d& region, double zero, double one);

    const Height& ground() const { return *ground_; }
    const CrackNetwork& network() const { return network_; }
    const CrackDepth& depth() const { return depth_; }
    double zero() const { return zero_; }
    double one() const { return zero_ + span_; }
    /// The rectangle whose ground is cracked, world.
    const Box2d& region() const { return region_; }
    Vec2d local(const Vec2d& p) const { return p - region_.min; }

    /// The crack map: whether aleph = 1 (Li2023, equation 4).
    bool cracked(const Vec2d& p) const { return network_.cracked(local(p)); }
    /// h' in metres (equation 1).
    double height(const Vec2d& p) const;
    /// iota of the ground there (equations 2 and 3): 1 below the border line, 0 above it and its error.
    double iota(const Vec2d& p) const { return depth_.iota((ground_->height(p) - zero_) / span_); }

    /// For a piece of a ray: F = lifted(z) - h, with lifted(z) = z outside of cracks; its sign is that of z - h'.
    double lifted(double z, bool in_crack) const { return in_crack ? zero_ + span_ * depth_.ground((z - zero_) / span_) : z; }
    /// The derivative of lifted(z) in a crack.
    double lifted_slope(double z) const { return depth_.ground_slope((z - zero_) / span_); }
    /// The elevations at which that jumps, in order.
    std::array<double, 3> kinks() const;
    /// A proved bound of how fast it changes over these elevations, between which no kink lies.
    double lifted_bend(const Interval& z) const { return depth_.ground_bend({(z.lo - zero_) / span_, (z.hi - zero_) / span_}) / span_; }
    /// The elevation of a crack's floor in ground of elevation `h`.
    double floor(double h) const { return zero_ + span_ * depth_.floor((h - zero_) / span_); }

    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;

private:
    std::shared_ptr<const Height> ground_;
    CrackNetwork network_;
    CrackDepth depth_;
    Box2d region_;
    double zero_, span_;
};

}  // namespace hoodoo
