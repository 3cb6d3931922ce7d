// Heights as functions of the plane, for layers that no file gives: named shapes with parameters.
#pragma once

#include "terrain/schema.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace hoodoo
{

/// Metres at a point of the plane (metres). Pure. May be +infinity where a shape says nothing (a canyon, beyond its rims).
using HeightFunction = std::function<double(const Vec2d&)>;

/// Parameters of the shapes fractal, mesa and canyon, by name; without those that every layer has.
std::vector<Schema> height_shape_schemas();

/// beds, bed_contrast, bed_seed: of every shape, and of heights from elsewhere that may be bedded too.
std::vector<Parameter> bed_parameters();

/// What the bed parameters make of even heights between `low` and `high`; nothing if `beds` is absent.
std::function<double(double)> make_beds(const Values& values, double low, double high, std::uint64_t seed);

/// The function of one table whose variant() names its shape. `seed` is the layer's own.
HeightFunction make_height_shape(const Values& values, std::uint64_t seed);

}  // namespace hoodoo
