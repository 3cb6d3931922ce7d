// Rays against the triangles of a height grid, block by block: exact, and without a gap between triangles, cells or blocks.
#pragma once

#include "terrain/fields/heightgrid.h"

namespace hoodoo
{

/// Where a ray goes through a triangle of the grid.
struct GridCrossing {
    double t = kInfinity;  ///< metres along the ray
    int column = 0, row = 0;
    bool upper = false;    ///< the cell's triangle: below or above its diagonal
    bool entering = true;  ///< from air to matter
};

/// One ray in the grid's own coordinates: columns, rows, units of a sample. Keeps a reference to the grid.
class GridRay
{
public:
    GridRay(const HeightGrid& grid, const Ray& ray);

    /// The first crossing in the block of the kind ray.crossing with t in (ray.t_min, ray.t_max) and before `limit`; its bits depend neither on the
    /// limit nor on other blocks. Adds the cells that were looked at.
    bool first_in_block(int block, double limit, GridCrossing& found, std::uint32_t& cells) const;

    /// How far a computed height over the grid may lie from the ray's own height there, metres: the rounding of all that is compared.
    double height_error() const;

private:
    template <class T>
    friend class BlockWalk;

    /// Lines of one kind: u = i or v = j. `t(line)` grows with the line, strictly or by rounding not at all.
    struct Axis {
        double start, speed, inverse;  ///< the ray's coordinate is start + speed t
        int step;                      ///< 1, -1, or 0 where it stands still
        double t(int line) const { return (line - start) * inverse; }
    };

    const HeightGrid& grid_;
    const Ray& ray_;
    Axis u_, v_;
    double z_, dz_;
};

/// A block's box, metres; holds every crossing that first_in_block() may report in it.
Box3d block_bounds(const HeightGrid& grid, int block);

}  // namespace hoodoo
