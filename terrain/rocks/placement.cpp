// Every seed point inside a rock layer becomes an instance, unless no air lies within reach of its rock (Peytavie2009, section 5; maths A9).
//
// Tiles over the volume's bounds are walked column by column; a point is kept if the volume holds it and air lies nearer than twice the greatest
// radius of a cell: in any direction, so that cliffs and caves keep their rocks (depth under the ground alone would not). A kept rock needs company:
// a contact whose other rock is held as well, or ground within 0.05 r of one of its feet, straight below. Order: tiles by y, x, z, then the list of
// the tile; ids count in this order, seeds are hashed from tile and site, so neighbours do not change when a rock goes.
// All that a rock asks lies within a known distance of its point: after an edit only columns of tiles within that distance are asked again.
// Meshes: those of a periodic tile, each rock at each level of detail that the room may need, so that a mesh keeps its number when rocks come and go;
// with corner cubes those that are seen.
// Deviations: the paper keeps rocks that float at the rim of a layer. Missing: whether a pile would stand.

#include "terrain/rocks/placement.h"

#include "terrain/math/hash.h"
#include "terrain/rocks/rock_table.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>

namespace hoodoo
{
namespace
{

constexpr std::size_t kMostRocks = 5000000;
constexpr double kCellReach = 2.2;  // of r: radius of a cell of corner cubes to begin with; saturated points stay under 2

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Error too_many(const RockOptions& options, const std::string& count)
{
    return Error(ErrorKind::scene,
                 Problem{options.where, "too many rocks", fmt::format("a rock_size so large that there are at most {}", kMostRocks), count, {}});
}

std::vector<SiteId> tile_ids(const SiteArrangement& sites)
{
    std::vector<SiteId> ids;
    for (std::uint32_t k = 0; k < sites.sites(Vec3i(0)).size(); ++k) ids.push_back({Vec3i(0), k});
    return ids;
}

std::uint8_t level_bit(int level)
{
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(level));
}

bool is_same(const Instance& a, const Instance& b)
{
    return a.position == b.position && a.mesh == b.mesh && a.seed == b.seed;
}

}  // namespace

class RockPlacement::Impl
{
public:
    Impl(RockOptions options, std::shared_ptr<const RockVolume> volume, const Vec3d& anchor)
        : options_(std::move(options)),
          volume_(std::move(volume)),
          anchor_(anchor),
          sites_(make_sites(options_)),
          stretch_(shape_stretch(options_)),
          edge_(stretch_ * sites_->length()),
          radius_(sites_->radius() * std::min({stretch_.x, stretch_.y, stretch_.z}))
    {
        const auto start = Clock::now();
        if (!options_.corner_cubes) make_periodic_table();
        tile_seconds_ = seconds_since(start);
    }

    Instances place()
    {
        auto start = Clock::now();
        const std::vector<TileColumn> tiles = columns_over(volume_->bounds());
        std::vector<std::vector<SiteId>> seen;
        if (options_.corner_cubes) {
            seen = make_seen_table(tiles);
            tile_seconds_ = seconds_since(start);
            start = Clock::now();
        }
        std::vector<std::vector<Instance>> lists(tiles.size());
        const double reach = 2.0 * table_->cells().max_radius();
        fill_lists(lists, [&](std::size_t c) { return standing(options_.corner_cubes ? std::move(seen[c]) : visible(tiles[c], reach)); });
        columns_.clear();
        count_ = 0;
        for (std::size_t c = 0; c < tiles.size(); ++c) count_ += lists[c].size();
        for (std::size_t c = 0; c < tiles.size(); ++c)
            if (!lists[c].empty()) columns_.emplace_hint(columns_.end(), tiles[c], std::move(lists[c]));
        Instances rocks;
        rocks.material = "rock";
        list_meshes(rocks.meshes);
        list_instances(rocks);
        rocks.rocks = {count_, static_cast<std::uint64_t>(rocks_per_tile(options_)), rocks.meshes.size(), tile_seconds_, seconds_since(start)};
        return rocks;
    }

