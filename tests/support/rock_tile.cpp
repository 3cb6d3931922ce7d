// The laws of rocks, as functions with a verdict: what one tile must obey.

#include "tests/support/rock_tile.h"

#include "terrain/math/hash.h"
#include "terrain/rocks/poisson_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hoodoo::testing
{
namespace
{

template <class Visit>
void for_tiles_around(Visit&& visit)
{
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) visit(Vec3i(x, y, z));
}

/// The nearest point of a triangle by its regions (corner, edge, face).
double triangle_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    const auto edge = [&](const Vec3d& u, const Vec3d& v) {
        const double t = std::clamp((p - u).dot(v - u) / (v - u).length2(), 0.0, 1.0);
        return (p - u - (v - u) * t).length();
    };
    const Vec3d n = (b - a).cross(c - a);
    const bool over = n.cross(b - a).dot(p - a) >= 0.0 && n.cross(c - b).dot(p - b) >= 0.0 && n.cross(a - c).dot(p - c) >= 0.0;
    return over ? std::abs(n.dot(p - a)) / n.length() : std::min({edge(a, b), edge(b, c), edge(c, a)});
}

}  // namespace

RockTile make_rock_tile(const RockOptions& options)
{
    RockTile tile;
    tile.options = options;
    tile.stretch = shape_stretch(options);
    const auto sites = make_sites(options);
    tile.length = sites->length();
    tile.radius = sites->radius();
    std::vector<SiteId> ids;
    for (const Site& site : sites->sites(Vec3i(0))) {
        ids.push_back({Vec3i(0), static_cast<std::uint32_t>(ids.size())});
        tile.points.push_back(site.position);
    }
    const VoronoiCells cells(*sites, ids, tile.stretch);
    ContactOptions contacts{options.contacts, hash_name(options.seed, "contacts"), {}};
    for (const Vec3d& p : options.contact_points) contacts.points.push_back(p * tile.stretch * tile.length);
    for (const SiteId& id : ids) {
        tile.cells.push_back(cells.at(id));
        tile.contacts.push_back(choose_contacts(cells, id, tile.stretch, contacts));
    }
    for (Rock& rock : make_tile(options)) {
        tile.fields.push_back(std::move(rock.field));
        tile.meshes.push_back(std::move(rock.mesh));
    }
    return tile;
}

Verdict volumes_fill_the_tile(const RockTile& tile)
{
    double sum = 0.0;
    for (const VoronoiCell& cell : tile.cells) sum += cell.volume;
    const double whole = std::pow(tile.length, 3.0);
    if (std::abs(sum - whole) <= 1e-9 * whole) return {};
    return {fmt::format("cells have {} of the tile's volume", sum / whole)};
}

Verdict points_keep_their_distance(const RockTile& tile)
{
    Verdict verdict;
    for (std::size_t i = 0; i < tile.points.size(); ++i)
        for (std::size_t j = 0; j < tile.points.size(); ++j)
            for_tiles_around([&](const Vec3i& step) {
                if (i == j && step == Vec3i(0)) return;
                const double d = (tile.points[i] - tile.points[j] - Vec3d(step) * tile.length).length();
                if (d < 2.0 * tile.radius) verdict.fault = fmt::format("points {} and {} are {} radii apart", i, j, d / tile.radius);
            });
    return verdict;
}

Verdict faces_have_twins(const RockTile& tile)
{
    const double least = 1e-7 * tile.length * tile.length;  // a sliver may be seen from one side only
    for (std::size_t i = 0; i < tile.cells.size(); ++i) {
        for (const CellFace& face : tile.cells[i].faces) {
            if (face.area < least) continue;
            const SiteId back{-face.neighbour.tile, static_cast<std::uint32_t>(i)};
            const std::vector<CellFace>& others = tile.cells[face.neighbour.index].faces;
            const auto twin = std::find_if(others.begin(), others.end(), [&](const CellFace& f) { return f.neighbour == back; });
            if (twin == others.end())
                return {fmt::format("rock {} has a face towards {} that {} lacks", i, face.neighbour.index, face.neighbour.index)};
            if (std::abs(twin->area - face.area) > least || (twin->normal + face.normal).length() > 1e-9)
                return {fmt::format("rocks {} and {} disagree about their face", i, face.neighbour.index)};
        }
    }
    return {};
}

Verdict contacts_are_shared(const RockTile& tile)
{
    for (std::size_t i = 0; i < tile.contacts.size(); ++i) {
        for (const Contact& contact : tile.contacts[i]) {
            const std::size_t j = contact.neighbour.index;
            const Vec3d there = contact.point - tile.offset(i, contact.neighbour);
            const double mine = tile.fields[i]->value(contact.point), theirs = tile.fields[j]->value(there);
            if (std::abs(mine) > 1e-9 * tile.radius || std::abs(theirs) > 1e-9 * tile.radius)
                return {fmt::format("Phi of rocks {} and {} at their contact: {:g}, {:g}", i, j, mine, theirs)};
            const auto& list = tile.contacts[j];
            const bool known =
                std::any_of(list.begin(), list.end(), [&](const Contact& c) { return (c.point - there).length() <= 1e-9 * tile.length; });
            if (!known) return {fmt::format("rock {} does not know its contact with {}", j, i)};
        }
    }
    return {};
}

