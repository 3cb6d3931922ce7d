// Rays that find faults: tangent ones, ones that start at the surface, ones along axes and in lattice planes, and ordinary ones.
#pragma once

#include "terrain/stack/convolution.h"

#include <cstdint>

namespace hoodoo::testing
{

/// Ray number n of a fixed sequence: of ten, two or three are tangent to the surface (|normal . direction| < 0.02), one starts within the kernel's
/// reach of it, one is parallel to an axis or lies in a plane where the field bends; the others aim at the surface's neighbourhood from all sides.
/// Half of them ask for any crossing, half for entering ones.
Ray test_ray(const ConvolutionField& field, std::uint64_t seed, std::uint64_t n);

}  // namespace hoodoo::testing
