// One rock for each surrounding: its own key, the keys of its neighbours, its contacts (Peytavie2009, section 5; maths A9).
//
// In a periodic tile each point has surroundings of its own, with corner cubes many occur again. The feet, by which a rock is asked whether it stands
// on ground, are the vertices of one fixed level of detail: which rocks there are does not depend on how finely they are drawn.

#include "terrain/rocks/rock_table.h"

#include "terrain/math/hash.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hoodoo
{
namespace
{

constexpr int kFeetLevel = 2;  // 362 vertices, about as far apart as the tolerance of touching

}  // namespace

std::unique_ptr<RockField> make_rock_field(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options)
{
    std::vector<Vec3d> points;
    for (const Contact& c : contacts) points.push_back(c.point);
    Weathering weathering = weathering_for(options);
    weathering.seed = static_cast<std::uint32_t>(hash_combine(options.seed, cell.key));
    return std::make_unique<RockField>(cell, std::move(points), radius, weathering);
}

Vec3d rock_middle(const RockField& field, const VoronoiCell& cell)
{
    // The centroid sees more of the surface than the point does, if it is as deep inside.
    return field.value(cell.centroid) < field.value(Vec3d(0.0)) ? cell.centroid : Vec3d(0.0);
}

RockTable::RockTable(const SiteArrangement& sites, std::vector<SiteId> wanted, const RockOptions& options)
    : sites_(sites), stretch_(shape_stretch(options)), cells_(sites, wanted, stretch_), wanted_(std::move(wanted))
{
    ContactOptions contacts{options.contacts, hash_name(options.seed, "contacts"), {}};
    for (const Vec3d& p : options.contact_points) contacts.points.push_back(p * stretch_ * sites.length());
    for (SiteId& id : wanted_) id = sites.canonical(id);
    std::sort(wanted_.begin(), wanted_.end());
    wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
    entries_.resize(wanted_.size());
    tbb::parallel_for(std::size_t(0), wanted_.size(),
                      [&](std::size_t k) { entries_[k].contacts = choose_contacts(cells_, wanted_[k], stretch_, contacts); });
    std::map<std::uint64_t, std::uint32_t> known;
    one_tile_ = true;
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
        const auto [at, fresh] = known.try_emplace(surroundings(wanted_[k], entries_[k].contacts), static_cast<std::uint32_t>(first_.size()));
        if (fresh) first_.push_back(wanted_[k]);
        entries_[k].form = at->second;
        one_tile_ = one_tile_ && wanted_[k] == SiteId{Vec3i(0), static_cast<std::uint32_t>(k)};
    }
}

/// The same number for rocks of the same shape.
std::uint64_t RockTable::surroundings(const SiteId& id, const std::vector<Contact>& contacts) const
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

const RockTable::Entry& RockTable::at(const SiteId& id) const
{
    const SiteId canonical = sites_.canonical(id);
    if (one_tile_) return entries_.at(canonical.index);
    const auto found = std::lower_bound(wanted_.begin(), wanted_.end(), canonical);
    return entries_.at(static_cast<std::size_t>(found - wanted_.begin()));
}

void RockTable::make_forms(const RockOptions& options, std::span<const std::uint8_t> levels)
{
    std::array<DirectionBall, kRockLevels> balls;
    for (int level = 0; level < kRockLevels; ++level) {
        const bool wanted = level == kFeetLevel || std::any_of(levels.begin(), levels.end(), [&](std::uint8_t l) { return (l >> level) & 1; });
        if (wanted) balls[static_cast<std::size_t>(level)] = direction_ball(level);
    }
    const double radius = sites_.radius() * std::min({stretch_.x, stretch_.y, stretch_.z});
    forms_.resize(first_.size());
    const Vec3d stretch = stretch_;
    tbb::parallel_for(std::size_t(0), first_.size(), [&](std::size_t f) {
        const VoronoiCell& cell = cells_.at(first_[f]);
        Form& form = forms_[f];
        form.field = make_rock_field(cell, at(first_[f]).contacts, radius, options);
        const Vec3d middle = rock_middle(*form.field, cell);
        const auto mesh = [&](std::size_t level) { return rock_mesh(*form.field, middle, balls[level], stretch); };
        for (std::size_t level = 0; level < kRockLevels; ++level)
            if ((levels[f] >> level) & 1) form.meshes[level] = mesh(level);
        const TriangleMesh& known = form.meshes[kFeetLevel];
        form.feet = known.vertices.empty() ? mesh(kFeetLevel).vertices : known.vertices;
    });
}

double RockTable::reach() const
{
    double reach = 0.0;
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
        const Vec3d here = sites_.position(wanted_[k]);
        for (const Contact& contact : entries_[k].contacts) {
            const SiteId other{wanted_[k].tile + contact.neighbour.tile, contact.neighbour.index};
            const Vec3d apart = (sites_.position(other) - here) * stretch_;
            reach = std::max(reach, std::hypot(apart.x, apart.y));
        }
        reach = std::max(reach, cells_.at(wanted_[k]).max_radius);
    }
    return reach;
}

}  // namespace hoodoo
