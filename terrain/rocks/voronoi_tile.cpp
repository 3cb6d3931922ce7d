// Voronoi cells by cutting a box with the bisector planes of ever farther neighbours (Rycroft2009), until none can reach the cell any more.
//
// Cell i is the intersection over all j, copies in other tiles included, of n_ij . (x - (p_i + p_j) / 2) <= 0 with n_ij towards p_j. A point farther
// than twice the cell's radius cuts nothing, so sorted neighbours can stop there. voro++ compares with absolute tolerances of 1e-11: it works here
// in units of the mean distance of points. Planes are computed from the points themselves; voro++ gives which planes touch, and the corners.
// A stretched cell is the image of the cell of unstretched points: convex, space-filling, its planes are the images of the planes.

#include "terrain/rocks/voronoi_tile.h"

#include "terrain/error.h"

#include <tbb/parallel_for.h>
#include <voro++/voro++.hh>

#include <algorithm>
#include <cmath>
#include <set>

namespace hoodoo
{
namespace
{

struct Candidate {
    double distance2;
    Vec3d difference;
    SiteId id;
    std::uint64_t key;
};

/// Neighbours up to `reach`, nearest first; equal distances in the order of their tiles.
std::vector<Candidate> neighbours(const SiteArrangement& arrangement, const SiteId& id, double reach)
{
    const double length = arrangement.length();
    const Vec3d p = arrangement.sites(id.tile)[id.index].position;
    std::vector<Candidate> found;
    Vec3i lo, hi;
    for (int k = 0; k < 3; ++k) {
        lo[k] = static_cast<int>(std::floor((p[k] - reach) / length));
        hi[k] = static_cast<int>(std::floor((p[k] + reach) / length));
    }
    for (int z = lo.z; z <= hi.z; ++z) {
        for (int y = lo.y; y <= hi.y; ++y) {
            for (int x = lo.x; x <= hi.x; ++x) {
                const Vec3i offset(x, y, z);
                const std::span<const Site> sites = arrangement.sites(id.tile + offset);
                for (std::uint32_t j = 0; j < sites.size(); ++j) {
                    const Vec3d d = Vec3d(offset) * length + sites[j].position - p;
                    if (d.length2() > reach * reach || (offset == Vec3i(0) && j == id.index)) continue;
                    found.push_back({d.length2(), d, {offset, j}, sites[j].key});
                }
            }
        }
    }
    std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.distance2 < b.distance2; });
    return found;
}

/// Area, centroid and the cone's volume of a polygon given in order.
void measure(CellFace& face)
{
    const std::vector<Vec3d>& v = face.polygon;
    Vec3d weighted(0.0);
    for (std::size_t k = 2; k < v.size(); ++k) {
        const double area = 0.5 * (v[k - 1] - v[0]).cross(v[k] - v[0]).dot(face.normal);
        face.area += area;
        weighted += (v[0] + v[k - 1] + v[k]) * (area / 3.0);
    }
    face.centroid = face.area > 0.0 ? weighted / face.area : v[0];
}

}  // namespace

VoronoiCell voronoi_cell(const SiteArrangement& arrangement, const SiteId& id, const Vec3d& stretch)
{
    const double unit = arrangement.length() / std::cbrt(arrangement.density());
    // No point of a periodic cube is farther from the next seed than half its diagonal.
    const double farthest = std::sqrt(3.0) * arrangement.length();
    voro::voronoicell_neighbor cell;
    std::vector<Candidate> around;
    for (double reach = std::min(farthest, 2.6 * unit);; reach = std::min(farthest, 1.5 * reach)) {
        around = neighbours(arrangement, id, reach);
        const double box = farthest / unit;
        cell.init(-box, box, -box, box, -box, box);
        std::size_t used = 0;
        for (; used < around.size() && around[used].distance2 <= cell.max_radius_squared() * unit * unit; ++used) {
            const Vec3d d = around[used].difference / unit;
            cell.nplane(d.x, d.y, d.z, static_cast<int>(used));
        }
        // voro++ stores twice the corners' coordinates: its max_radius_squared is the square of twice the cell's radius.
        if (used < around.size() || reach * reach >= cell.max_radius_squared() * unit * unit || reach >= farthest) break;
    }

    VoronoiCell result;
    result.key = arrangement.sites(id.tile)[id.index].key;
    std::vector<double> corners;
    std::vector<int> orders, ids;
    cell.vertices(corners);
    cell.face_vertices(orders);
    cell.neighbors(ids);
    const auto corner = [&](int k) {
        const auto at = 3 * static_cast<std::size_t>(k);
        return Vec3d(corners[at], corners[at + 1], corners[at + 2]) * unit * stretch;
    };
    std::size_t read = 0;
    for (const int j : ids) {
        const int count = orders[read++];
        if (j < 0) throw Error(ErrorKind::internal, "a Voronoi cell is not bounded by its neighbours");
        const Candidate& other = around[static_cast<std::size_t>(j)];
        CellFace face;
        face.neighbour = other.id;
        face.key = other.key;
        // n . x <= |d| / 2 before stretching.
        const Vec3d scaled = other.difference / std::sqrt(other.distance2) / stretch;
        face.normal = scaled.normalized();
        face.offset = 0.5 * std::sqrt(other.distance2) / scaled.length();
        for (int k = 0; k < count; ++k) face.polygon.push_back(corner(orders[read++]));
        measure(face);
        if (face.area < 0.0) {
            std::reverse(face.polygon.begin(), face.polygon.end());
            face.area = 0.0;
            measure(face);
        }
        result.volume += face.area * face.offset / 3.0;
        result.centroid += (face.centroid * 0.75) * (face.area * face.offset / 3.0);
        for (const Vec3d& v : face.polygon) {
            result.max_radius = std::max(result.max_radius, v.length());
            result.box.extendBy(v);
        }
        result.faces.push_back(std::move(face));
    }
    result.centroid /= result.volume;
    return result;
}

VoronoiCells::VoronoiCells(const SiteArrangement& arrangement, std::vector<SiteId> wanted, const Vec3d& stretch) : arrangement_(arrangement)
{
    add(wanted, stretch);
    for (const auto& [id, cell] : cells_) max_radius_ = std::max(max_radius_, cell.max_radius);
    std::vector<SiteId> around;
    for (const auto& [id, cell] : cells_)
        for (const CellFace& face : cell.faces) around.push_back({id.tile + face.neighbour.tile, face.neighbour.index});
    add(std::move(around), stretch);
}

void VoronoiCells::add(std::vector<SiteId> ids, const Vec3d& stretch)
{
    for (SiteId& id : ids) id = arrangement_.canonical(id);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    std::erase_if(ids, [&](const SiteId& id) { return cells_.count(id) > 0; });
    std::vector<VoronoiCell> cells(ids.size());
    tbb::parallel_for(std::size_t(0), ids.size(), [&](std::size_t k) { cells[k] = voronoi_cell(arrangement_, ids[k], stretch); });
    for (std::size_t k = 0; k < ids.size(); ++k) cells_.emplace(ids[k], std::move(cells[k]));
}

const VoronoiCell& VoronoiCells::at(const SiteId& id) const
{
    return cells_.at(arrangement_.canonical(id));
}

}  // namespace hoodoo
