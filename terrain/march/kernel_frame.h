// The frame in which sphere tracing works: cells across, units of height upwards, and the lines where the field bends.
#pragma once

#include "terrain/stack/convolution.h"

#include <cmath>
#include <vector>

namespace hoodoo
{

/// Frame coordinates of a point: X = (x - origin.x) / cell, Y likewise, Z = (z - origin.z) / unit: the stack's integers are exact in it.
struct KernelFrame {
    double cell = 1.0, unit = 1.0;
    Vec3d origin{0.0};
    double reach = 0.0;   ///< sigma in cells
    double height = 0.0;  ///< sigma in units
    double scale = 0.0;   ///< f = 1 - scale * (sum of overlaps, in cells^2 units)
    double floor = 0.0;   ///< of the ground, in units
    /// Matter is f < delta, so that f = 0 on a whole region (a straight wall on a lattice plane, a sheet as thick as sigma) is matter for
    /// every patch alike, whatever rounding does. Far above the rounding of f (1e-13), far below what can be seen.
    static constexpr double delta = 1e-10;
    /// Two computations of f at one point differ by less.
    static constexpr double rounding = 1e-12;

    explicit KernelFrame(const ConvolutionField& field)
    {
        const MaterialStack& stack = field.ground().stack();
        cell = stack.cell(), unit = stack.unit(), origin = stack.origin();
        reach = field.sigma() / cell;
        // A width that misses half a cell by rounding would make slivers between lines.
        const double halves = std::round(2.0 * reach);
        if (halves >= 1.0 && std::abs(2.0 * reach - halves) < 1e-12 * halves) reach = 0.5 * halves;
        height = field.sigma() / unit;
        scale = 1.0 / (4.0 * reach * reach * height);
        floor = field.ground().floor();
    }

    Vec3d point(const Vec3d& p) const { return {(p.x - origin.x) / cell, (p.y - origin.y) / cell, (p.z - origin.z) / unit}; }
    Vec3d direction(const Vec3d& d) const { return {d.x / cell, d.y / cell, d.z / unit}; }
    Vec3d world(const Vec3d& q) const { return {origin.x + q.x * cell, origin.y + q.y * cell, origin.z + q.z * unit}; }

    int first_column(double x) const { return static_cast<int>(std::floor(x - reach)); }
    int last_column(double x) const { return static_cast<int>(std::floor(x + reach)); }
    /// Width of column i under the kernel at x, in cells.
    double overlap(double x, int i) const { return std::max(0.0, std::min(x + reach, i + 1.0) - std::max(x - reach, static_cast<double>(i))); }

    /// The nearest line above (forward) or below x where a face of the kernel passes a column's side: i +- reach, i an integer.
    double next_line(double x, bool forward) const
    {
        if (forward) return std::min(std::floor(x - reach) + 1.0 + reach, std::floor(x + reach) + 1.0 - reach);
        return std::max(std::ceil(x - reach) - 1.0 + reach, std::ceil(x + reach) - 1.0 - reach);
    }
};

}  // namespace hoodoo
