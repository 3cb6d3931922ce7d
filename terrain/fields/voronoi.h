// Plane Voronoi diagrams and their Delaunay triangulations: whose point is it, and where are the borders.
#pragma once

#include "terrain/math/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hoodoo
{

using Box2d = Imath::Box2d;

/// Immutable, thread-safe. Lengths and places in the unit of the sites (metres, relative to a corner that the caller knows).
class VoronoiDiagram
{
public:
    /// The border with one neighbour: all points p with normal . p = offset. The signed distance to it, positive on the own side, is
    /// offset - normal . p.
    struct Border {
        Vec2d normal{0.0};  ///< unit, from the own site towards the neighbour
        double offset = 0.0;
        std::uint32_t neighbour = 0;

        double distance(const Vec2d& p) const { return offset - normal.dot(p); }
    };
    /// A piece of border between two cells. A border that ends nowhere is cut at the box that was asked for.
    struct Edge {
        Vec2d a, b;
        std::uint32_t left = 0, right = 0;
    };

    /// Sites are moved to a lattice of 2^-30 of the power of two above the box's longest side, counted from the box's lower corner; of those that
    /// fall together the first is kept. Throws Error (internal) if one lies outside the box or there is none.
    VoronoiDiagram(std::span<const Vec2d> sites, const Box2d& box);

    std::span<const Vec2d> sites() const { return sites_; }
    const Box2d& box() const { return box_; }
    std::span<const Border> borders(std::uint32_t site) const { return {borders_.data() + first_[site], borders_.data() + first_[site + 1]}; }

    /// The site nearest to `p`, anywhere in the plane; of several equally near ones any.
    std::uint32_t nearest(const Vec2d& p) const;

    /// Distance from `p` to the nearest border; infinite with a single site. 1-Lipschitz.
    double border_distance(const Vec2d& p) const { return border_distance(p, nearest(p)); }
    /// The same for a `p` whose nearest site is known.
    double border_distance(const Vec2d& p, std::uint32_t site) const;

    /// All borders inside the box, each once, as line segments: for drawings and for tests.
    std::vector<Edge> edges() const;
    /// Triples of sites whose cells meet, counter-clockwise.
    std::vector<std::array<std::uint32_t, 3>> triangles() const;

    std::uint64_t memory_bytes() const;

private:
    void find_borders();
    void find_starts();
    std::uint32_t walk(const Vec2d& p, std::uint32_t from) const;

    Box2d box_;
    std::vector<Vec2d> sites_;
    std::vector<std::array<std::int32_t, 2>> lattice_;  ///< the same sites, as the library takes them
    std::vector<std::uint32_t> first_;
    std::vector<Border> borders_;
    int starts_x_ = 1, starts_y_ = 1;    ///< a grid over the box: in each cell the site nearest to its middle
    std::vector<std::uint32_t> starts_;  ///< row by row
};

}  // namespace hoodoo
