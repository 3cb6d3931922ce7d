// Beds of hard and soft rock at fixed elevations: what turns an even slope into cliffs and ledges that line up across a whole country.
#pragma once

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// A monotone map of heights: hard beds get steep, soft ones flat, and the ends of the range stay where they are. Thread-safe.
class Strata
{
public:
    /// Beds of mean thickness `thickness` (m, > 0) from `low` to `high` (m). `contrast` in [0, 1): 0 leaves heights alone, near 1 makes walls and
    /// treads.
    Strata(double low, double high, double thickness, double contrast, std::uint64_t seed);

    /// Where the even height `h` comes to lie. Outside the range: h.
    double operator()(double h) const;

private:
    std::vector<double> even_, bedded_;  ///< knots of the map, increasing
};

}  // namespace hoodoo
