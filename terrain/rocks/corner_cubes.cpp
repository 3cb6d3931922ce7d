// Poisson spheres over corner cubes (Lagae2006): points near a corner depend on its colour, near an edge on two, near a face on four, inside on
// eight.
//
// With r = 1 let d1 <= d2 <= d3 be a point's distances from the nearest lattice plane of each axis. It belongs to the inside if d1 > 1; else to the
// face across the axis of d1 if d2 >= d1 + sqrt 2; else to the edge along the axis of d3 if d3 >= d2 + sqrt 2; else to the corner. Two regions of one
// kind that know nothing of each other lie at least 2 apart: insides by twice 1. For faces across z and x at a common edge, x - z >= sqrt 2 in one
// and z' - x' >= sqrt 2 in the other, so the difference (x - x', z - z') is at least 2 sqrt 2 / sqrt 2 long; edges at a common corner likewise;
// opposite ones are twice sqrt 2 apart. No region reaches farther from its corner than 1 + 2 sqrt 2, and corners' points no farther than length / 2 -
// 1, so that those of one edge keep apart. Points of a kind see those of the kinds before. The colour of a lattice corner is a bit of a hash. The
// shape of the regions matters: at 50 points a cube the corners, of which there are but two kinds, hold 16% of the space; cubes of half-width 1 + 2
// sqrt 2 would hold 75%, and every second tile would look alike. Deviations: cells of a site use whatever points are near, in other cubes too, so
// bands need no width of 4 r (the number of different rocks is larger, none is wrong). Missing: a limit on how many different rocks there may be.

#include "terrain/rocks/corner_cubes.h"

#include "terrain/math/hash.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kFaceBand = 1.0;                       // r
constexpr double kGap = 1.41421356237309515;            // r
constexpr double kEdgeBand = kFaceBand + kGap;          // r, the farthest an edge's region reaches
constexpr double kCornerBand = kFaceBand + 2.0 * kGap;  // r
constexpr double kDarts = 200.0;                        // a cube of edge 2 r: about 97% of what saturation would hold

enum class Region : std::uint8_t { corner, edge, face, inside };

/// Which kind of region a point of the cube belongs to, and its axis (a face's normal, an edge's direction); coordinates may leave the cube by a
/// band.
struct Place {
    Region region;
    int axis;
    bool operator==(const Place&) const = default;
};
Place place_of(const Vec3d& p, double length, double r)
{
    std::array<std::pair<double, int>, 3> d;
    for (int k = 0; k < 3; ++k) d[static_cast<std::size_t>(k)] = {std::min(std::abs(p[k]), std::abs(p[k] - length)) / r, k};
    std::sort(d.begin(), d.end());
    if (d[0].first > kFaceBand) return {Region::inside, 0};
    if (d[1].first >= d[0].first + kGap) return {Region::face, d[0].second};
    if (d[2].first >= d[1].first + kGap) return {Region::edge, d[2].second};
    return {Region::corner, 0};
}

/// Throws darts at a box and keeps those of the `place` that keep their distance from `known` and from each other.
struct Thrower {
    double length, radius;
    std::uint64_t seed;
    Place place;
    std::vector<Vec3d> known;

    /// Ghosts in places that come later surround the region and are forgotten: without them a small region would hold more points than its share,
    /// and all tiles would have the same bumps.
    std::vector<Site> run(const Vec3d& lo, const Vec3d& hi)
    {
        std::vector<Site> kept;
        const double pad = place.region == Region::inside ? 0.0 : 2.0 * radius;
        const Vec3d from = lo - Vec3d(pad), size = hi - lo + Vec3d(2.0 * pad);
        const Box3d own(lo, hi);
        const auto darts = static_cast<std::int64_t>(kDarts * size.x * size.y * size.z / std::pow(2.0 * radius, 3.0));
        for (std::int64_t k = 0; k < darts; ++k) {
            const std::uint64_t h = hash_combine(seed, static_cast<std::uint64_t>(k));
            const Vec3d p = from + Vec3d(unit_real(h), unit_real(mix64(h + 1)), unit_real(mix64(h + 2))) * size;
            const Place at = place_of(p, length, radius);
            if (at.region < place.region) continue;
            const bool free = std::all_of(known.begin(), known.end(), [&](const Vec3d& q) { return (p - q).length2() >= 4.0 * radius * radius; });
            if (!free) continue;
            known.push_back(p);
            if (at == place && own.intersects(p)) kept.push_back({p, hash_combine(seed, static_cast<std::uint64_t>(~k))});
        }
        return kept;
    }
    void see(const std::vector<Site>& sites, const Vec3d& offset)
    {
        for (const Site& site : sites) known.push_back(site.position + offset);
    }
};

std::size_t bit(std::size_t code, int x, int y, int z)
{
    return (code >> (x + 2 * y + 4 * z)) & 1u;
}

std::size_t edge_colours(std::size_t code, int axis, Vec3i at)
{
    const std::size_t a = bit(code, at.x, at.y, at.z);
    at[axis] = 1;
    return a + 2 * bit(code, at.x, at.y, at.z);
}

