// h = sum h_i over layers in a fixed order (GalinCourse, "Layered representations"; Benes2001) against columns of any order (Peytavie2009). A fixed
// order is a column of at most three layers; the way back exists for columns that are one. Missing: more than three materials.
#include "terrain/stack/layer_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

double finest_unit(const LayerMaps& maps)
{
    double low = kInfinity, high = -kInfinity;
    for (std::size_t k = 0; k < maps.bedrock.size(); ++k) {
        low = std::min(low, maps.bedrock[k]);
        high = std::max(high, maps.top(k));
    }
    // One step for the datum, one for rounding.
    return std::max(high - low, 1e-3 * maps.cell) / (MaterialStack::max_top - 2);
}

MaterialStack to_stack(const LayerMaps& maps, double unit)
{
    for (std::size_t k = 0; k < maps.bedrock.size(); ++k) {
        const auto column = [&] {
            return fmt::format("column ({}, {})", k % static_cast<std::size_t>(maps.size.x), k / static_cast<std::size_t>(maps.size.x));
        };
        if (!std::isfinite(maps.top(k))) throw Error(ErrorKind::scene, Problem{{}, "a layer's map", "finite numbers", column(), {}});
        if (maps.sand[k] < 0.0 || maps.water[k] < 0.0)
            throw Error(
                ErrorKind::scene,
                Problem{{}, "the thickness of a layer", "0 or more", fmt::format("{} m in {}", std::min(maps.sand[k], maps.water[k]), column()), {}});
    }
    const auto units = [&](double z) { return std::llround(z / unit); };
    const auto datum = static_cast<long long>(std::floor(*std::min_element(maps.bedrock.begin(), maps.bedrock.end()) / unit + 0x1p-20));
    MaterialStack stack(maps.size, maps.cell, unit, Vec3d(maps.origin.x, maps.origin.y, static_cast<double>(datum) * unit));
    std::vector<std::vector<Layer>> columns(maps.bedrock.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
        const long long tops[3] = {units(maps.bedrock[k]) - datum, units(maps.ground(k)) - datum, units(maps.top(k)) - datum};
        if (tops[2] > MaterialStack::max_top)
            throw Error(
                ErrorKind::scene,
                Problem{
                    {}, "the layers are too high for this unit", fmt::format("at least {:.6g} m", finest_unit(maps)), fmt::format("{} m", unit), {}});
        constexpr Material kinds[3] = {Material::bedrock, Material::sand, Material::water};
        for (int n = 0; n < 3; ++n)
            if (tops[n] > (n == 0 ? 0 : tops[n - 1])) columns[k].push_back({kinds[n], static_cast<std::int32_t>(tops[n])});
    }
    stack.set_columns({0, 0}, maps.size, columns);
    return stack;
}

LayerMaps from_stack(const MaterialStack& stack, const Source& where)
{
    LayerMaps maps;
    maps.size = stack.size();
    maps.cell = stack.cell();
    maps.origin = {stack.origin().x, stack.origin().y};
    for (int j = 0; j < maps.size.y; ++j) {
        for (int i = 0; i < maps.size.x; ++i) {
            std::int32_t tops[3] = {0, 0, 0}, below = 0;
            int reached = 0;
            for (const Layer& layer : stack.column(i, j)) {
                const int n = layer.material == Material::bedrock ? 0
                              : layer.material == Material::sand  ? 1
                              : layer.material == Material::water ? 2
                                                                  : -1;
                if (n < reached)
                    throw Error(ErrorKind::scene, Problem{where,
                                                          "layers of another order",
                                                          "bedrock, sand, water from the bottom up",
                                                          fmt::format("{} in column ({}, {})", material_name(layer.material), i, j),
                                                          {}});
                for (int m = reached; m < n; ++m) tops[m] = below;
                tops[n] = below = layer.top;
                reached = n;
            }
            for (int m = reached + 1; m < 3; ++m) tops[m] = below;
            // Whole numbers of units, datum included, so that heights are those that were rounded.
            const double datum = std::round(stack.origin().z / stack.unit());
            maps.bedrock.push_back((datum + tops[0]) * stack.unit());
            maps.sand.push_back((tops[1] - tops[0]) * stack.unit());
            maps.water.push_back((tops[2] - tops[1]) * stack.unit());
        }
    }
    return maps;
}

}  // namespace hoodoo
