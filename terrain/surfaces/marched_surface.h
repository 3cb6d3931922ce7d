// What surfaces have in common that are one field in patches: the way of rays to the patches, and the first and the last step of a hit's story.
#pragma once

#include "terrain/march/field_patches.h"

#include <cmath>
#include <memory>

namespace hoodoo
{

/// The beginning of an Interaction: the place of a crossing, known along the ray to `accuracy` metres, with its error. 64 units in the last place
/// cover the arithmetic of a field at that distance from the origin.
inline Interaction crossing_at(const Ray& ray, const Hit& hit, double accuracy)
{
    Interaction at;
    at.t = hit.t;
    at.position = ray.at(hit.t);
    const double size = std::abs(ray.origin.x) + std::abs(ray.origin.y) + std::abs(ray.origin.z) + hit.t;
    at.position_error = accuracy + 64.0 * 0x1p-52 * size;
    return at;
}

/// How far along the geometric normal `value` says air for certain, by more than it says of a graze: twice the error, doubled up to `most` metres.
template <class Value>
double offset_into_air(const Interaction& at, double most, double flat, const Value& value)
{
    double offset = 2.0 * at.position_error;
    while (offset < most && !(value(at.position + at.geometric_normal * offset) > 2.0 * flat)) offset *= 2.0;
    return offset;
}

/// A surface that is one marched field. The derived class is that field, tells its looks, and calls make_patches() before any ray.
class MarchedSurface : public Surface, protected MarchedField
{
public:
    /// Throws Error (memory) if there would be too many patches.
    void make_patches(const PatchSettings& settings)
    {
        settings_ = settings;
        patches_ = make_field_patches(*this, settings);
    }
    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t tile_count() const final { return patches_->tile_count(); }
    std::uint32_t patch_count(std::uint32_t tile) const final { return patches_->patch_count(tile); }
    Box3d patch_bounds(PatchId patch) const final { return patches_->patch_bounds(patch); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const final { return patches_->intersect(patch, ray, hit); }
    bool occluded(PatchId patch, const Ray& ray) const final { return patches_->occluded(patch, ray); }

protected:
    const PatchSettings& settings() const { return settings_; }
    double air_above(const Interaction& at, double time) const
    {
        return offset_into_air(at, settings_.size, settings_.flat, [&](const Vec3d& p) { return value(p, time); });
    }
    /// Adds the patches, their memory and the seconds.
    void add_patches(SurfaceInfo& info) const
    {
        info.trace_bytes += patches_->memory_bytes();
        for (std::uint32_t t = 0; t < patches_->tile_count(); ++t) info.patches += patches_->patch_count(t);
        info.build_seconds += build_seconds_;
    }

private:
    PatchSettings settings_;
    std::unique_ptr<const FieldIntersector> patches_;
    double build_seconds_ = 0.0;
};

}  // namespace hoodoo
