// Dart throwing in a periodic cube (Lagae2006): a point is kept if no earlier one lies within two radii, across the cube's faces too.
//
// Random placing of equal spheres stops at a share of 0.384 of the space (Zhang2013), so N spheres reach r/L = (3 * 0.384 / (4 pi N))^(1/3): the
// default radius stays a little under it. Attempts are numbers of a counter; where one sequence gets stuck the next begins. Deviation: the paper
// relaxes nothing and neither do we. Missing: nothing.

#include "terrain/rocks/poisson_spheres.h"

#include "terrain/math/hash.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kSaturated = 0.384;
constexpr double kPi = 3.14159265358979323846;

/// Buckets at least two radii wide, so that only neighbours need asking.
class PeriodicBuckets
{
public:
    PeriodicBuckets(double length, double radius) : length_(length), reach_(2.0 * radius)
    {
        n_ = std::clamp(static_cast<int>(length / std::max(reach_, 1e-9 * length)), 1, 64);
        buckets_.resize(static_cast<std::size_t>(n_) * n_ * n_);
    }

    bool is_free(const Vec3d& p) const
    {
        const Vec3i c = cell(p);
        const int span = n_ < 3 ? n_ : 3;
        for (int dz = 0; dz < span; ++dz)
            for (int dy = 0; dy < span; ++dy)
                for (int dx = 0; dx < span; ++dx)
                    for (const Vec3d& q : at(c.x + dx - 1, c.y + dy - 1, c.z + dz - 1))
                        if (distance2(p, q) < reach_ * reach_) return false;
        return true;
    }
    void add(const Vec3d& p)
    {
        const Vec3i c = cell(p);
        buckets_[index(c.x, c.y, c.z)].push_back(p);
    }

private:
    Vec3i cell(const Vec3d& p) const
    {
        const auto k = [&](double x) { return std::min(n_ - 1, static_cast<int>(x / length_ * n_)); };
        return {k(p.x), k(p.y), k(p.z)};
    }
    std::size_t index(int x, int y, int z) const
    {
        const auto wrap = [&](int k) { return static_cast<std::size_t>((k % n_ + n_) % n_); };
        return (wrap(z) * static_cast<std::size_t>(n_) + wrap(y)) * static_cast<std::size_t>(n_) + wrap(x);
    }
    const std::vector<Vec3d>& at(int x, int y, int z) const { return buckets_[index(x, y, z)]; }
    double distance2(const Vec3d& p, const Vec3d& q) const
    {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double d = std::abs(p[k] - q[k]), around = std::min(d, length_ - d);
            sum += around * around;
        }
        return sum;
    }

    double length_, reach_;
    int n_;
    std::vector<std::vector<Vec3d>> buckets_;
};

}  // namespace

double random_packing_radius(double count, double length)
{
    return length * std::cbrt(3.0 * kSaturated / (4.0 * kPi * count));
}

int random_packing_count(double radius, double length)
{
    return static_cast<int>(std::min(1e6, 3.0 * kSaturated / (4.0 * kPi) * std::pow(length / radius, 3.0)));
}

std::vector<Vec3d> poisson_spheres(int count, double length, double radius, std::uint64_t seed)
{
    std::vector<Vec3d> best;
    // A sphere may not meet its own copy either.
    if (2.0 * radius > length) return best;
    for (std::int64_t restart = 0; restart < 8; ++restart) {
        PeriodicBuckets buckets(length, radius);
        std::vector<Vec3d> points;
        const std::uint64_t stream = hash_cell(seed, restart, 0);
        for (std::int64_t attempt = 0; attempt < 4000ll * count && static_cast<int>(points.size()) < count; ++attempt) {
            const std::uint64_t h = hash_combine(stream, static_cast<std::uint64_t>(attempt));
            const Vec3d p = Vec3d(unit_real(h), unit_real(mix64(h + 1)), unit_real(mix64(h + 2))) * length;
            if (!buckets.is_free(p)) continue;
            buckets.add(p);
            points.push_back(p);
        }
        if (points.size() > best.size()) best = std::move(points);
        if (static_cast<int>(best.size()) == count) break;
    }
    return best;
}

PeriodicSites::PeriodicSites(std::vector<Vec3d> points, double length, double radius, std::uint64_t seed) : SiteArrangement(length, radius)
{
    for (std::size_t k = 0; k < points.size(); ++k) sites_.push_back({points[k], hash_cell(seed, static_cast<std::int64_t>(k), 0)});
}

}  // namespace hoodoo
