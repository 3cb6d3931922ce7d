// Contact points on the largest faces of a cell, agreed by both cells without asking anyone else (Peytavie2009, section 5; maths A9).
//
// A face bears a contact if it is among the k largest of both its cells, or among the three largest of one: every rock has three contacts at least,
// and about k on average. Faces under 0.08 V^(2/3) bear none. The point is uniform on the face, shrunk to 70% about its centroid: at an edge of the
// cell the weathered rock would have no room for a contact patch. It is computed in the cell that comes first in an order of the pair which both
// know (keys, then which way the neighbour lies), and moved into the other's space. Deviation: the paper draws uniformly on whole faces, on all of
// them.

#include "terrain/rocks/contacts.h"

#include "terrain/math/hash.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hoodoo
{
namespace
{

constexpr double kLeastArea = 0.08;  // of V^(2/3): the 0.02 L^2 of maths A9 for its tile of 8
constexpr double kShrink = 0.7;
constexpr std::size_t kSurely = 3;

/// Rank of the face by area among the cell's own, 0 = largest.
std::size_t rank_of(const VoronoiCell& cell, std::size_t face)
{
    const CellFace& mine = cell.faces[face];
    std::size_t rank = 0;
    for (std::size_t k = 0; k < cell.faces.size(); ++k) {
        const CellFace& other = cell.faces[k];
        rank += other.area > mine.area || (other.area == mine.area && k < face);
    }
    return rank;
}

/// The face of `cell` towards the point that lies `back` tiles away with that index.
std::size_t face_towards(const VoronoiCell& cell, const SiteId& back)
{
    for (std::size_t k = 0; k < cell.faces.size(); ++k)
        if (cell.faces[k].neighbour == back) return k;
    return cell.faces.size();  // a face so small that only one of the two cells has it
}

bool is_first(const VoronoiCell& cell, const CellFace& face)
{
    if (cell.key != face.key) return cell.key < face.key;
    return SiteId{Vec3i(0), 0} < SiteId{face.neighbour.tile, 0};
}

Vec3d random_point(const CellFace& face, std::uint64_t h)
{
    double at = unit_real(mix64(h)) * face.area;
    const std::vector<Vec3d>& v = face.polygon;
    std::size_t k = 2;
    for (; k + 1 < v.size(); ++k) {
        const double area = 0.5 * (v[k - 1] - v[0]).cross(v[k] - v[0]).dot(face.normal);
        if (at < area) break;
        at -= area;
    }
    const double root = std::sqrt(unit_real(mix64(h + 1))), share = unit_real(mix64(h + 2));
    const Vec3d p = v[0] * (1.0 - root) + (v[k - 1] * (1.0 - share) + v[k] * share) * root;
    const Vec3d moved = face.centroid + (p - face.centroid) * kShrink;
    return moved - face.normal * (face.normal.dot(moved) - face.offset);
}

}  // namespace

std::vector<Contact> choose_contacts(const VoronoiCells& cells, const SiteId& id, const Vec3d& stretch, const ContactOptions& options)
{
    const SiteArrangement& arrangement = cells.arrangement();
    const VoronoiCell& cell = cells.at(id);
    const double length = arrangement.length();
    std::vector<Contact> contacts;
    if (!options.points.empty()) {
        const Vec3d own = arrangement.sites(id.tile)[id.index].position * stretch;
        for (const CellFace& face : cell.faces) {
            for (const Vec3d& given : options.points) {
                // The copy of the point that is nearest to the face.
                Vec3d p = given - own;
                for (int k = 0; k < 3; ++k) p[k] += std::round((face.centroid[k] - p[k]) / (length * stretch[k])) * length * stretch[k];
                const double tolerance = 1e-6 * length;
                bool inside = std::abs(face.normal.dot(p) - face.offset) <= tolerance;
                for (const CellFace& other : cell.faces) inside = inside && other.normal.dot(p) <= other.offset + tolerance;
                if (inside) contacts.push_back({p, face.neighbour});
            }
        }
        return contacts;
    }

    const double least = kLeastArea * length * length * std::pow(stretch.x * stretch.y * stretch.z / arrangement.density(), 2.0 / 3.0);
    const auto wanted = static_cast<std::size_t>(options.per_rock);
    for (std::size_t f = 0; f < cell.faces.size(); ++f) {
        const CellFace& face = cell.faces[f];
        if (face.area < least) continue;
        const SiteId there{id.tile + face.neighbour.tile, face.neighbour.index};
        const VoronoiCell& other = cells.at(there);
        const std::size_t back = face_towards(other, {-face.neighbour.tile, id.index});
        if (back == other.faces.size() || other.faces[back].area < least) continue;
        const std::size_t mine = rank_of(cell, f), theirs = rank_of(other, back);
        if (!((mine < wanted && theirs < wanted) || mine < kSurely || theirs < kSurely)) continue;

        // One point for both, made where the pair begins.
        const bool first = is_first(cell, face);
        const CellFace& from = first ? face : other.faces[back];
        const std::uint64_t pair = hash_combine(first ? cell.key : face.key, first ? face.key : cell.key);
        const Vec3i tile = from.neighbour.tile;
        Vec3d point = random_point(from, hash_combine(hash_combine(options.seed, pair), hash_cell(0, tile.x, tile.y, tile.z)));
        if (!first) point += (arrangement.position(there) - arrangement.position(id)) * stretch;
        contacts.push_back({point, face.neighbour});
    }
    return contacts;
}

}  // namespace hoodoo
