// Any field with bounds over boxes, cut into tight proved boxes and met by rays: certified, or with the paper's area test.
#pragma once

#include "terrain/fields/warped_field.h"
#include "terrain/surface.h"

#include <functional>
#include <memory>

namespace hoodoo
{

/// What is marched: one function for each shutter time in [0, 1]. Pure and thread-safe.
class MarchedField
{
public:
    virtual ~MarchedField() = default;
    virtual double value(const Vec3d& p, double time) const = 0;
    /// Whether values() costs less than two or three times value(); rays are then searched sixteen points at a time.
    virtual bool batched() const { return false; }
    /// value() of sixteen points.
    virtual void values(const Vec3d (&p)[16], double time, double* out) const
    {
        for (int i = 0; i < 16; ++i) out[i] = value(p[i], time);
    }
    /// Proved, for all times. An empty range of values says that nothing exists anywhere in the box.
    virtual LocalField local(const Box3d& box) const = 0;
    /// Where the surface exists: a crossing elsewhere is none.
    virtual bool exists(const Vec3d& p, double time) const = 0;

    /// For the paper's mode: where the point came from, and the base there.
    virtual Vec3d inverse(const Vec3d& p, double time) const = 0;
    virtual double base_value(const Vec3d& q) const = 0;
};

enum class MarchMode { certified, paper };

struct PatchSettings {
    Box3d domain;            ///< finite
    double size = 1.0;       ///< of a patch, about, metres
    Vec3d focus{0.0};        ///< patches grow with the horizontal distance from here:
    double growth = 0.0;     ///< metres a metre
    bool moving = false;     ///< the field changes with time
    double flat = 1e-7;      ///< of the field: a graze this shallow may be met or not
    double accuracy = 1e-7;  ///< metres: of a crossing along the ray
    MarchMode mode = MarchMode::certified;
    double epsilon = 1e-3;  ///< paper: largest area of a triangle, square metres, at the base's surface; grows with |base| / epsilon_distance
    double epsilon_distance = 1.0;
    std::uint32_t most_patches = 20'000'000;
};

/// One marched field in tiles of patches. The verbs are those of Surface, with the same contracts.
class FieldIntersector
{
public:
    virtual ~FieldIntersector() = default;
    virtual std::uint32_t tile_count() const = 0;
    virtual std::uint32_t patch_count(std::uint32_t tile) const = 0;
    virtual Box3d patch_bounds(PatchId patch) const = 0;
    virtual bool intersect(PatchId patch, const Ray& ray, Hit& hit) const = 0;
    virtual bool occluded(PatchId patch, const Ray& ray) const = 0;
    virtual std::uint64_t memory_bytes() const = 0;
};

/// Keeps a reference to the field. Throws Error (memory) when there would be more patches than allowed. In paper mode there is one patch, the domain,
/// as in the paper: the area test decides alone.
std::unique_ptr<FieldIntersector> make_field_patches(const MarchedField& field, const PatchSettings& settings);

}  // namespace hoodoo
