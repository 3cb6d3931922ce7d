// Which materials are seen at a point of the surface, and in what shares (maths A10): what a shader blends by.
#pragma once

#include "terrain/stack/convolution.h"

#include <array>
#include <optional>

namespace hoodoo
{

/// Area of each material's boundary towards transparent material (everything outside `opaque`) inside the cube p +- sigma, m2.
/// Horizontal tops and undersides and vertical sides all count. Exact up to rounding.
std::array<double, kMaterialCount> visible_areas(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p);

/// The one opaque material of all columns that the cube p +- sigma touches, if there is just one: then no areas need to be measured.
std::optional<Material> only_visible(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p);

}  // namespace hoodoo
