// The Voronoi cell of a seed point: the convex room out of which a rock is weathered. Cells of all points fill space without gap.
#pragma once

#include "terrain/rocks/sites.h"

#include <map>
#include <vector>

namespace hoodoo
{

/// One face of a cell. Coordinates are metres relative to the cell's own point, stretched.
struct CellFace {
    SiteId neighbour;       ///< its tile counted from the tile of the cell's own point
    std::uint64_t key = 0;  ///< of the neighbour
    Vec3d normal{0, 0, 1};  ///< unit, away from the cell
    double offset = 0.0;    ///< the cell lies where normal . x <= offset
    double area = 0.0;      ///< m2
    Vec3d centroid{0.0};
    std::vector<Vec3d> polygon;  ///< counter-clockwise seen from outside
};

struct VoronoiCell {
    std::uint64_t key = 0;
    std::vector<CellFace> faces;
    double volume = 0.0;  ///< m3
    Vec3d centroid{0.0};
    double max_radius = 0.0;  ///< of the ball around the point that holds the cell, metres
    Box3d box;
};

/// The cell of one point. `stretch` (each > 0) multiplies all coordinates afterwards: cells are those of a metric in which long rocks are round.
/// Pure, thread-safe. Throws Error (internal) if the cell is not bounded by its surroundings.
VoronoiCell voronoi_cell(const SiteArrangement& arrangement, const SiteId& id, const Vec3d& stretch);

/// Cells computed once for each canonical point, with those of all their neighbours. Immutable, thread-safe.
class VoronoiCells
{
public:
    VoronoiCells(const SiteArrangement& arrangement, std::vector<SiteId> wanted, const Vec3d& stretch);
    /// The cell of a wanted point or of a neighbour of one.
    const VoronoiCell& at(const SiteId& id) const;
    const SiteArrangement& arrangement() const { return arrangement_; }
    double max_radius() const { return max_radius_; }  ///< of all wanted cells, metres

private:
    void add(std::vector<SiteId> ids, const Vec3d& stretch);
    const SiteArrangement& arrangement_;
    std::map<SiteId, VoronoiCell> cells_;
    double max_radius_ = 0.0;
};

}  // namespace hoodoo
