// A pocket is what lies between two layers of bedrock; what is loose in it falls to its floor, sorted by material.
// Peytavie2009, section 4.3: sand below rock. CHOICES the paper leaves open: water lies above both, or it would carry stones; soil lies on sand and
// under rock, because stones on the ground must stay visible, and soil forms on what lies there.
#include "terrain/stack/merge_and_sort.h"

namespace hoodoo
{

std::vector<Layer> merge_and_sort(std::span<const Layer> layers)
{
    std::vector<Layer> settled;
    std::array<std::int32_t, kMaterialCount> loose{};
    std::int32_t top = 0;
    const auto put = [&](Material material, std::int32_t thickness) {
        if (thickness == 0) return;
        top += thickness;
        if (!settled.empty() && settled.back().material == material)
            settled.back().top = top;
        else
            settled.push_back({material, top});
    };
    const auto settle = [&] {
        for (const Material m : kLooseOrder) put(m, loose[static_cast<std::size_t>(m)]);
        put(Material::air, loose[static_cast<std::size_t>(Material::air)]);
        loose.fill(0);
    };
    std::int32_t below = 0;
    for (const Layer& layer : layers) {
        if (layer.material == Material::bedrock) {
            settle();
            put(Material::bedrock, layer.top - below);
        } else {
            loose[static_cast<std::size_t>(layer.material)] += layer.top - below;
        }
        below = layer.top;
    }
    loose[static_cast<std::size_t>(Material::air)] = 0;  // open above: the air on top has no thickness
    settle();
    return settled;
}

}  // namespace hoodoo
