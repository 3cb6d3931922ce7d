// Rocks computed once for each surrounding that occurs, however many copies lie about.
#pragma once

#include "terrain/rocks/placement.h"
#include "terrain/rocks/rock_mesh.h"

#include <array>
#include <span>
#include <vector>

namespace hoodoo
{

/// The field of a rock in its cell, and a point inside it that sees its surface.
std::unique_ptr<RockField> make_rock_field(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options);
Vec3d rock_middle(const RockField& field, const VoronoiCell& cell);

/// Cells and contacts of some points of an arrangement, and after make_shapes() the rocks in them. Thread-safe for reading.
class RockTable
{
public:
    /// `sites` must outlive it.
    RockTable(const SiteArrangement& sites, std::vector<SiteId> wanted, const RockOptions& options);

    /// A rock's form: points with the same surroundings share one.
    struct Form {
        std::unique_ptr<RockField> field;
        std::array<TriangleMesh, kRockLevels> meshes;  ///< of the levels that were asked for
        std::vector<Vec3f> feet;                       ///< places on it, the same at every level of detail
    };
    struct Entry {
        std::vector<Contact> contacts;
        std::uint32_t form = 0;
    };

    /// Bit l of levels[f]: form f is wanted at level l.
    void make_forms(const RockOptions& options, std::span<const std::uint8_t> levels);

    std::size_t form_count() const { return first_.size(); }
    Form& form(std::uint32_t index) { return forms_[index]; }
    const Form& form(std::uint32_t index) const { return forms_[index]; }
    const Entry& at(const SiteId& id) const;  ///< of a wanted point
    const VoronoiCells& cells() const { return cells_; }

    /// How far from a point, horizontally, its rock and the points of rocks that touch it lie: at most this, metres.
    double reach() const;

private:
    std::uint64_t surroundings(const SiteId& id, const std::vector<Contact>& contacts) const;

    const SiteArrangement& sites_;
    Vec3d stretch_;
    VoronoiCells cells_;
    std::vector<SiteId> wanted_;  ///< canonical, sorted
    std::vector<Entry> entries_;  ///< as wanted_
    std::vector<SiteId> first_;   ///< a point of each form
    std::vector<Form> forms_;
    bool one_tile_ = false;  ///< wanted_[k] is point k of tile 0
};

}  // namespace hoodoo
