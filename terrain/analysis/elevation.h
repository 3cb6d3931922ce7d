// Heights on a grid as the analyses take them: a view, so that arrays of any host can be asked without a copy.
#pragma once

#include <cstddef>
#include <span>

namespace hoodoo
{

/// Metres, row by row, row 0 = north (largest y), columns from west to east, `cell` metres apart both ways.
struct Elevation {
    std::span<const double> z;
    int columns = 0, rows = 0;
    double cell = 1.0;

    std::size_t index(int column, int row) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
    double at(int column, int row) const { return z[index(column, row)]; }
};

/// Throws Error (scene): a grid that has no samples or not as many as it says, a cell that is not above 0, samples that are no finite number (how
/// many, and where the first is).
void check_elevation(const Elevation& elevation);

}  // namespace hoodoo
