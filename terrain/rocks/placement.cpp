// Every seed point inside a rock layer becomes an instance, unless no air lies within reach of its rock (Peytavie2009, section 5; maths A9).
//
// Tiles over the volume's bounds are walked column by column; a point is kept if the volume holds it and air lies nearer than twice the greatest
// radius of a cell: in any direction, so that cliffs and caves keep their rocks (depth under the ground alone would not). A kept rock needs company:
// a contact whose other rock is held as well, or ground within 0.05 r of one of its vertices, straight below. Order: tiles by x, y, z, then the
// list of the tile; ids count in this order, seeds are hashed from tile and site, so neighbours do not change when a rock goes.
// Meshes: one for each rock of a periodic tile; with corner cubes one for each surrounding that occurs (its own key, the keys of its neighbours, its
// contacts). Deviations: the paper keeps rocks that float at the rim of a layer. Missing: whether a pile would stand.

#include "terrain/rocks/placement.h"

#include "terrain/math/hash.h"
#include "terrain/rocks/corner_cubes.h"
#include "terrain/rocks/poisson_spheres.h"
#include "terrain/rocks/rock_mesh.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kDefaultShare = 0.93;    // of the saturated radius: reached within milliseconds up to hundreds of rocks
constexpr double kSaturatedShare = 0.97;  // of corner cubes, which are filled up: then they hold about as many as asked
constexpr std::size_t kMostRocks = 5000000;
constexpr double kCellReach = 2.2;  // of r: radius of a cell of corner cubes to begin with; saturated points stay under 2

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Everything about the rocks at some points of the arrangement.
class RockTable
{
public:
    RockTable(const SiteArrangement& sites, std::vector<SiteId> wanted, const RockOptions& options)
        : sites_(sites), stretch_(shape_stretch(options)), cells_(sites, wanted, stretch_)
    {
        ContactOptions contacts{options.contacts, hash_name(options.seed, "contacts"), {}};
        for (const Vec3d& p : options.contact_points) contacts.points.push_back(p * stretch_ * sites.length());
        for (SiteId& id : wanted) id = sites.canonical(id);
        std::sort(wanted.begin(), wanted.end());
        wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
        std::vector<std::vector<Contact>> chosen(wanted.size());
        tbb::parallel_for(std::size_t(0), wanted.size(), [&](std::size_t k) { chosen[k] = choose_contacts(cells_, wanted[k], stretch_, contacts); });
        std::map<std::uint64_t, std::uint32_t> known;
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            const auto [at, fresh] = known.try_emplace(surroundings(wanted[k], chosen[k]), static_cast<std::uint32_t>(first_.size()));
            if (fresh) first_.push_back(wanted[k]);
            entries_.emplace(wanted[k], Entry{std::move(chosen[k]), at->second});
        }
    }

    void make_meshes(const RockOptions& options)
    {
        const DirectionBall ball = direction_ball(options.level);
        const double radius = sites_.radius() * std::min({stretch_.x, stretch_.y, stretch_.z});
        rocks_.resize(first_.size());
        tbb::parallel_for(std::size_t(0), first_.size(),
                          [&](std::size_t k) { rocks_[k] = make_rock(cells_.at(first_[k]), contacts(first_[k]), radius, options, ball); });
    }

    const std::vector<Contact>& contacts(const SiteId& id) const { return entries_.at(sites_.canonical(id)).contacts; }
    std::uint32_t mesh(const SiteId& id) const { return entries_.at(sites_.canonical(id)).mesh; }
    std::vector<Rock>& rocks() { return rocks_; }
    const VoronoiCells& cells() const { return cells_; }

    static Rock make_rock(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options,
                          const DirectionBall& ball)
    {
        std::vector<Vec3d> points;
        for (const Contact& c : contacts) points.push_back(c.point);
        Weathering weathering = weathering_for(options);
        weathering.seed = static_cast<std::uint32_t>(hash_combine(options.seed, cell.key));
        Rock rock;
        rock.field = std::make_unique<RockField>(cell, std::move(points), radius, weathering);
        // The centroid sees more of the surface than the point does, if it is as deep inside.
        const Vec3d middle = rock.field->value(cell.centroid) < rock.field->value(Vec3d(0.0)) ? cell.centroid : Vec3d(0.0);
        rock.mesh = rock_mesh(*rock.field, middle, ball, shape_stretch(options));
        return rock;
    }

