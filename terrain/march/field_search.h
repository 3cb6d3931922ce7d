// A ray in one patch of a marched field: where it first crosses, or whether it does.
#pragma once

#include "terrain/march/field_patches.h"
#include "terrain/march/patch_model.h"
#include "terrain/march/pinned_root.h"

namespace hoodoo
{

/// What is kept of a box: proved all over it.
struct FieldPatch {
    Vec3f lo, hi;                                          ///< relative to the tile's corner
    Vec3f least{0.0f}, most{0.0f};                         ///< of the gradient's components
    float curvature = 0.0f, mixed = 0.0f, upright = 0.0f;  ///< of LocalField
    bool everywhere = false;                               ///< the surface exists all over the box
    PatchModel model;                                      ///< about the box's middle

    /// Of the field's derivative along a direction, and of its second derivative.
    Interval rise_along(const Vec3d& direction) const;
    double slope() const { return Vec3d(std::max(-least.x, most.x), std::max(-least.y, most.y), std::max(-least.z, most.z)).length(); }
    double bend_along(const Vec3d& direction) const { return LocalField::curvature_along(curvature, mixed, upright, direction); }
};

/// Stateless; keeps references to field and settings.
class FieldSearch
{
public:
    FieldSearch(const MarchedField& field, const PatchSettings& settings, double rounding) : field_(field), settings_(settings), rounding_(rounding)
    {
    }

    /// The first crossing in the patch (its box given) before `limit`; or, if `any`, whether there is one: t is then of no meaning.
    bool first(const FieldPatch& patch, const Box3d& box, const Ray& ray, double limit, bool any, double& t, std::uint32_t& evaluations) const;

private:
    bool pinned(const FieldPatch& patch, const Ray& ray, const PinnedRoot& root, bool any, double& t, std::uint32_t& evaluations) const;
    bool certified(const FieldPatch& patch, const Ray& ray, double a, double b, bool any, double& t, std::uint32_t& evaluations) const;
    bool paper(const Ray& ray, double a, double b, double& t, std::uint32_t& evaluations) const;
    double accuracy_at(double a, double b) const { return std::max(settings_.accuracy, 4.0 * (rounding_ + 0x1p-52 * (std::abs(a) + std::abs(b)))); }

    const MarchedField& field_;
    const PatchSettings& settings_;
    double rounding_;  ///< metres: of coordinates in the domain
};

}  // namespace hoodoo
