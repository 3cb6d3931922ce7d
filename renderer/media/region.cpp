// Delta tracking (Woodcock1965) and ratio tracking (Novak2014) through a grid of proved bounds.
//
// In a cell with the bound m of the density, tentative collisions come at the rate sigma m. Each is real with the probability density / m (delta
// tracking), or multiplies the transmittance by 1 - density / m (ratio tracking). The exponential has no memory, so tracking starts anew at each
// cell's face; empty cells cost a step of the grid's walk (Amanatides1987). The walk's faces are rounded, so bounds are asked for boxes larger by a
// thousandth of a cell. Ratio tracking ends by roulette once almost nothing passes, with the mean kept.
// Deviation: one bound for all times of the shutter.
#include "renderer/media/region.h"

#include "terrain/error.h"
#include "terrain/math/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hoodoo
{
namespace
{

constexpr double kMargin = 1e-3;    // of a cell
constexpr double kRoulette = 0.05;  // transmittance below which a shadow ray may end

/// Rounded up: the bound stays one.
float float_above(double x)
{
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

Region::Region(std::shared_ptr<const Density> density, const RegionMaterial& material, std::size_t cells)
    : density_(std::move(density)), material_(material), bounds_(density_->bounds())
{
    if (bounds_.isEmpty() || !bounds_.hasVolume()) return;
    if (!is_finite(bounds_.min) || !is_finite(bounds_.max)) throw Error(ErrorKind::internal, "a density without finite bounds");

    // Cells as near to cubes as their number allows.
    const Vec3d extent = bounds_.size();
    const double edge = std::cbrt(extent.x * extent.y * extent.z / static_cast<double>(cells));
    for (int k = 0; k < 3; ++k) {
        size_[k] = std::clamp(static_cast<int>(extent[k] / edge), 1, static_cast<int>(std::min<std::size_t>(cells, 4096)));
        cell_[k] = extent[k] / size_[k];
    }
    bounds_of_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z));
    parallel_items(size_.z, [&](int z) {
        for (int y = 0; y < size_.y; ++y) {
            for (int x = 0; x < size_.x; ++x) {
                const Vec3d low = bounds_.min + Vec3d(x, y, z) * cell_, pad = cell_ * kMargin;
                const double bound = density_->majorant(Box3d(low - pad, low + cell_ + pad), {0.0, 1.0});
                bounds_of_[index({x, y, z})] = bound > 0.0 ? float_above(bound) : 0.0f;
            }
        }
    });
}

Region::Region(Region&& other) noexcept
    : density_(std::move(other.density_)),
      material_(other.material_),
      bounds_(other.bounds_),
      size_(other.size_),
      cell_(other.cell_),
      bounds_of_(std::move(other.bounds_of_)),
      above_(other.above_.load())
{
}

/// Density over its bound: the probability of a real collision.
double Region::density_over(float bound, const Vec3d& p, double time) const
{
    const double share = density_->value(p, time) / static_cast<double>(bound);
    if (share > 1.0) above_.fetch_add(1, std::memory_order_relaxed);
    return share;
}

/// Calls stop(t, share) at each tentative collision until it says so; whether it did.
template <class Stop>
bool Region::track(const Ray& ray, double t_max, NumberStream& random, Stop&& stop) const
{
    if (bounds_of_.empty()) return false;

    // The way through the bounds ...
    double t = 0.0, end = t_max;
    for (int k = 0; k < 3; ++k) {
        const double o = ray.origin[k], d = ray.direction[k];
        if (d == 0.0) {
            if (!(o >= bounds_.min[k] && o <= bounds_.max[k])) return false;
            continue;
        }
        const double a = (bounds_.min[k] - o) / d, b = (bounds_.max[k] - o) / d;
        t = std::max(t, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(t < end)) return false;

    // ... cell by cell.
    Imath::V3i cell, step;
    Vec3d next, width;
    for (int k = 0; k < 3; ++k) {
        const double o = ray.origin[k] - bounds_.min[k], d = ray.direction[k];
        cell[k] = std::clamp(static_cast<int>(std::floor((o + t * d) / cell_[k])), 0, size_[k] - 1);
        step[k] = d > 0.0 ? 1 : -1;
        next[k] = d == 0.0 ? kInfinity : ((cell[k] + (d > 0.0 ? 1 : 0)) * cell_[k] - o) / d;
        width[k] = d == 0.0 ? kInfinity : cell_[k] / std::abs(d);
    }
    while (true) {
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        const double out = std::min(next[axis], end);
        const float bound = bounds_of_[index(cell)];
        const double rate = material_.extinction * static_cast<double>(bound);
        while (rate > 0.0) {
            t -= std::log1p(-random()) / rate;
            if (!(t < out)) break;
            if (stop(t, density_over(bound, ray.at(t), ray.time))) return true;
        }
        t = out;
        if (!(next[axis] < end)) return false;
        cell[axis] += step[axis];
        if (cell[axis] < 0 || cell[axis] >= size_[axis]) return false;
        next[axis] += width[axis];
    }
}

std::optional<double> Region::collide(const Ray& ray, double t_max, NumberStream& random) const
{
    double where = 0.0;
    const bool met = track(ray, t_max, random, [&](double t, double share) {
        where = t;
        return random() < share;
    });
    return met ? std::optional(where) : std::nullopt;
}

double Region::transmittance(const Ray& ray, double t_max, NumberStream& random) const
{
    double passing = 1.0;
    const bool ended = track(ray, t_max, random, [&](double, double share) {
        passing *= std::max(0.0, 1.0 - share);
        if (passing >= kRoulette) return false;
        if (!(random() < passing / kRoulette)) return true;
        passing = kRoulette;
        return false;
    });
    return ended ? 0.0 : passing;
}

}  // namespace hoodoo
