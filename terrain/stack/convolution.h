// The convolution surface of a layer stack (Peytavie2009, section 3.3): the share of matter in a cube, against one half.
#pragma once

#include "terrain/field.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// f(p) = 1 - V(p) / (4 sigma^3), V the volume of ground in the cube p +- sigma: in [-1, 1], negative inside, trilinear between breakpoints
/// (the paper's eq. with the opposite sign). Exact in double up to rounding, from the stack's integer heights. Any sigma > 0, metres.
class ConvolutionField final : public Field
{
public:
    ConvolutionField(Ground ground, double sigma);

    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;
    std::array<Interval, 3> gradient_range(const Box3d& box) const override;

    const Ground& ground() const { return ground_; }
    double sigma() const { return sigma_; }

    /// What shading needs at one point: value, gradient and smoothed gradient.
    struct Neighbourhood {
        double value;
        Vec3d gradient, smoothed;
    };
    /// The three functions at `p` in one walk over the columns: the same numbers up to rounding, several times faster.
    Neighbourhood neighbourhood(const Vec3d& p, double width) const;

    /// Central differences with half-width `width`: the exact gradient averaged over a segment of 2 width along each axis, so continuous.
    /// Where its length is under 1e-3 / sigma it is replaced by the direction to the nearest interface of the column (maths A4). Not normalised.
    Vec3d smoothed_gradient(const Vec3d& p, double width) const;

    /// A vector of length 1 / sigma away from the nearest side of matter in the column of `p`.
    Vec3d towards_nearest_interface(const Vec3d& p) const;

private:
    Ground ground_;
    double sigma_;
};

}  // namespace hoodoo
