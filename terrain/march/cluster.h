// The record of exact cells: up to 16 levels of a few neighbouring lattice cells, packed so that one SIMD kernel meets them all at once.
#pragma once

#include "terrain/march/profiles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

namespace hoodoo
{

/// 16 levels, each with four corner values; bit q of `slabs` says that levels q and q + 1 bound a slab of the cell `offsets` names for lane q.
/// Cells lie within 4 x 4 of (x0, y0), which counts in cells of the tile. Values are integers of 12 bits, heights integers of 8 bits: exact.
struct alignas(64) CompactCluster {
    std::uint64_t offsets;  ///< 4 bits a lane: x in the low two, y in the high two
    std::uint16_t slabs;
    std::uint8_t x0, y0;
    std::int16_t z_base;
    std::uint8_t z[16];        ///< above z_base
    std::uint8_t low[4][16];   ///< low byte of each corner's value
    std::uint8_t high[2][16];  ///< high nibble of corners 0 and 1 (low, high half), and of corners 2 and 3
    std::uint16_t unused;      ///< a kernel may read one byte past the arrays
};
static_assert(sizeof(CompactCluster) == 128);

/// The same for values that need more bits, or that are not integers.
struct alignas(64) WideCluster {
    std::uint64_t offsets;
    std::uint16_t slabs;
    std::uint8_t x0, y0;
    float unused;
    double z[16];
    float value[4][16];
    float unused_too;  ///< a kernel may read one value past the arrays
};

/// Bounds of the gradient over a cluster, world axes, rounded outwards; no length: only its direction is asked.
struct GradientCone {
    std::int8_t lo[3], hi[3];
    std::uint16_t unused = 0;

    /// Proved: F cannot decrease along `d` anywhere in the cluster, so a ray cannot enter matter there.
    bool rejects(const float d[3]) const
    {
        float least = 0.0f;
        for (int k = 0; k < 3; ++k) least += std::min(d[k] * static_cast<float>(lo[k]), d[k] * static_cast<float>(hi[k]));
        return least >= 0.0f;
    }
};

/// One slab as the exact solver wants it.
struct Slab {
    int x, y;  ///< cell, counted in the tile
    double z0, z1;
    std::array<double, 8> value;  ///< F - delta at the corners: four below, four above, x fast
};

/// All records of one tile of lattice cells whose first cell is (a0, b0). Patch i is compact[i], then wide[i - compact.size()].
/// The records live elsewhere: in ClusterMemory.
struct CellTile {
    int a0 = 0, b0 = 0;
    std::span<const GradientCone> cones;
    std::span<const CompactCluster> compact;
    std::span<const WideCluster> wide;

    std::uint32_t size() const { return static_cast<std::uint32_t>(compact.size() + wide.size()); }
    std::uint16_t slabs(std::uint32_t i) const { return i < compact.size() ? compact[i].slabs : wide[i - compact.size()].slabs; }
    Slab slab(std::uint32_t i, int lane, double delta) const;
};

/// The records of one tile, as they are made.
struct ClusterList {
    std::vector<GradientCone> cones;
    std::vector<CompactCluster> compact;
    std::vector<WideCluster> wide;
};

/// One block of memory for the records of many tiles, on huge pages where the system has them: rays jump through it at random.
class ClusterMemory
{
public:
    ClusterMemory() = default;
    /// Copies the lists in and lets tiles[i] refer to lists[i]'s copy.
    ClusterMemory(std::span<const ClusterList> lists, std::span<CellTile> tiles);
    std::uint64_t bytes() const { return bytes_; }

private:
    struct Free {
        void operator()(std::byte* p) const { std::free(p); }
    };
    std::unique_ptr<std::byte, Free> block_;
    std::uint64_t bytes_ = 0;
};

/// Groups the chains of a tile into clusters by the surface-area heuristic (each cluster costs the same) and packs them.
ClusterList make_clusters(const Lattice& lattice, int a0, int b0, const std::vector<Chain>& chains);

/// The tight box of one patch, lattice coordinates.
void cluster_box(const CellTile& tile, std::uint32_t index, const Lattice& lattice, Vec3d& lo, Vec3d& hi);

}  // namespace hoodoo
