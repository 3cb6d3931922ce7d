// The factories' rows, one a representation: the only thing catalogue.cpp knows of them.
#pragma once

#include "terrain/catalogue.h"

namespace hoodoo
{

CatalogueEntry plane_row();
CatalogueEntry mesh_row();
CatalogueEntry convolution_row();
CatalogueEntry warped_row();
CatalogueEntry canyon_row();
CatalogueEntry breaking_wave_row();
CatalogueEntry voxels_row();
CatalogueEntry implicit_row();
CatalogueEntry rock_pile_row();
CatalogueEntry cracked_row();
CatalogueEntry heightfield_row();
CatalogueEntry elevation_row();
CatalogueEntry landforms_row();
CatalogueEntry layers_row();

/// The rows whose surfaces are heights over the plane by themselves: what another row may take as its ground, in a table of its own.
std::vector<CatalogueEntry> height_rows();

}  // namespace hoodoo
