// Gaps in measured heights, grown shut from their rims, one ring at a time. No paper: what radar shadows and lakes need is a plausible level ground.
// Each ring is computed from the rings before it only, so the order within a ring does not matter. Deviation: no smoothing after; a wide gap shows
// where its fronts met.
#include "terrain/fields/grid_fill.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

bool is_missing(double sample, const std::optional<double>& no_data)
{
    return !std::isfinite(sample) || (no_data && sample == *no_data);
}

struct Place {
    int column, row;
};

std::vector<Place> missing_places(const HeightGrid& grid, const std::optional<double>& no_data)
{
    std::vector<Place> places;
    for (int row = grid.rows() - 1; row >= 0; --row)
        for (int column = 0; column < grid.columns(); ++column)
            if (is_missing(grid.sample(column, row), no_data)) places.push_back({column, row});
    return places;
}

}  // namespace

MissingSamples find_missing(const HeightGrid& grid, std::optional<double> no_data)
{
    MissingSamples found;
    for (int row = grid.rows() - 1; row >= 0; --row) {
        for (int column = 0; column < grid.columns(); ++column) {
            if (!is_missing(grid.sample(column, row), no_data)) continue;
            if (found.count++ == 0) found.column = column, found.row = row;
        }
    }
    return found;
}

void fill_missing_with(HeightGrid& grid, std::optional<double> no_data, double sample)
{
    for (const Place& place : missing_places(grid, no_data)) grid.set(place.column, place.row, sample);
    grid.summarise();
}

void fill_missing_from_around(HeightGrid& grid, std::optional<double> no_data)
{
    // A filled sample may happen to equal no_data; what is known is kept apart.
    const auto width = static_cast<std::size_t>(grid.columns());
    std::vector<bool> unknown(width * static_cast<std::size_t>(grid.rows())), queued(unknown.size());
    const auto at = [&](const Place& p) { return static_cast<std::size_t>(p.row) * width + static_cast<std::size_t>(p.column); };
    const auto around = [&](const Place& p, const auto& visit) {
        for (int row = std::max(p.row - 1, 0); row <= std::min(p.row + 1, grid.rows() - 1); ++row)
            for (int column = std::max(p.column - 1, 0); column <= std::min(p.column + 1, grid.columns() - 1); ++column) visit(Place{column, row});
    };
    std::vector<Place> ring = missing_places(grid, no_data), next;
    for (const Place& place : ring) unknown[at(place)] = true;
    const bool whole = grid.type() != SampleType::f32;
    // The first candidates are all gaps; then only the neighbours of what was filled last.
    while (!ring.empty()) {
        std::vector<std::pair<Place, double>> filled;
        for (const Place& place : ring) {
            double sum = 0.0;
            int known = 0;
            around(place, [&](const Place& p) {
                if (!unknown[at(p)]) sum += grid.sample(p.column, p.row), ++known;
            });
            if (known > 0) filled.emplace_back(place, whole ? std::round(sum / known) : sum / known);
        }
        next.clear();
        for (const auto& [place, sample] : filled) {
            grid.set(place.column, place.row, sample);
            unknown[at(place)] = false;
        }
        for (const auto& [place, sample] : filled) {
            around(place, [&](const Place& p) {
                if (unknown[at(p)] && !queued[at(p)]) queued[at(p)] = true, next.push_back(p);
            });
        }
        ring.swap(next);
    }
    grid.summarise();
}

}  // namespace hoodoo
