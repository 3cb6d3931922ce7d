// A layer stack as a surface that stays alive while its owner edits the stack.
#pragma once

#include "terrain/editable.h"
#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

#include <memory>

namespace hoodoo
{

class Values;
struct BuildContext;

/// What the catalogue's row makes of its parameters. Throws Error (scene, file).
Shape make_convolution(const Values& values, const BuildContext& context);

struct ConvolutionOptions {
    MaterialSet materials = material_set({Material::sand, Material::bedrock, Material::soil});  ///< one smooth body
    bool rocks = true;   ///< rock as a body of its own, even if there is none yet
    bool water = false;  ///< water as a body of its own, even if there is none yet; edits then make all of it anew, wherever they are
    double sigma = 0.0;  ///< half-width of the kernel, metres; 0: one cell
    Border border = Border::extend;
    double base = 0.0;           ///< of a cut block, metres below the stack's origin
    bool exact = true;           ///< closed form where 2 sigma is a multiple of the cell; false: sphere tracing always
    double normal_width = 0.75;  ///< cells
};

/// Throws Error (scene) if sigma or base cannot be.
std::unique_ptr<EditableSurface> make_convolution_surface(std::shared_ptr<const MaterialStack> stack, const ConvolutionOptions& options = {});

}  // namespace hoodoo
