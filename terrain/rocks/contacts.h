// Where neighbouring rocks touch: one point on a shared face, known to both.
#pragma once

#include "terrain/rocks/voronoi_tile.h"

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// Relative to the cell's own point, metres, stretched.
struct Contact {
    Vec3d point{0.0};
    SiteId neighbour;  ///< its tile counted from that of the cell's point
};

struct ContactOptions {
    int per_rock = 6;  ///< about how many a rock has
    std::uint64_t seed = 0;
    std::vector<Vec3d> points;  ///< given instead: points of the tile, metres, stretched; each must lie on faces
};

/// The contacts of one cell. Those of a neighbour on the same face are the same points. `cells` must know the cell and its neighbours.
std::vector<Contact> choose_contacts(const VoronoiCells& cells, const SiteId& id, const Vec3d& stretch, const ContactOptions& options);

}  // namespace hoodoo
