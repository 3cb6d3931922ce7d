// One material seen is the common case and costs nothing; several are weighed by their visible areas (Peytavie2009, section 5).
// Where no area is visible (a point inside matter that only rounding put there) the bedrock stands for all, else the first of the set.
#include "terrain/surfaces/stack_materials.h"

#include "terrain/stack/visible.h"

#include <algorithm>
#include <bit>

namespace hoodoo
{

void StackMaterials::show(MaterialSet set)
{
    set_ = static_cast<MaterialSet>(set_ | set);
    names_.clear();
    for (std::size_t m = 0; m < kMaterialCount; ++m) {
        number_[m] = static_cast<std::uint8_t>(names_.size());
        if ((set_ >> m) & 1u) names_.push_back(material_name(static_cast<Material>(m)));
    }
}

std::uint8_t StackMaterials::show(const std::string& name)
{
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto number = static_cast<std::uint8_t>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return number;
}

void StackMaterials::blend(const ConvolutionField& field, MaterialSet set, const ColumnsAround& near, Interaction& at) const
{
    const unsigned around = near.materials() & set;
    if (std::has_single_bit(around)) return dress(static_cast<Material>(std::countr_zero(around)), at);
    if (const auto only = only_visible(field.ground(), set, field.sigma(), at.position)) return dress(*only, at);
    const auto areas = visible_areas(field.ground(), set, field.sigma(), at.position);
    double sum = 0.0;
    for (const double area : areas) sum += area;
    if (!(sum > 0.0)) {
        const bool bedrock = set & material_set({Material::bedrock});
        return dress(bedrock ? Material::bedrock : static_cast<Material>(std::countr_zero(static_cast<unsigned>(set))), at);
    }
    for (std::size_t m = 0; m < kMaterialCount; ++m) {
        if (areas[m] > 0.0) at.materials.add(number_[m], static_cast<float>(areas[m] / sum));
    }
}

}  // namespace hoodoo
