// Where the seed points of rocks lie: an endless arrangement of cubic tiles, the same one repeated or one chosen by the colours of its corners.
#pragma once

#include "terrain/math/vec.h"

#include <compare>
#include <cstdint>
#include <span>
#include <tuple>

namespace hoodoo
{

using Vec3i = Imath::V3i;

/// A seed point in its tile. `key` is the same in every copy of the point: what is hashed from it is the same wherever the rock lies.
struct Site {
    Vec3d position{0.0};  ///< in [0, length)^3
    std::uint64_t key = 0;
};

/// One point of the arrangement: the tile and the place in its list.
struct SiteId {
    Vec3i tile{0};
    std::uint32_t index = 0;
    bool operator==(const SiteId& o) const { return tile == o.tile && index == o.index; }
    bool operator<(const SiteId& o) const { return std::tie(tile.z, tile.y, tile.x, index) < std::tie(o.tile.z, o.tile.y, o.tile.x, o.index); }
};

/// Points no two of which are nearer than 2 radius, in space before it is stretched. Immutable, thread-safe.
class SiteArrangement
{
public:
    virtual ~SiteArrangement() = default;
    double length() const { return length_; }  ///< edge of a tile, metres before stretching
    double radius() const { return radius_; }  ///< half the least distance of two points, metres before stretching
    virtual std::span<const Site> sites(const Vec3i& tile) const = 0;
    /// A point with the same surroundings, the same for all that have them as far as the arrangement knows: where geometry is computed once.
    virtual SiteId canonical(const SiteId& id) const { return id; }
    /// Points a tile holds on average.
    virtual double density() const = 0;

    Vec3d position(const SiteId& id) const { return Vec3d(id.tile) * length_ + sites(id.tile)[id.index].position; }

protected:
    SiteArrangement(double length, double radius) : length_(length), radius_(radius) {}

private:
    double length_, radius_;
};

}  // namespace hoodoo