std::size_t face_colours(std::size_t code, int normal, Vec3i at)
{
    const int u = (normal + 1) % 3, v = (normal + 2) % 3;
    std::size_t colours = 0;
    for (int k = 0; k < 4; ++k) {
        at[u] = k & 1, at[v] = k >> 1;
        colours |= bit(code, at.x, at.y, at.z) << k;
    }
    return colours;
}

/// Calls visit(lower end) for the four edges along `axis`.
template <class Visit>
void for_edges(int axis, Visit&& visit)
{
    for (int k = 0; k < 4; ++k) {
        Vec3i at(0);
        at[(axis + 1) % 3] = k & 1, at[(axis + 2) % 3] = k >> 1;
        visit(at);
    }
}

}  // namespace

CornerCubes::CornerCubes(double length, double radius, std::uint64_t seed) : SiteArrangement(length, radius), seed_(seed)
{
    const double r = radius, band = kCornerBand * r;
    for (std::size_t c = 0; c < 2; ++c) {
        Thrower thrower{length, r, hash_cell(seed, 0, static_cast<std::int64_t>(c)), {Region::corner, 0}, {}};
        // Copies at the next lattice corners stay two radii away.
        const double own = std::min(band, 0.5 * length - r);
        corner_[c] = thrower.run(Vec3d(-own), Vec3d(own));
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t colours = 0; colours < 4; ++colours) {
            Thrower thrower{length, r, hash_cell(seed, 1 + axis, static_cast<std::int64_t>(colours)), {Region::edge, axis}, {}};
            Vec3d step(0.0), lo(-kEdgeBand * r), hi(kEdgeBand * r);
            step[axis] = length, lo[axis] = 0.0, hi[axis] = length;
            thrower.see(corner_[colours & 1u], Vec3d(0.0));
            thrower.see(corner_[colours >> 1], step);
            edge_[static_cast<std::size_t>(axis)][colours] = thrower.run(lo, hi);
        }
    }
    tbb::parallel_for(0, 48, [&](int n) {
        const int normal = n / 16;
        const auto colours = static_cast<std::size_t>(n % 16);
        Thrower thrower{length, r, hash_cell(seed, 4 + normal, static_cast<std::int64_t>(colours)), {Region::face, normal}, {}};
        const int u = (normal + 1) % 3, v = (normal + 2) % 3;
        Vec3d along_u(0.0), along_v(0.0), lo(0.0), hi(length);
        along_u[u] = length, along_v[v] = length, lo[normal] = -kFaceBand * r, hi[normal] = kFaceBand * r;
        const auto colour = [&](int k) { return (colours >> k) & 1u; };
        for (int k = 0; k < 4; ++k) thrower.see(corner_[colour(k)], along_u * (k & 1) + along_v * (k >> 1));
        for (int k = 0; k < 2; ++k) {
            thrower.see(edge_[static_cast<std::size_t>(u)][colour(2 * k) + 2 * colour(2 * k + 1)], along_v * k);
            thrower.see(edge_[static_cast<std::size_t>(v)][colour(k) + 2 * colour(k + 2)], along_u * k);
        }
        face_[static_cast<std::size_t>(normal)][colours] = thrower.run(lo, hi);
    });
    tbb::parallel_for(std::size_t(0), std::size_t(256), [&](std::size_t code) { assemble(code); });
    for (const std::vector<Site>& cube : cubes_) density_ += static_cast<double>(cube.size()) / 256.0;
}

void CornerCubes::assemble(std::size_t code)
{
    Thrower thrower{length(), radius(), hash_cell(seed_, 7, static_cast<std::int64_t>(code)), {Region::inside, 0}, {}};
    std::vector<Site> all;
    const auto take = [&](const std::vector<Site>& sites, const Vec3i& at) {
        const Vec3d offset = Vec3d(at) * length();
        thrower.see(sites, offset);
        for (const Site& site : sites) all.push_back({site.position + offset, site.key});
    };
    for (int k = 0; k < 8; ++k) {
        const Vec3i at(k & 1, k >> 1 & 1, k >> 2);
        take(corner_[bit(code, at.x, at.y, at.z)], at);
    }
    for (int axis = 0; axis < 3; ++axis) {
        for_edges(axis, [&](const Vec3i& at) { take(edge_[static_cast<std::size_t>(axis)][edge_colours(code, axis, at)], at); });
        for (int side = 0; side < 2; ++side) {
            Vec3i at(0);
            at[axis] = side;
            take(face_[static_cast<std::size_t>(axis)][face_colours(code, axis, at)], at);
        }
    }
    inside_[code] = thrower.run(Vec3d(0.0), Vec3d(length()));
    all.insert(all.end(), inside_[code].begin(), inside_[code].end());
    // Regions reach into neighbouring cubes: each cube lists what lies in it.
    std::erase_if(all, [&](const Site& site) {
        const Vec3d& p = site.position;
        return !(p.x >= 0.0 && p.y >= 0.0 && p.z >= 0.0 && p.x < length() && p.y < length() && p.z < length());
    });
    cubes_[code] = std::move(all);
}

std::size_t CornerCubes::code(const Vec3i& tile) const
{
    std::size_t code = 0;
    for (int k = 0; k < 8; ++k)
        code |= static_cast<std::size_t>(hash_cell(seed_, tile.x + (k & 1), tile.y + (k >> 1 & 1), tile.z + (k >> 2)) >> 63) << k;
    return code;
}

}  // namespace hoodoo
