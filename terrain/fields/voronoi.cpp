// Neighbours come from a library that is exact (Boost.Polygon, Fortune's sweep over integers); what we keep of them are half-planes.
// A cell is the set of points on the own side of all borders with its neighbours; the distance to the border of a convex cell from inside is the
// least of the distances to the lines, so no end point of an edge is ever needed (maths of Li2023, equations 5 and 6 taken as segments):
//     d(p) = min over j of ( |p - s_j|^2 - |p - s_i|^2 ) / ( 2 |s_i - s_j| ),   i the nearest site.
// The nearest site is found by walking from neighbour to nearer neighbour: in a Delaunay triangulation that ends at the nearest one of all
// (Bose2004). The library takes 32-bit integers, so sites stand on a lattice from the start: what is traced is the diagram of exactly these sites.
// Missing: weighted sites; insertion and removal.
#include "terrain/fields/voronoi.h"

#include "terrain/error.h"

#include <boost/polygon/voronoi.hpp>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

using BoostDiagram = boost::polygon::voronoi_diagram<double>;

/// Cells are numbered as the sites. (The library's diagram can neither be copied nor moved.)
void construct(std::span<const std::array<std::int32_t, 2>> lattice, BoostDiagram& diagram)
{
    boost::polygon::default_voronoi_builder builder;
    for (const auto& site : lattice) builder.insert_point(site[0], site[1]);
    builder.construct(&diagram);
}

/// The part of the line origin + t direction, t in [lo, hi], inside the box; false if there is none.
bool clip(const Box2d& box, const Vec2d& origin, const Vec2d& direction, double& lo, double& hi)
{
    for (int k = 0; k < 2; ++k) {
        if (direction[k] == 0.0) {
            if (origin[k] < box.min[k] || origin[k] > box.max[k]) return false;
            continue;
        }
        const double s = (box.min[k] - origin[k]) / direction[k], t = (box.max[k] - origin[k]) / direction[k];
        lo = std::max(lo, std::min(s, t));
        hi = std::min(hi, std::max(s, t));
    }
    return lo < hi;
}

}  // namespace

VoronoiDiagram::VoronoiDiagram(std::span<const Vec2d> sites, const Box2d& box) : box_(box)
{
    const Vec2d size = box.size();
    const double step = std::exp2(std::ceil(std::log2(std::max(size.x, size.y))) - 30.0);
    if (sites.empty() || !(step > 0.0)) throw Error(ErrorKind::internal, "a Voronoi diagram needs a box and a site in it");
    for (const Vec2d& site : sites) {
        if (!box.intersects(site)) throw Error(ErrorKind::internal, "a site lies outside the box of its Voronoi diagram");
        const Vec2d at = (site - box.min) / step;
        lattice_.push_back({static_cast<std::int32_t>(std::lround(at.x)), static_cast<std::int32_t>(std::lround(at.y))});
    }
    // Of equal ones the first stays, and the order too.
    std::vector<std::size_t> order(lattice_.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return std::pair(lattice_[a], a) < std::pair(lattice_[b], b); });
    order.erase(std::unique(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return lattice_[a] == lattice_[b]; }), order.end());
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) lattice_[k] = lattice_[order[k]];
    lattice_.resize(order.size());
    for (const auto& at : lattice_) sites_.push_back(box.min + Vec2d(at[0], at[1]) * step);
    find_borders();
    find_starts();
}

void VoronoiDiagram::find_borders()
{
    BoostDiagram diagram;
    construct(lattice_, diagram);
    std::vector<std::vector<Border>> all(sites_.size());
    for (const auto& edge : diagram.edges()) {
        if (!edge.is_primary()) continue;
        const auto i = static_cast<std::uint32_t>(edge.cell()->source_index());
        const auto j = static_cast<std::uint32_t>(edge.twin()->cell()->source_index());
        const Vec2d across = sites_[j] - sites_[i], normal = across.normalized();
        // Seen from the other side both numbers only change their sign, to the last bit: a crack has one middle line.
        all[i].push_back({normal, normal.dot((sites_[i] + sites_[j]) * 0.5), j});
    }
    first_.push_back(0);
    for (auto& borders : all) {
        std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) { return a.neighbour < b.neighbour; });
        borders_.insert(borders_.end(), borders.begin(), borders.end());
        first_.push_back(static_cast<std::uint32_t>(borders_.size()));
    }
}

