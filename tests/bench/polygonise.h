// The same surface as a triangle mesh: what every comparison is against.
#pragma once

#include "terrain/march/patches.h"
#include "terrain/shape.h"
#include "terrain/stack/convolution.h"

namespace hoodoo::bench
{

/// OpenVDB's polygoniser on samples `spacing` metres apart, taken only near the patches' boxes. Quadrilaterals are split in two.
TriangleMesh polygonise(const ConvolutionField& field, const PatchIntersector& patches, double spacing);

}  // namespace hoodoo::bench
