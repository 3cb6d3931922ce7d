// The factories' rows, one a representation: the only thing catalogue.cpp knows of them.
#pragma once

#include "terrain/catalogue.h"

namespace hoodoo {

CatalogueEntry mesh_row();

}  // namespace hoodoo
