// Which materials of a stack are seen, and the numbers by which an Interaction names them.
#pragma once

#include "terrain/stack/columns_around.h"
#include "terrain/stack/convolution.h"
#include "terrain/surface.h"

#include <array>
#include <string>
#include <vector>

namespace hoodoo
{

/// A value; empty at first.
class StackMaterials
{
public:
    /// Makes room for these materials too. Numbers follow the order of Material, so that they do not depend on the order of calls.
    void show(MaterialSet set);
    /// The number of a name that may be none of the stack's materials; it is appended if it is new. After all calls of show.
    std::uint8_t show(const std::string& name);

    const std::vector<std::string>& names() const { return names_; }

    /// All of `at` is of that material.
    void dress(Material material, Interaction& at) const { at.materials.add(number_[static_cast<std::size_t>(material)], 1.0f); }
    /// The materials of `set` by the area of each that the kernel's box around at.position sees (Peytavie2009, section 5; stack/visible.h).
    void blend(const ConvolutionField& field, MaterialSet set, const ColumnsAround& near, Interaction& at) const;

private:
    MaterialSet set_ = 0;
    std::vector<std::string> names_;
    std::array<std::uint8_t, kMaterialCount> number_{};
};

}  // namespace hoodoo
