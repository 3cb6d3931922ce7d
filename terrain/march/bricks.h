// Where in a tile the surface can be, and how steep the field is there: proved boxes with bounds of the gradient.
#pragma once

#include "terrain/march/kernel_frame.h"

#include <array>
#include <cstdint>

namespace hoodoo
{

/// A box that may hold surface: lines lx[x0]..lx[x1] by ly[y0]..ly[y1] of its tile, z0..z1, all in frame units. Outside all boxes of a tile the field
/// is on one side by more than KernelFrame::rounding.
struct Brick {
    double z0, z1;
    std::uint16_t x0, x1, y0, y1;
    std::array<float, 3> slope_lo, slope_hi;  ///< of the gradient's components in the box, rounded outwards; per frame unit
};

/// The lines of a tile across which the field bends, its own border included, ascending.
struct TileLines {
    std::vector<double> x, y;
};

TileLines tile_lines(const KernelFrame& frame, const Vec2d& lo, const Vec2d& hi);

/// Bricks of about `edge` cells.
std::vector<Brick> make_bricks(const Ground& ground, const KernelFrame& frame, const TileLines& lines, int edge);

}  // namespace hoodoo
