// Which instruction set the hot kernels use: the best one the processor has, or the one HOODOO_ISA forces. The pictures are the same bits.
#pragma once

#include <string>

namespace hoodoo
{

enum class Isa { sse4, avx2, avx512 };

/// Read once, at the first call. Throws Error (scene) if HOODOO_ISA names no instruction set, or one that the processor or this build lacks.
Isa selected_isa();
std::string isa_name(Isa isa);

/// The matching configuration text for Embree, so that its traversal uses the same instructions.
const char* embree_isa_option(Isa isa);

}  // namespace hoodoo
