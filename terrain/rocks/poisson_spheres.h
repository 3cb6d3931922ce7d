// Points that keep their distance in a cube whose faces are glued together: the seeds of a tile of rocks.
#pragma once

#include "terrain/rocks/sites.h"

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// The radius at which random placing of `count` spheres in a cube of edge `length` is saturated, metres: their share of the space is 0.384.
double random_packing_radius(double count, double length);

/// The greatest number of spheres of that radius which random placing reaches in the cube.
int random_packing_count(double radius, double length);

/// Up to `count` points of [0, length)^3, each at least 2 `radius` from all others and their periodic copies. Fewer if they do not fit (or are not
/// found after 8 times 4000 `count` attempts): the most that were placed. A function of its arguments.
std::vector<Vec3d> poisson_spheres(int count, double length, double radius, std::uint64_t seed);

/// One cube of points repeated for ever (the tile of Peytavie2009).
class PeriodicSites final : public SiteArrangement
{
public:
    PeriodicSites(std::vector<Vec3d> points, double length, double radius, std::uint64_t seed);
    std::span<const Site> sites(const Vec3i&) const override { return sites_; }
    SiteId canonical(const SiteId& id) const override { return {Vec3i(0), id.index}; }
    double density() const override { return static_cast<double>(sites_.size()); }

private:
    std::vector<Site> sites_;
};

}  // namespace hoodoo