    InstanceChange follow(std::span<const Rectangle> changed, Instances& rocks)
    {
        if (options_.corner_cubes) {
            Instances fresh = place();
            fresh.material_index = rocks.material_index;
            rocks = std::move(fresh);
            return InstanceChange::meshes;
        }
        const std::vector<TileColumn> tiles = columns_near(changed);
        std::vector<std::vector<Instance>> lists(tiles.size());
        const double reach = 2.0 * table_->cells().max_radius();
        fill_lists(lists, [&](std::size_t c) { return standing(visible(tiles[c], reach)); });
        const auto known = [&](const TileColumn& tile) -> std::span<const Instance> {
            const auto found = columns_.find(tile);
            return found == columns_.end() ? std::span<const Instance>() : found->second;
        };
        std::size_t total = count_;
        bool same = true;
        for (std::size_t c = 0; c < tiles.size(); ++c) {
            const std::span<const Instance> before = known(tiles[c]);
            total += lists[c].size() - before.size();
            same = same && std::equal(before.begin(), before.end(), lists[c].begin(), lists[c].end(), is_same);
        }
        if (total > kMostRocks) throw too_many(options_, "more");
        if (same) return InstanceChange::none;
        for (std::size_t c = 0; c < tiles.size(); ++c) {
            if (lists[c].empty())
                columns_.erase(tiles[c]);
            else
                columns_[tiles[c]] = std::move(lists[c]);
        }
        count_ = total;
        list_instances(rocks);
        rocks.rocks.instances = count_;
        return InstanceChange::places;
    }

    double reach() const { return reach_; }

    double overhang() const
    {
        double longest = 0.0;
        for (std::size_t f = 0; table_ && f < table_->form_count(); ++f)
            for (const Vec3f& foot : table_->form(static_cast<std::uint32_t>(f)).feet) longest = std::max(longest, Vec3d(foot).length());
        return std::max(longest, kCellReach * sites_->radius() * std::max({stretch_.x, stretch_.y, stretch_.z}));
    }

private:
    /// Tiles above each other; ordered by y, then x.
    struct TileColumn {
        int y, x;
        auto operator<=>(const TileColumn&) const = default;
    };

    /// lists[c] = make(c), in parallel; stops as soon as they hold too many.
    template <class Item, class Make>
    void fill_lists(std::vector<std::vector<Item>>& lists, Make&& make) const
    {
        std::atomic<std::size_t> total{0};
        tbb::parallel_for(std::size_t(0), lists.size(), [&](std::size_t c) {
            lists[c] = make(c);
            if (total.fetch_add(lists[c].size(), std::memory_order_relaxed) > kMostRocks) throw too_many(options_, "more");
        });
    }

    Vec3d world(const SiteId& id) const { return anchor_ + sites_->position(id) * stretch_; }
    double tile_of(double x, int k) const { return std::floor((x - anchor_[k]) / edge_[k]); }

    void make_periodic_table()
    {
        table_ = std::make_unique<RockTable>(*sites_, tile_ids(*sites_), options_);
        // Every level that the room may come to need, whatever lies there now.
        const Box3d room = volume_->room();
        int finest = options_.level, coarsest = options_.level;
        if (options_.view && !room.isEmpty()) {
            Vec3d near, far;
            for (int k = 0; k < 3; ++k) {
                const double e = options_.view->eye[k], lo = room.min[k] - e, hi = room.max[k] - e;
                near[k] = std::max({0.0, lo, -hi});
                far[k] = std::max(std::abs(lo), std::abs(hi));
            }
            finest = rock_level(options_, near.length());
            coarsest = rock_level(options_, far.length());
        }
        std::uint8_t levels = 0;
        for (int level = finest; level <= coarsest; ++level) levels = static_cast<std::uint8_t>(levels | level_bit(level));
        table_->make_forms(options_, std::vector<std::uint8_t>(table_->form_count(), levels));
        mesh_number_.fill({});
        std::uint32_t next = 0;
        for (int level = finest; level <= coarsest; ++level)
            for (std::size_t f = 0; f < table_->form_count(); ++f) mesh_number_[static_cast<std::size_t>(level)].push_back(next++);
        reach_ = std::max(2.0 * table_->cells().max_radius(), table_->reach());
    }

