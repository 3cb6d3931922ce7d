// Loose material comes to rest: merge, sort, and slides until no slope is steeper than its material bears.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// Angles of repose in radians, each in [0, pi/2).
struct Repose {
    double sand = 33.0 * M_PI / 180.0;
    double soil = 38.0 * M_PI / 180.0;
    double rock = 42.0 * M_PI / 180.0;
};

/// Merges and sorts the `touched` columns, then lets sand, soil, rock and water (which bears no slope) slide from them, onto them, and on from there.
/// Afterwards no surface of a material among the columns that could have moved stands more than d tan(repose), rounded to whole units, over that of a
/// neighbour at distance d which has room for it (water: more than one unit). The sum of every material keeps its integer value. Columns that only
/// looked on keep their bits. Returns the columns whose layers changed. Doing it twice changes nothing; the order of work within it does not matter
/// to the result.
ColumnSet stabilise(MaterialStack& stack, const ColumnSet& touched, const Repose& repose = {});

}  // namespace hoodoo
