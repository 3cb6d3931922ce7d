// OpenVDB's polygoniser, behind one door: samples of a function in, quadrilaterals out.
#pragma once

#include "terrain/math/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hoodoo
{

/// Values at 8 x 8 x 8 points of an integer lattice from `corner` on (coordinates are multiples of 8), z fastest; negative inside matter.
struct LatticeBlock {
    std::array<int, 3> corner{};
    std::array<float, 512> values{};
};

/// Points in units of the lattice. Quadrilaterals turn counter-clockwise seen from the air.
struct LatticeMesh {
    std::vector<Vec3f> points;
    std::vector<std::array<std::uint32_t, 4>> quads;
};

/// The zero surface of the sampled blocks. `solid` are corners of blocks that lie in matter as a whole; everything else is air. One point for each
/// piece of surface in a cell: a function of the samples around it, so that tiles which share samples share points to the bit.
/// Throws Error (internal) if the library was built without OpenVDB.
LatticeMesh lattice_surface(std::span<const LatticeBlock> sampled, std::span<const std::array<int, 3>> solid);

}  // namespace hoodoo