    /// With corner cubes: which cells there are depends on which are near enough to air, and how near that is on the largest cell.
    std::vector<std::vector<SiteId>> make_seen_table(const std::vector<TileColumn>& tiles)
    {
        std::vector<std::vector<SiteId>> seen(tiles.size());
        for (double reach = kCellReach * sites_->radius() * std::max({stretch_.x, stretch_.y, stretch_.z});;) {
            fill_lists(seen, [&](std::size_t c) { return visible(tiles[c], 2.0 * reach); });
            std::vector<SiteId> ids;
            for (const auto& list : seen) ids.insert(ids.end(), list.begin(), list.end());
            table_ = std::make_unique<RockTable>(*sites_, ids, options_);
            if (table_->cells().max_radius() <= reach) break;
            reach = table_->cells().max_radius();
        }
        std::vector<std::uint8_t> levels(table_->form_count(), 0);
        for (const auto& list : seen) {
            for (const SiteId& id : list) {
                std::uint8_t& bits = levels[table_->at(id).form];
                bits = static_cast<std::uint8_t>(bits | level_bit(level_at(world(id))));
            }
        }
        table_->make_forms(options_, levels);
        std::uint32_t next = 0;
        for (std::size_t level = 0; level < kRockLevels; ++level) {
            mesh_number_[level].assign(levels.size(), 0);
            for (std::size_t f = 0; f < levels.size(); ++f)
                if ((levels[f] >> level) & 1) mesh_number_[level][f] = next++;
        }
        return seen;
    }

    std::vector<TileColumn> columns_over(const Box3d& box) const
    {
        if (box.isEmpty()) return {};
        const double nx = tile_of(box.max.x, 0) - tile_of(box.min.x, 0) + 1, ny = tile_of(box.max.y, 1) - tile_of(box.min.y, 1) + 1;
        if (nx * ny * sites_->density() > 1e9) throw too_many(options_, fmt::format("about {:.2g}", nx * ny * sites_->density()));
        const auto x0 = static_cast<int>(tile_of(box.min.x, 0)), y0 = static_cast<int>(tile_of(box.min.y, 1));
        std::vector<TileColumn> all;
        for (int y = 0; y < static_cast<int>(ny); ++y)
            for (int x = 0; x < static_cast<int>(nx); ++x) all.push_back({y0 + y, x0 + x});
        return all;
    }

    /// Those with a point whose rock may ask about one of the rectangles.
    std::vector<TileColumn> columns_near(std::span<const Rectangle> changed) const
    {
        std::vector<TileColumn> all;
        for (const Rectangle& part : changed) {
            const std::vector<TileColumn> more = columns_over(
                Box3d(Vec3d(part.lo.x - reach_, part.lo.y - reach_, anchor_.z), Vec3d(part.hi.x + reach_, part.hi.y + reach_, anchor_.z)));
            all.insert(all.end(), more.begin(), more.end());
            if (static_cast<double>(all.size()) * sites_->density() > 1e9) throw too_many(options_, "more");
        }
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }

    /// The points over a tile's square that the volume holds with air nearer than `reach`.
    std::vector<SiteId> visible(const TileColumn& tile, double reach) const
    {
        const Vec2d lo(anchor_.x + tile.x * edge_.x, anchor_.y + tile.y * edge_.y), hi(lo + Vec2d(edge_.x, edge_.y));
        const Interval heights = volume_->heights(lo, hi);
        std::vector<SiteId> ids;
        if (!(heights.lo <= heights.hi)) return ids;
        for (int z = static_cast<int>(tile_of(heights.lo, 2)), top = static_cast<int>(tile_of(heights.hi, 2)); z <= top; ++z) {
            const auto count = static_cast<std::uint32_t>(sites_->sites({tile.x, tile.y, z}).size());
            for (std::uint32_t k = 0; k < count; ++k) {
                const SiteId id{{tile.x, tile.y, z}, k};
                const Vec3d p = world(id);
                if (volume_->holds(p) && volume_->air_within(p, reach)) ids.push_back(id);
            }
        }
        return ids;
    }

    bool has_company(const SiteId& id, const Vec3d& position, const RockTable::Entry& entry) const
    {
        for (const Contact& contact : entry.contacts)
            if (volume_->holds(world({id.tile + contact.neighbour.tile, contact.neighbour.index}))) return true;
        const Vec3d p = position - Vec3d(0.0, 0.0, 0.05 * radius_);
        const std::vector<Vec3f>& feet = table_->form(entry.form).feet;
        return std::any_of(feet.begin(), feet.end(), [&](const Vec3f& foot) { return volume_->ground(p + Vec3d(foot)); });
    }

