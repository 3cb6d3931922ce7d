// Samples of a height grid that were never measured: how many, where, and heights in their place.
#pragma once

#include "terrain/fields/heightgrid.h"

#include <optional>

namespace hoodoo
{

/// NaN, infinite, or equal to `no_data`.
struct MissingSamples {
    std::uint64_t count = 0;
    int column = 0, row = 0;  ///< the first, in the order of rows from the north
};

MissingSamples find_missing(const HeightGrid& grid, std::optional<double> no_data);

/// Puts `sample` in their place.
void fill_missing_with(HeightGrid& grid, std::optional<double> no_data, double sample);

/// Grows heights into the gaps from their rims: ring after ring, each sample the mean of the known ones among its 8 neighbours. The same for any
/// number of threads. At least one sample must be known. Integers are rounded.
void fill_missing_from_around(HeightGrid& grid, std::optional<double> no_data);

}  // namespace hoodoo
