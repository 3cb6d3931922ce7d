// Any field with bounds over boxes, cut into tight proved boxes and met by rays: certified, or with the paper's area test.
#pragma once

#include "terrain/march/marched_field.h"
#include "terrain/surface.h"

#include <functional>
#include <memory>

namespace hoodoo
{

enum class MarchMode { certified, paper };

struct PatchSettings {
    Box3d domain;            ///< finite
    double size = 1.0;       ///< of a patch, about, metres
    Vec3d focus{0.0};        ///< patches grow with the horizontal distance from here:
    double growth = 0.0;     ///< metres a metre
    bool moving = false;     ///< the field changes with time
    bool cut_edges = false;  ///< boxes in which the surface exists in a part only are cut down to size, however flat the field
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
