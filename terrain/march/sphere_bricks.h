// Certified sphere tracing of a convolution field inside proved bricks.
#pragma once

#include "terrain/march/patches.h"
#include "terrain/stack/convolution.h"

#include <memory>

namespace hoodoo
{

/// Any sigma. Keeps a reference to the field.
std::unique_ptr<PatchIntersector> make_sphere_bricks(const ConvolutionField& field);

}  // namespace hoodoo
