// The frame in which a convolution field is trilinear: lattice cells across, units of height upwards.
//
// The field of a stack (Peytavie2009) is trilinear between the planes where a face of the kernel cube passes a column's side or a layer's
// top. If 2 sigma is a multiple of the cell, these planes are one lattice line a cell and axis, and the kernel at a lattice vertex covers
// K x K whole columns. Its volume, in cell^2 times unit, is then a sum of integers at every knot, if 2 sigma is a whole number of units too.
#pragma once

#include "terrain/stack/convolution.h"

#include <cmath>

namespace hoodoo
{

/// Lattice coordinates of a point: X = (x - origin.x) / cell - shift, Y likewise, Z = (z - origin.z + sigma) / unit.
/// Lattice vertex (a, b) lies at X = a, Y = b; knots lie at Z = top and Z = top + height of the kernel.
/// F = value_scale * f is what is stored: an integer at knots if `whole`. The surface traced is F = delta, a hair outside F = 0:
/// a vertical wall has f = 0 on a whole lattice plane, which no cell would own.
struct Lattice {
    int kernel = 0;            ///< K = 2 sigma / cell: columns under the kernel along one axis
    double shift = 0.0;        ///< 0 if K is even, 1/2 if it is odd
    double height = 0.0;       ///< of the kernel, 2 sigma / unit
    bool whole = false;        ///< height is an integer
    double factor = 1.0;       ///< of the sum of overlaps: 1 or 2, so that F is an integer where height is
    double value_scale = 1.0;  ///< F at f = 1
    double delta = 0.0;
    double cell = 1.0, unit = 1.0, sigma = 0.0;
    Vec3d origin{0.0};

    Vec3d point(const Vec3d& p) const { return {(p.x - origin.x) / cell - shift, (p.y - origin.y) / cell - shift, (p.z - origin.z + sigma) / unit}; }
    Vec3d direction(const Vec3d& d) const { return {d.x / cell, d.y / cell, d.z / unit}; }
    Vec3d world(const Vec3d& q) const { return {origin.x + (q.x + shift) * cell, origin.y + (q.y + shift) * cell, origin.z + q.z * unit - sigma}; }
    /// First column under the kernel of lattice vertex a, along either axis.
    int first_column(int a) const { return a - kernel / 2; }
};

/// True if 2 sigma is a multiple of the cell, up to rounding.
inline bool has_lattice(double sigma, double cell)
{
    const double k = 2.0 * sigma / cell;
    return std::round(k) >= 1.0 && std::abs(k - std::round(k)) < 1e-9 * k;
}

inline Lattice make_lattice(const ConvolutionField& field)
{
    const MaterialStack& stack = field.ground().stack();
    Lattice l;
    l.sigma = field.sigma();
    l.cell = stack.cell();
    l.unit = stack.unit();
    l.origin = stack.origin();
    l.kernel = static_cast<int>(std::lround(2.0 * l.sigma / l.cell));
    l.shift = l.kernel % 2 ? 0.5 : 0.0;
    l.height = 2.0 * l.sigma / l.unit;
    l.whole = std::abs(l.height - std::round(l.height)) < 1e-9 * l.height;
    if (l.whole) l.height = std::round(l.height);
    const double columns = static_cast<double>(l.kernel) * l.kernel;
    l.factor = l.whole && std::fmod(columns * l.height, 2.0) != 0.0 ? 2.0 : 1.0;
    l.value_scale = l.factor * columns * l.height / 2.0;
    // Far above the rounding of a point's coordinates times the field's slope, far below what can be seen. Values that are
    // kept as floats (not whole) are rounded by 2^-24 of their size, so they need more.
    l.delta = l.whole ? 0x1p-16 : 0x1p-20 * l.value_scale;
    return l;
}

}  // namespace hoodoo