private:
    struct Entry {
        std::vector<Contact> contacts;
        std::uint32_t mesh;
    };

    /// The same number for rocks of the same shape.
    std::uint64_t surroundings(const SiteId& id, const std::vector<Contact>& contacts) const
    {
        const VoronoiCell& cell = cells_.at(id);
        std::uint64_t faces = 0;  // a sum: voro++ may list them in another order
        for (const CellFace& face : cell.faces) {
            std::uint64_t h = hash_combine(face.key, 1);
            for (int k = 0; k < 3; ++k) h = hash_combine(h, static_cast<std::uint64_t>(std::llround(face.normal[k] * 1e6)));
            faces += h;
        }
        for (const Contact& contact : contacts) {
            std::uint64_t h = 2;
            for (int k = 0; k < 3; ++k) h = hash_combine(h, static_cast<std::uint64_t>(std::llround(contact.point[k] / sites_.length() * 1e6)));
            faces += h;
        }
        return hash_combine(cell.key, faces);
    }

    const SiteArrangement& sites_;
    Vec3d stretch_;
    VoronoiCells cells_;
    std::vector<SiteId> first_;
    std::map<SiteId, Entry> entries_;
    std::vector<Rock> rocks_;
};

/// One tile's points in world space.
class Placer
{
public:
    Placer(const SiteArrangement& sites, const RockOptions& options, const RockVolume& volume, const Vec3d& anchor)
        : sites_(sites), stretch_(shape_stretch(options)), edge_(stretch_ * sites.length()), volume_(volume), anchor_(anchor), options_(options)
    {
    }

    Vec3d world(const SiteId& id) const { return anchor_ + sites_.position(id) * stretch_; }

    /// The points that the volume holds with air nearer than `reach`.
    std::vector<SiteId> visible(double reach) const
    {
        const Box3d box = volume_.bounds();
        if (box.isEmpty()) return {};
        const auto tile = [&](double x, int k) { return std::floor((x - anchor_[k]) / edge_[k]); };
        const double nx = tile(box.max.x, 0) - tile(box.min.x, 0) + 1, ny = tile(box.max.y, 1) - tile(box.min.y, 1) + 1;
        if (nx * ny * sites_.density() > 1e9) throw too_many(nx * ny * sites_.density());
        const auto x0 = static_cast<int>(tile(box.min.x, 0)), y0 = static_cast<int>(tile(box.min.y, 1));
        std::vector<std::vector<SiteId>> columns(static_cast<std::size_t>(nx * ny));
        tbb::parallel_for(std::size_t(0), columns.size(), [&](std::size_t c) {
            const int x = x0 + static_cast<int>(c % static_cast<std::size_t>(nx)), y = y0 + static_cast<int>(c / static_cast<std::size_t>(nx));
            const Vec2d lo(anchor_.x + x * edge_.x, anchor_.y + y * edge_.y), hi(lo + Vec2d(edge_.x, edge_.y));
            const Interval heights = volume_.heights(lo, hi);
            if (!(heights.lo <= heights.hi)) return;
            for (int z = static_cast<int>(tile(heights.lo, 2)), top = static_cast<int>(tile(heights.hi, 2)); z <= top; ++z) {
                const auto count = static_cast<std::uint32_t>(sites_.sites({x, y, z}).size());
                for (std::uint32_t k = 0; k < count; ++k) {
                    const SiteId id{{x, y, z}, k};
                    const Vec3d p = world(id);
                    if (volume_.holds(p) && volume_.air_within(p, reach)) columns[c].push_back(id);
                }
            }
        });
        std::size_t total = 0;
        for (const auto& column : columns) total += column.size();
        if (total > kMostRocks) throw too_many(static_cast<double>(total));
        std::vector<SiteId> all;
        all.reserve(total);
        for (const auto& column : columns) all.insert(all.end(), column.begin(), column.end());
        return all;
    }

