// Cracked ground as a surface that says how it was made: what pictures of the crack map, of h' and of the diagram are drawn from.
#pragma once

#include "terrain/fields/cracked_field.h"
#include "terrain/march/cracked_patches.h"
#include "terrain/surface.h"

#include <memory>

namespace hoodoo
{

class CrackedSurface final : public Surface
{
public:
    /// Materials beside the base's; empty: the base's own.
    struct Looks {
        std::string inside;  ///< walls and floors of cracks
        std::string above;   ///< where iota < 1, with the share 1 - iota
    };
    /// `base` owns the ground that the field stands on.
    CrackedSurface(std::shared_ptr<const Surface> base, CrackedField field, const CrackedPatchSettings& settings, const Looks& looks);

    const CrackedField& cracks() const { return field_; }
    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t patch_count(std::uint32_t) const override { return patches_.patch_count(); }
    Box3d patch_bounds(PatchId patch) const override { return patches_.patch_bounds(patch.index); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return patches_.intersect(patch.index, ray, hit); }
    Interaction interact(const Ray& ray, const Hit& hit) const override;
    void dress(Interaction& at) const override;
    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0; }
    std::vector<std::string> materials() const override;
    bool closed() const override { return false; }
    SurfaceInfo info() const override;
    const Field* field() const override { return &field_; }

private:
    enum class Part : std::uint8_t { top, floor, wall };
    void wear(Interaction& at, Part part) const;

    std::shared_ptr<const Surface> base_;
    CrackedField field_;
    CrackedPatches patches_;
    std::vector<std::string> materials_;
    std::size_t inside_, above_;  ///< indices into materials_, or its size
    double build_seconds_ = 0.0;
};

}  // namespace hoodoo
