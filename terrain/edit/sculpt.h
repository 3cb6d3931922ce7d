// Displacing the bedrock along its normal, a ball at a time (Peytavie2009, section 4.1).
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// One stroke: world metres. The ball's centre is `depth` inside the surface under `vertex` when it adds, outside when it takes away.
struct Stroke {
    Vec3d vertex{0.0};          ///< on the surface of the bedrock
    Vec3d normal{0.0, 0.0, 1};  ///< unit, towards air, there
    double radius = 1.0;        ///< R
    double depth = 0.5;         ///< delta, 0 to R
    bool adds = true;
};

/// Changes only the columns under the ball, and in them only what changes its side: untouched parts keep their bits. Does not settle loose material.
/// `sigma` (metres) is the kernel of the field that is sculpted. Returns the columns that changed. Throws Error (scene) if bedrock would rise over
/// the stack's height range; the stack is then as it was.
ColumnSet sculpt(MaterialStack& stack, double sigma, const Stroke& stroke);

}  // namespace hoodoo