    int level_at(const Vec3d& p) const { return options_.view ? rock_level(options_, (p - options_.view->eye).length()) : options_.level; }

    /// Instances, without their ids, of the points that have company.
    std::vector<Instance> standing(const std::vector<SiteId>& ids) const
    {
        std::vector<Instance> all;
        all.reserve(ids.size());
        for (const SiteId& id : ids) {
            const RockTable::Entry& entry = table_->at(id);
            Instance instance;
            instance.position = world(id);
            if (!has_company(id, instance.position, entry)) continue;
            instance.mesh = mesh_number_[static_cast<std::size_t>(level_at(instance.position))][entry.form];
            instance.seed = static_cast<std::uint32_t>(hash_combine(hash_cell(options_.seed, id.tile.x, id.tile.y, id.tile.z), id.index));
            all.push_back(instance);
        }
        return all;
    }

    /// By their numbers; the table's own are used up.
    void list_meshes(std::vector<TriangleMesh>& meshes)
    {
        for (std::size_t level = 0; level < kRockLevels; ++level) {
            for (std::size_t f = 0; f < mesh_number_[level].size(); ++f) {
                TriangleMesh& mesh = table_->form(static_cast<std::uint32_t>(f)).meshes[level];
                if (mesh.triangles.empty()) continue;
                meshes.resize(std::max<std::size_t>(meshes.size(), mesh_number_[level][f] + 1u));
                meshes[mesh_number_[level][f]] = std::move(mesh);
                mesh = {};
            }
        }
    }

    void list_instances(Instances& rocks) const
    {
        rocks.instances.clear();
        rocks.instances.reserve(count_);
        for (const auto& [tile, list] : columns_) rocks.instances.insert(rocks.instances.end(), list.begin(), list.end());
        for (std::size_t k = 0; k < rocks.instances.size(); ++k) rocks.instances[k].id = static_cast<std::uint32_t>(k) + 1;
    }

    RockOptions options_;
    std::shared_ptr<const RockVolume> volume_;
    Vec3d anchor_;
    std::unique_ptr<SiteArrangement> sites_;
    Vec3d stretch_, edge_;
    double radius_;
    std::unique_ptr<RockTable> table_;
    std::array<std::vector<std::uint32_t>, kRockLevels> mesh_number_;  ///< by level and form
    double reach_ = 0.0;                                               ///< horizontally, of all that a rock asks, metres
    double tile_seconds_ = 0.0;
    std::map<TileColumn, std::vector<Instance>> columns_;  ///< none of them empty
    std::size_t count_ = 0;
};

RockPlacement::RockPlacement(RockOptions options, std::shared_ptr<const RockVolume> volume, const Vec3d& anchor)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(volume), anchor))
{
}
RockPlacement::~RockPlacement() = default;
Instances RockPlacement::place()
{
    return impl_->place();
}
InstanceChange RockPlacement::follow(std::span<const Rectangle> changed, Instances& rocks)
{
    return impl_->follow(changed, rocks);
}
double RockPlacement::reach() const
{
    return impl_->reach();
}
double RockPlacement::overhang() const
{
    return impl_->overhang();
}

Rock make_rock(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options)
{
    Rock rock;
    rock.field = make_rock_field(cell, contacts, radius, options);
    rock.mesh = rock_mesh(*rock.field, rock_middle(*rock.field, cell), direction_ball(options.level), shape_stretch(options));
    return rock;
}

std::vector<Rock> make_tile(const RockOptions& options)
{
    RockOptions periodic = options;
    periodic.corner_cubes = false;
    const auto sites = make_sites(periodic);
    RockTable table(*sites, tile_ids(*sites), periodic);
    table.make_forms(periodic, std::vector<std::uint8_t>(table.form_count(), level_bit(options.level)));
    std::vector<Rock> rocks;
    for (std::uint32_t f = 0; f < table.form_count(); ++f)
        rocks.push_back({std::move(table.form(f).field), std::move(table.form(f).meshes[static_cast<std::size_t>(options.level)])});
    return rocks;
}

Instances place_rocks(const RockOptions& options, const RockVolume& volume, const Vec3d& anchor)
{
    return RockPlacement(options, std::shared_ptr<const RockVolume>(std::shared_ptr<void>(), &volume), anchor).place();
}

}  // namespace hoodoo
