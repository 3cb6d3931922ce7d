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
CatalogueEntry rock_pile_row();

}  // namespace hoodoo
