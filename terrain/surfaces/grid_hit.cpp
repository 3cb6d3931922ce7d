// The point is put onto its triangle, so that its error is that of heights, not that of a long ray.
#include "terrain/surfaces/grid_hit.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

/// Along the normal until the ground lies below for certain.
double clear_of(const HeightGrid& grid, const Vec3d& p, const Vec3d& n, double error)
{
    const double widest = grid.frame().cell.x + grid.frame().cell.y;
    double offset = 4.0 * error;
    for (; offset < widest; offset *= 2.0) {
        const Vec3d q = p + n * offset;
        if (q.z > grid.height({q.x, q.y}) + 2.0 * error) break;
    }
    return offset;
}

}  // namespace

bool meet_grid(const HeightGrid& grid, int block, const Ray& ray, Hit& hit)
{
    GridCrossing found;
    if (!GridRay(grid, ray).first_in_block(block, hit.t, found, hit.evaluations)) return false;
    hit.t = found.t;
    return true;
}

Interaction grid_interaction(const HeightGrid& grid, int block, const Ray& ray, const Hit& hit)
{
    // Which triangle it was, the same walk tells again.
    const GridRay walk(grid, ray);
    GridCrossing found;
    std::uint32_t cells = 0;
    walk.first_in_block(block, kInfinity, found, cells);

    Interaction at;
    at.t = hit.t;
    at.position = ray.at(hit.t);
    const Vec2d over(at.position.x, at.position.y);
    const HeightGrid::Facet facet = grid.facet(found.column, found.row, found.upper, over);
    at.geometric_normal = Vec3d(-facet.gradient.x, -facet.gradient.y, 1.0).normalized();
    // The point is put onto the triangle; how far along the ray it may be wrong is the error of heights over the rate at which they close in.
    const double height_error = walk.height_error();
    at.position.z = facet.height;
    const double closing = std::abs(ray.direction.z - facet.gradient.x * ray.direction.x - facet.gradient.y * ray.direction.y);
    const double size = std::abs(ray.origin.x) + std::abs(ray.origin.y) + std::abs(ray.origin.z) + hit.t;
    const Vec2d cell = grid.frame().cell;
    at.position_error = std::min(height_error / std::max(closing, 1e-12), cell.x + cell.y) + height_error + 8.0 * 0x1p-52 * size;
    at.spawn_offset = clear_of(grid, at.position, at.geometric_normal, height_error + 8.0 * 0x1p-52 * size);
    return at;
}

}  // namespace hoodoo
