// What a cracked ground looks like on paper: its crack map, its heights, the diagram behind it.
#pragma once

#include "terrain/fields/cracked_field.h"
#include "terrain/io/drawing.h"
#include "terrain/io/height_image.h"

namespace hoodoo
{

/// Pixels of `cell` metres from the region's lower left corner, as many as fit, at least one each way; row 0 = north. Throws Error (scene) if that is
/// more than 2^27. Each pixel says what is true of its centre, the same that rays meet there.
HeightImage crack_map(const CrackedField& field, double cell);        ///< aleph: 1 in a crack, else 0
HeightImage cracked_heights(const CrackedField& field, double cell);  ///< h' in metres

/// Three drawings side by side: the sites; the Delaunay triangulation with the Voronoi diagram; the cracks, where they have a depth, over the
/// heights of the ground.
Drawing crack_diagram(const CrackedField& field);

}  // namespace hoodoo