Verdict rocks_keep_out(const RockTile& tile, int samples)
{
    const std::uint64_t seed = hash_name(tile.options.seed, "samples");
    const auto random = [&](int n, int k) { return unit_real(hash_cell(seed, n, k)); };
    for (int n = 0; n < samples; ++n) {
        const Vec3d p = Vec3d(random(n, 0), random(n, 1), random(n, 2)) * tile.length * tile.stretch;
        int inside = 0;
        for (std::size_t i = 0; i < tile.points.size(); ++i)
            for_tiles_around([&](const Vec3i& step) {
                const Vec3d q = p - (tile.points[i] + Vec3d(step) * tile.length) * tile.stretch;
                // A rock twice as large as its cell would still be noticed.
                if (q.length2() <= 4.0 * tile.cells[i].max_radius * tile.cells[i].max_radius) inside += tile.fields[i]->value(q) < -1e-12;
            });
        if (inside > 1) return {fmt::format("{} rocks at one point", inside)};
    }
    const double least = -0.01 * tile.radius;
    for (std::size_t i = 0; i < tile.meshes.size(); ++i) {
        const TriangleMesh& mesh = tile.meshes[i];
        const auto outside = [&](const Vec3d& p, double tolerance) {
            return std::all_of(tile.cells[i].faces.begin(), tile.cells[i].faces.end(), [&](const CellFace& face) {
                return tile.fields[face.neighbour.index]->value(p - tile.offset(i, face.neighbour)) >= tolerance;
            });
        };
        const std::size_t stride = std::max<std::size_t>(1, mesh.vertices.size() * tile.meshes.size() / static_cast<std::size_t>(samples));
        for (std::size_t k = 0; k < mesh.vertices.size(); k += stride)
            if (!outside(Vec3d(mesh.vertices[k]), least)) return {fmt::format("a vertex of rock {} lies in another", i)};
        for (std::size_t k = 0; k < mesh.triangles.size(); k += 2 * stride) {
            const auto& t = mesh.triangles[k];
            const double u = random(static_cast<int>(k), 3), v = random(static_cast<int>(k), 4) * (1.0 - u);
            const Vec3d p = Vec3d(mesh.vertices[t[0]]) * (1.0 - u - v) + Vec3d(mesh.vertices[t[1]]) * u + Vec3d(mesh.vertices[t[2]]) * v;
            if (!outside(p, least)) return {fmt::format("a triangle of rock {} enters another", i)};
        }
    }
    return {};
}

Verdict meshes_are_closed(const RockTile& tile)
{
    for (std::size_t i = 0; i < tile.meshes.size(); ++i) {
        const TriangleMesh& mesh = tile.meshes[i];
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        double volume = 0.0;
        for (const auto& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
            volume += Vec3d(mesh.vertices[t[0]]).dot(Vec3d(mesh.vertices[t[1]]).cross(Vec3d(mesh.vertices[t[2]]))) / 6.0;
        }
        for (const auto& [edge, times] : edges) {
            const auto back = edges.find({edge.second, edge.first});
            if (times != 1 || back == edges.end() || back->second != 1) return {fmt::format("an edge of rock {} is open", i)};
        }
        const long euler = static_cast<long>(mesh.vertices.size()) - static_cast<long>(edges.size() / 2) + static_cast<long>(mesh.triangles.size());
        if (euler != 2) return {fmt::format("rock {} has the Euler characteristic {}", i, euler)};
        if (!(volume > 0.0)) return {fmt::format("rock {} faces inwards", i)};
    }
    return {};
}

double distance_to(const TriangleMesh& mesh, const Vec3d& p)
{
    double best = kInfinity;
    for (const auto& t : mesh.triangles)
        best = std::min(best, triangle_distance(p, Vec3d(mesh.vertices[t[0]]), Vec3d(mesh.vertices[t[1]]), Vec3d(mesh.vertices[t[2]])));
    return best;
}

Verdict contacts_are_reached(const RockTile& tile)
{
    const double near = 0.02 * tile.radius;
    std::size_t all = 0, reached = 0;
    for (std::size_t i = 0; i < tile.contacts.size(); ++i) {
        for (const Contact& contact : tile.contacts[i]) {
            ++all;
            reached += distance_to(tile.meshes[i], contact.point) <= near &&
                       distance_to(tile.meshes[contact.neighbour.index], contact.point - tile.offset(i, contact.neighbour)) <= near;
        }
    }
    if (10 * reached >= 9 * all && all > 0) return {};
    return {fmt::format("{} of {} contacts are reached", reached, all)};
}

}  // namespace hoodoo::testing
