// A layer stack as a deep image: one pixel a column, one sample a layer.
#pragma once

#include "terrain/error.h"
#include "terrain/stack/material_stack.h"

#include <memory>
#include <string>

namespace hoodoo
{

/// Deep scanline EXR. Row 0 is the north (j = size.y - 1). The samples of a pixel are its layers from the bottom up: Z and ZBack are the bottom and
/// the top in metres above the stack's origin, `material` counts in the header's hoodoo:materials, A is 1; gaps between samples are air. The header
/// has hoodoo:cell, hoodoo:unit (metres) and hoodoo:origin in double precision. Equal stacks make equal bytes. Atomic and verified. Throws Error
/// (file).
void write_stack_file(const std::string& path, const MaterialStack& stack);

/// Reads what write_stack_file wrote, bit for bit; of a file changed elsewhere it rounds heights to the unit. Throws Error (file) at `where`: not
/// readable, a header that says too little, and, naming the column, samples that overlap, are unordered, unknown, outside the heights a stack can
/// hold, or cannot be decoded.
std::shared_ptr<MaterialStack> read_stack_file(const std::string& path, const Source& where);

}  // namespace hoodoo
