// The lattice cells in which a convolution field is trilinear, met in closed form.
#pragma once

#include "terrain/march/patches.h"
#include "terrain/stack/convolution.h"

#include <memory>
#include <optional>
#include <string>

namespace hoodoo
{

/// Empty if the exact intersector can be built for this field; otherwise why not (2 sigma is no multiple of the cell).
std::optional<std::string> why_not_exact(const ConvolutionField& field);

/// Keeps a reference to the field. Precondition: why_not_exact(field) is empty.
std::unique_ptr<PatchIntersector> make_exact_cells(const ConvolutionField& field);

}  // namespace hoodoo
