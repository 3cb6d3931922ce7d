// A layer stack as a surface that stays alive while its stack is edited: what an editor holds between strokes.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"
#include "terrain/surface.h"

#include <memory>

namespace hoodoo
{

/// A Surface that follows edits of its stack. The owner changes the stack in place (edit/tools.h), then calls rebuild with the columns that changed,
/// then Tracer::update with the tiles that rebuild returns; none of the three while other threads trace.
class EditableSurface : public Surface
{
public:
    /// Makes the tiles that read these columns anew, exactly as a new surface would, and returns them, ascending. Its cost follows the
    /// columns, but for water.
    virtual std::vector<std::uint32_t> rebuild(const ColumnSet& changed) = 0;

    /// Space that edits of the stack can come to fill, metres.
    virtual Box3d room() const = 0;
};

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