    bool has_company(const SiteId& id, const std::vector<Contact>& contacts, const TriangleMesh& mesh, double radius) const
    {
        for (const Contact& contact : contacts)
            if (volume_.holds(world({id.tile + contact.neighbour.tile, contact.neighbour.index}))) return true;
        const Vec3d p = world(id) - Vec3d(0.0, 0.0, 0.05 * radius);
        // Every eighth vertex: about as far apart as the tolerance.
        for (std::size_t k = 0; k < mesh.vertices.size(); k += 8)
            if (volume_.ground(p + Vec3d(mesh.vertices[k]))) return true;
        return false;
    }

private:
    Error too_many(double count) const
    {
        return Error(ErrorKind::scene, Problem{options_.where,
                                               "too many rocks",
                                               fmt::format("a rock_size so large that there are at most {}", kMostRocks),
                                               fmt::format("about {:.2g}", count),
                                               {}});
    }

    const SiteArrangement& sites_;
    Vec3d stretch_, edge_;
    const RockVolume& volume_;
    Vec3d anchor_;
    const RockOptions& options_;
};

std::vector<SiteId> tile_ids(const SiteArrangement& sites)
{
    std::vector<SiteId> ids;
    for (std::uint32_t k = 0; k < sites.sites(Vec3i(0)).size(); ++k) ids.push_back({Vec3i(0), k});
    return ids;
}

/// Instances of the rocks that have company, and only the meshes they use.
Instances instance(const std::vector<SiteId>& ids, RockTable& table, const Placer& placer, const RockOptions& options, double radius)
{
    std::vector<char> stays(ids.size());
    tbb::parallel_for(std::size_t(0), ids.size(), [&](std::size_t k) {
        stays[k] = placer.has_company(ids[k], table.contacts(ids[k]), table.rocks()[table.mesh(ids[k])].mesh, radius);
    });
    Instances out;
    out.material = "rock";
    std::vector<std::uint32_t> renumbered(table.rocks().size(), 0xffffffffu);
    for (std::size_t k = 0; k < ids.size(); ++k) {
        if (!stays[k]) continue;
        std::uint32_t& mesh = renumbered[table.mesh(ids[k])];
        if (mesh == 0xffffffffu) {
            mesh = static_cast<std::uint32_t>(out.meshes.size());
            out.meshes.push_back(std::move(table.rocks()[table.mesh(ids[k])].mesh));
        }
        Instance instance;
        instance.position = placer.world(ids[k]);
        instance.mesh = mesh;
        instance.id = static_cast<std::uint32_t>(out.instances.size()) + 1;
        instance.seed = static_cast<std::uint32_t>(hash_combine(hash_cell(options.seed, ids[k].tile.x, ids[k].tile.y, ids[k].tile.z), ids[k].index));
        out.instances.push_back(instance);
    }
    return out;
}

}  // namespace

int rocks_per_tile(const RockOptions& options)
{
    if (!options.sites.empty()) return static_cast<int>(options.sites.size());
    return options.per_tile > 0 ? options.per_tile : options.corner_cubes ? 150 : 50;
}

double tile_length(const RockOptions& options)
{
    return options.size * std::cbrt(rocks_per_tile(options) * kPi / 6.0);
}

Vec3d shape_stretch(const RockOptions& options)
{
    return options.shape / std::cbrt(options.shape.x * options.shape.y * options.shape.z);
}

Weathering weathering_for(const RockOptions& options)
{
    // At most 0.3 + ln(40) / 5.5 + 0.1 < 1.1 at a place that sees 40 faces alike, and about 0.9 at a cell's middle, which is 1 r deep at least.
    Weathering w;
    w.depth = 0.16 + 0.14 * options.roundness;
    w.sharpness = 16.0 - 10.5 * options.roundness;
    w.roughness = options.roughness;
    return w;
}

