// Random stacks with overhangs, and the golden one, for tests.
#pragma once

#include "terrain/math/hash.h"
#include "terrain/stack/material_stack.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <memory>

namespace hoodoo::testing
{

inline nlohmann::json golden_arches()
{
    return nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/a_arches.json"));
}

/// The stack of a_arches.json. Its heights are multiples of 0.01: with that unit every value is exact.
inline std::shared_ptr<MaterialStack> golden_stack()
{
    const nlohmann::json data = golden_arches();
    auto stack = std::make_shared<MaterialStack>(Vec2i(data["nx"], data["ny"]), data["s"].get<double>(), 0.01);
    for (int i = 0; i < stack->size().x; ++i) {
        for (int j = 0; j < stack->size().y; ++j) {
            std::vector<Layer> column;
            for (const auto& layer : data["stacks"][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]) {
                column.push_back({static_cast<Material>(layer[0].get<int>()), static_cast<std::int32_t>(std::lround(layer[1].get<double>() * 100))});
            }
            stack->set_column(i, j, column);
        }
    }
    return stack;
}

/// Columns of up to five layers of random materials, air gaps among them: as rugged as a stack can be. Heights up to about `relief` units.
inline std::shared_ptr<MaterialStack> random_stack(std::uint64_t seed, Vec2i size, double cell, double unit, int relief, Vec3d origin = Vec3d(0.0))
{
    auto stack = std::make_shared<MaterialStack>(size, cell, unit, origin);
    std::vector<std::vector<Layer>> columns;
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) {
            std::vector<Layer> column;
            std::uint64_t h = hash_cell(seed, i, j);
            std::int32_t top = 0;
            for (int k = 0, n = 1 + static_cast<int>(h % 5); k < n; ++k) {
                h = mix64(h);
                top += 1 + static_cast<std::int32_t>(h % static_cast<unsigned>(relief / 4 + 1));
                const Material kinds[] = {Material::bedrock, Material::air, Material::sand, Material::bedrock, Material::rock, Material::soil};
                column.push_back({k == 0 ? Material::bedrock : kinds[(h >> 32) % 6], top});
            }
            columns.push_back(std::move(column));
        }
    }
    stack->set_columns({0, 0}, size, columns);
    return stack;
}

}  // namespace hoodoo::testing
