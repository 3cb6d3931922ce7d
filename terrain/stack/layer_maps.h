// Layers in a fixed order as maps: bedrock, sand on it, water on that; and the same as columns of any order.
#pragma once

#include "terrain/error.h"
#include "terrain/stack/material_stack.h"

#include <vector>

namespace hoodoo
{

/// One number a column, i fastest, j = 0 in the south. Metres.
struct LayerMaps {
    Vec2i size{0, 0};
    double cell = 1.0;
    Vec2d origin{0.0};            ///< south-western corner of the grid; columns' middles lie half a cell inwards
    std::vector<double> bedrock;  ///< height of its top
    std::vector<double> sand;     ///< thickness, 0 or more
    std::vector<double> water;    ///< thickness, 0 or more

    std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(i); }
    /// Top of sand, and of water where there is any.
    double ground(std::size_t k) const { return bedrock[k] + sand[k]; }
    double top(std::size_t k) const { return ground(k) + water[k]; }
};

/// The finest unit in which to_stack can hold the maps.
double finest_unit(const LayerMaps& maps);

/// Each top rounded to the unit; maps in whole units come back as they were. The stack's origin is the whole unit at or below the lowest bedrock.
/// Throws Error (scene) where a thickness is negative or a number is not finite (naming the column), or the unit is too fine.
MaterialStack to_stack(const LayerMaps& maps, double unit);

/// The reverse, exact. Throws Error (scene) at `where`, naming the column, if a column is anything but bedrock, sand, water in that order.
LayerMaps from_stack(const MaterialStack& stack, const Source& where);

}  // namespace hoodoo