std::unique_ptr<SiteArrangement> make_sites(const RockOptions& options)
{
    const double length = tile_length(options);
    const int count = rocks_per_tile(options);
    const double fits = (options.corner_cubes ? kSaturatedShare : kDefaultShare) * random_packing_radius(count, length);
    const double radius = options.radius.value_or(fits);
    const auto problem = [&](const std::string& what, const std::string& expected) {
        return Error(ErrorKind::scene, Problem{options.where, what, expected, {}, {}});
    };
    if (options.corner_cubes) {
        if (!(length >= CornerCubes::least_length * radius))
            throw problem(fmt::format("corner cubes of {:.4g} m are too small for rocks with a radius of {:.4g} m", length, radius),
                          fmt::format("a radius of at most {:.4g} m, or more rocks a tile", length / CornerCubes::least_length));
        return std::make_unique<CornerCubes>(length, radius, hash_name(options.seed, "sites"));
    }
    std::vector<Vec3d> points;
    if (!options.sites.empty()) {
        for (const Vec3d& p : options.sites) points.push_back(p * length);
    } else {
        points = poisson_spheres(count, length, radius, hash_name(options.seed, "sites"));
        if (static_cast<int>(points.size()) < count)
            throw problem(
                fmt::format("{} rocks with a radius of {:.4g} m do not fit into a tile of {:.4g} m", count, radius, length),
                fmt::format("a radius of at most {:.4g} m, or at most {} rocks a tile", fits, random_packing_count(radius / kDefaultShare, length)));
    }
    return std::make_unique<PeriodicSites>(std::move(points), length, radius, hash_name(options.seed, "keys"));
}

Rock make_rock(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options)
{
    return RockTable::make_rock(cell, contacts, radius, options, direction_ball(options.level));
}

std::vector<Rock> make_tile(const RockOptions& options)
{
    RockOptions periodic = options;
    periodic.corner_cubes = false;
    const auto sites = make_sites(periodic);
    RockTable table(*sites, tile_ids(*sites), periodic);
    table.make_meshes(periodic);
    return std::move(table.rocks());
}

Instances place_rocks(const RockOptions& options, const RockVolume& volume, const Vec3d& anchor)
{
    const Vec3d stretch = shape_stretch(options);
    auto start = std::chrono::steady_clock::now();
    const auto sites = make_sites(options);
    const double radius = sites->radius() * std::min({stretch.x, stretch.y, stretch.z});
    std::unique_ptr<RockTable> table;
    const Placer placer(*sites, options, volume, anchor);
    double tile_seconds = 0.0, instancing_seconds = 0.0;
    std::vector<SiteId> ids;
    if (!options.corner_cubes) {
        table = std::make_unique<RockTable>(*sites, tile_ids(*sites), options);
        table->make_meshes(options);
        tile_seconds = seconds_since(start);
        start = std::chrono::steady_clock::now();
        ids = placer.visible(2.0 * table->cells().max_radius());
    } else {
        // Which cells there are depends on which are near enough to air, and how near that is on the largest cell.
        for (double reach = kCellReach * sites->radius() * std::max({stretch.x, stretch.y, stretch.z});;) {
            ids = placer.visible(2.0 * reach);
            table = std::make_unique<RockTable>(*sites, ids, options);
            if (table->cells().max_radius() <= reach) break;
            reach = table->cells().max_radius();
        }
        table->make_meshes(options);
        tile_seconds = seconds_since(start);
        start = std::chrono::steady_clock::now();
    }
    Instances out = instance(ids, *table, placer, options, radius);
    instancing_seconds = seconds_since(start);
    out.rocks = {out.instances.size(), static_cast<std::uint64_t>(rocks_per_tile(options)), out.meshes.size(), tile_seconds, instancing_seconds};
    return out;
}

}  // namespace hoodoo
