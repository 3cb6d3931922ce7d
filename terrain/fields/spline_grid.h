// A smooth height from a grid of numbers: the uniform bicubic B-spline with these coefficients. It has two continuous derivatives, and all of it is
// enclosed by coefficients and their differences.
#pragma once

#include "terrain/fields/height.h"

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// Coefficient (i, j) belongs to the node origin + (i, j) cell; row by row, columns fastest. The spline follows samples taken for coefficients, but
/// not through them: it averages each with its neighbours by 1/6, 4/6, 1/6. Immutable, thread-safe. Metres.
class SplineGrid final : public Height
{
public:
    /// At least 4 x 4 coefficients. Throws Error (internal) for fewer.
    SplineGrid(const Vec2d& origin, double cell, int columns, int rows, std::vector<float> coefficients);

    double height(const Vec2d& p) const override;
    Vec2d gradient(const Vec2d& p) const override;
    Interval range(const Box2d& area) const override { return bounds(area).value; }
    double slope_bound(const Box2d& area) const override { return bounds(area).slope; }
    /// Where every coefficient that counts exists: one cell within the outermost nodes.
    Box2d domain() const override { return domain_; }
    std::array<Interval, 2> gradient_range(const Box2d& area) const override { return bounds(area).gradient; }
    double curvature_bound(const Box2d& area) const override { return bounds(area).curvature; }
    HeightBounds bounds(const Box2d& area) const override;

    std::uint64_t memory_bytes() const { return coefficients_.size() * sizeof(float); }

private:
    struct Place {
        int i, j;
        double s, t;
    };
    Place place(const Vec2d& p) const;
    double at(int i, int j) const
    {
        return coefficients_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)];
    }
    HeightBounds enclose(int i0, int i1, int j0, int j1) const;

    Vec2d origin_;
    double cell_;
    int columns_, rows_;
    std::vector<float> coefficients_;
    Box2d domain_;
    HeightBounds whole_;
};

}  // namespace hoodoo
