// Foam, spray, mist: a density of space that scatters, crossed by tracking against proved upper bounds.
#pragma once

#include "renderer/media/stream.h"
#include "terrain/density.h"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace hoodoo
{

/// What the density is made of, where it is 1.
struct RegionMaterial {
    double extinction = 1.0;  ///< 1/m, the same in every channel
    Vec3f albedo{1.0f};       ///< in the rendering space
    double asymmetry = 0.0;
};

/// Immutable but for a counter, thread-safe.
class Region
{
public:
    /// Builds a grid of upper bounds of at most `cells` cells in the current arena. A density without extent scatters nothing. Throws Error
    /// (internal) if its bounds are not finite. `density` must not be null; share it or lend it (a shared pointer without an owner).
    Region(std::shared_ptr<const Density> density, const RegionMaterial& material, std::size_t cells = kCells);
    Region(Region&& other) noexcept;

    const RegionMaterial& material() const { return material_; }

    /// Distance of a random collision on the first `t_max` metres of the ray: the density of collisions is exactly that of the medium
    /// (Woodcock1965).
    std::optional<double> collide(const Ray& ray, double t_max, NumberStream& random) const;

    /// An unbiased estimate of the share of light that passes, in [0, 1] (ratio tracking, Novak2014).
    double transmittance(const Ray& ray, double t_max, NumberStream& random) const;

    /// Samples of the density that were above its bound: 0, or its bound is not one.
    std::uint64_t samples_above_bound() const { return above_.load(std::memory_order_relaxed); }

    static constexpr std::size_t kCells = std::size_t{1} << 18;

private:
    template <class Stop>
    bool track(const Ray& ray, double t_max, NumberStream& random, Stop&& stop) const;
    double density_over(float bound, const Vec3d& p, double time) const;
    std::size_t index(const Imath::V3i& cell) const
    {
        return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(cell.y)) *
                   static_cast<std::size_t>(size_.x) +
               static_cast<std::size_t>(cell.x);
    }

    std::shared_ptr<const Density> density_;
    RegionMaterial material_;
    Box3d bounds_;
    Imath::V3i size_{0};
    Vec3d cell_{0.0};               ///< metres
    std::vector<float> bounds_of_;  ///< of the density in each cell, x fastest
    mutable std::atomic<std::uint64_t> above_{0};
};

}  // namespace hoodoo