void VoronoiDiagram::find_starts()
{
    // About one site a cell.
    const Vec2d size = box_.size();
    const double side =
        std::sqrt(std::max(size.x * size.y, 1e-12 * std::max(size.x, size.y) * std::max(size.x, size.y)) / static_cast<double>(sites_.size()));
    const auto cells = [&](double length) { return static_cast<int>(std::clamp(std::ceil(length / side), 1.0, 4096.0)); };
    starts_x_ = cells(size.x);
    starts_y_ = cells(size.y);
    std::uint32_t from = 0;
    for (int j = 0; j < starts_y_; ++j) {
        for (int i = 0; i < starts_x_; ++i) {
            from = walk(box_.min + Vec2d(size.x * (i + 0.5) / starts_x_, size.y * (j + 0.5) / starts_y_), from);
            starts_.push_back(from);
        }
    }
}

std::uint32_t VoronoiDiagram::walk(const Vec2d& p, std::uint32_t from) const
{
    double nearest = (sites_[from] - p).length2();
    for (;;) {
        std::uint32_t best = from;
        for (const Border& border : borders(from)) {
            const double d = (sites_[border.neighbour] - p).length2();
            if (d < nearest) {
                nearest = d;
                best = border.neighbour;
            }
        }
        if (best == from) return from;
        from = best;
    }
}

std::uint32_t VoronoiDiagram::nearest(const Vec2d& p) const
{
    const Vec2d at = (p - box_.min) / box_.size();
    const auto cell = [](double u, int n) { return static_cast<int>(std::clamp(u * n, 0.0, n - 1.0)); };
    return walk(p, starts_[static_cast<std::size_t>(cell(at.y, starts_y_)) * static_cast<std::size_t>(starts_x_) +
                           static_cast<std::size_t>(cell(at.x, starts_x_))]);
}

double VoronoiDiagram::border_distance(const Vec2d& p, std::uint32_t site) const
{
    double least = kInfinity;
    for (const Border& border : borders(site)) least = std::min(least, border.distance(p));
    return std::max(least, 0.0);
}

std::vector<VoronoiDiagram::Edge> VoronoiDiagram::edges() const
{
    std::vector<Edge> found;
    for (std::uint32_t i = 0; i < sites_.size(); ++i) {
        for (const Border& border : borders(i)) {
            if (border.neighbour < i) continue;
            // The border's line, cut by all other borders of the cell and by the box.
            const Vec2d origin = border.normal * border.offset, along(-border.normal.y, border.normal.x);
            double lo = -kInfinity, hi = kInfinity;
            if (!clip(box_, origin, along, lo, hi)) continue;
            for (const Border& other : borders(i)) {
                if (other.neighbour == border.neighbour) continue;
                const double rate = other.normal.dot(along), room = other.distance(origin);
                if (rate > 0.0) hi = std::min(hi, room / rate);
                if (rate < 0.0) lo = std::max(lo, room / rate);
            }
            if (lo < hi) found.push_back({origin + along * lo, origin + along * hi, i, border.neighbour});
        }
    }
    return found;
}

std::vector<std::array<std::uint32_t, 3>> VoronoiDiagram::triangles() const
{
    BoostDiagram diagram;
    construct(lattice_, diagram);
    std::vector<std::array<std::uint32_t, 3>> found;
    for (const auto& vertex : diagram.vertices()) {
        // Cells around a vertex, in turn; where more than three meet, a fan.
        std::vector<std::uint32_t> around;
        const auto* edge = vertex.incident_edge();
        do {
            around.push_back(static_cast<std::uint32_t>(edge->cell()->source_index()));
            edge = edge->rot_next();
        } while (edge != vertex.incident_edge());
        for (std::size_t k = 2; k < around.size(); ++k) {
            std::array<std::uint32_t, 3> t{around[0], around[k - 1], around[k]};
            const Vec2d ab = sites_[t[1]] - sites_[t[0]], ac = sites_[t[2]] - sites_[t[0]];
            if (ab.cross(ac) < 0.0) std::swap(t[1], t[2]);
            found.push_back(t);
        }
    }
    return found;
}

std::uint64_t VoronoiDiagram::memory_bytes() const
{
    return sites_.capacity() * sizeof(Vec2d) + lattice_.capacity() * sizeof(lattice_[0]) + first_.capacity() * sizeof(first_[0]) +
           borders_.capacity() * sizeof(Border) + starts_.capacity() * sizeof(starts_[0]);
}

}  // namespace hoodoo
