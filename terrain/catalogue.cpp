// Every terrain representation, one row each: open this file first.
//
// A row is named here and made in terrain/surfaces/NAME.cpp, which says what it does, from which paper, and with which parameters. No row registers
// itself: a linker would drop it.
#include "terrain/catalogue.h"

#include "terrain/surfaces/rows.h"

#include <algorithm>

namespace hoodoo
{

std::span<const CatalogueEntry> catalogue()
{
    // clang-format off
    static const std::vector<CatalogueEntry> rows = {
        plane_row(),
        mesh_row(),
        convolution_row(),
        warped_row(),
        canyon_row(),
        breaking_wave_row(),
        voxels_row(),
        implicit_row(),
        rock_pile_row(),
        cracked_row(),
        heightfield_row(),
        elevation_row(),
        landforms_row(),
        layers_row(),
    };
    // clang-format on
    return rows;
}

std::vector<CatalogueEntry> height_rows()
{
    return {plane_row(), heightfield_row(), elevation_row(), landforms_row()};
}

const CatalogueEntry* find_in_catalogue(const std::string& name)
{
    const auto rows = catalogue();
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const CatalogueEntry& entry) { return entry.name == name; });
    return row == rows.end() ? nullptr : &*row;
}

}  // namespace hoodoo
