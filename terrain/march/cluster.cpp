// Grouping and packing of exact cells: the second half of building them.
//
// Chains are split recursively in two along the best of three axes; the cost of a side is the area of its box times the number of
// records it will fill. A group that fits into one record becomes one. What is packed is unpacked by slab(), which serves the exact solver
// and the boxes alike: a box can never disagree with what is traced.

#include "terrain/march/cluster.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include <sys/mman.h>

namespace hoodoo
{
namespace
{

constexpr std::size_t kLevels = 16;
constexpr int kCells = 4;
constexpr double kCompactHeight = 255.0;

struct Piece {
    const Chain* chain;
    Vec3d lo, hi;  ///< lattice coordinates
};

std::array<double, 8> corner_values(const Level& lower, const Level& upper, double delta)
{
    std::array<double, 8> v;
    for (int i = 0; i < 4; ++i) v[i] = lower.value[i] - delta, v[i + 4] = upper.value[i] - delta;
    return v;
}

Piece make_piece(const Lattice& lattice, const Chain& chain)
{
    Piece piece{&chain, Vec3d(kInfinity), Vec3d(-kInfinity)};
    for (std::size_t q = 0; q + 1 < chain.levels.size(); ++q) {
        Vec3d lo, hi;
        tight_box(corner_values(chain.levels[q], chain.levels[q + 1], lattice.delta), lo, hi);
        const double z0 = chain.levels[q].z, dz = chain.levels[q + 1].z - z0;
        const Vec3d base(chain.a, chain.b, z0);
        for (int k = 0; k < 3; ++k) {
            const double size = k == 2 ? dz : 1.0;
            piece.lo[k] = std::min(piece.lo[k], base[k] + lo[k] * size);
            piece.hi[k] = std::max(piece.hi[k], base[k] + hi[k] * size);
        }
    }
    return piece;
}

/// What decides whether a set of pieces fits into one record, and what it costs.
struct Extent {
    Vec3d lo{kInfinity}, hi{-kInfinity};
    int a0 = 1 << 30, a1 = -(1 << 30), b0 = 1 << 30, b1 = -(1 << 30);
    double z0 = kInfinity, z1 = -kInfinity;
    std::size_t levels = 0;

    void add(const Piece& p)
    {
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], p.lo[k]), hi[k] = std::max(hi[k], p.hi[k]);
        const Chain& c = *p.chain;
        a0 = std::min(a0, c.a), a1 = std::max(a1, c.a), b0 = std::min(b0, c.b), b1 = std::max(b1, c.b);
        z0 = std::min(z0, c.levels.front().z), z1 = std::max(z1, c.levels.back().z);
        levels += c.levels.size();
    }
    void add(const Extent& e)
    {
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], e.lo[k]), hi[k] = std::max(hi[k], e.hi[k]);
        a0 = std::min(a0, e.a0), a1 = std::max(a1, e.a1), b0 = std::min(b0, e.b0), b1 = std::max(b1, e.b1);
        z0 = std::min(z0, e.z0), z1 = std::max(z1, e.z1);
        levels += e.levels;
    }
    bool fits() const { return levels <= kLevels && a1 - a0 < kCells && b1 - b0 < kCells && z1 - z0 <= kCompactHeight; }
    double cost(const Vec3d& scale) const
    {
        const Vec3d d = (hi - lo) * scale;
        return (d.x * d.y + d.y * d.z + d.z * d.x) * static_cast<double>((levels + kLevels - 1) / kLevels);
    }
};

class Grouper
{
public:
    Grouper(const Lattice& lattice, int a0, int b0, ClusterList& out)
        : lattice_(lattice), a0_(a0), b0_(b0), out_(out), scale_(lattice.cell, lattice.cell, lattice.unit)
    {
    }

    void group(std::vector<Piece>& pieces, std::size_t first, std::size_t last)
    {
        Extent all;
        for (std::size_t i = first; i < last; ++i) all.add(pieces[i]);
        if (all.fits()) {
            pack(pieces, first, last, all);
            return;
        }
        const std::size_t middle = split(pieces, first, last);
        group(pieces, first, middle);
        group(pieces, middle, last);
    }

private:
    /// Many pieces are split between bins of equal width, few by a full sweep. Returns the first piece of the upper half.
    std::size_t split(std::vector<Piece>& pieces, std::size_t first, std::size_t last)
    {
        if (last - first > 24) {
            const std::size_t middle = split_by_bins(pieces, first, last);
            if (middle != first && middle != last) return middle;
        }
        double best = kInfinity;
        int best_axis = 0;
        std::size_t best_at = (first + last) / 2;
        costs_.resize(last - first);
        for (int axis = 0; axis < 3; ++axis) {
            sort(pieces, first, last, axis);
            Extent left;
            for (std::size_t i = first; i < last; ++i) left.add(pieces[i]), costs_[i - first] = left.cost(scale_);
            Extent right;
            for (std::size_t i = last - 1; i > first; --i) {
                right.add(pieces[i]);
                const double cost = costs_[i - 1 - first] + right.cost(scale_);
                if (cost < best) best = cost, best_axis = axis, best_at = i;
            }
        }
        if (best_axis != 2) sort(pieces, first, last, best_axis);
        return best_at;
    }

    std::size_t split_by_bins(std::vector<Piece>& pieces, std::size_t first, std::size_t last)
    {
        constexpr int bins = 16;
        Vec3d lo(kInfinity), hi(-kInfinity);
        for (std::size_t i = first; i < last; ++i)
            for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], middle(pieces[i], k)), hi[k] = std::max(hi[k], middle(pieces[i], k));
        double best = kInfinity;
        int best_axis = -1, best_bin = 0;
        const auto bin_of = [&](const Piece& p, int k) {
            return std::min(bins - 1, static_cast<int>((middle(p, k) - lo[k]) / (hi[k] - lo[k]) * bins));
        };
        for (int axis = 0; axis < 3; ++axis) {
            if (!(hi[axis] > lo[axis])) continue;
            std::array<Extent, bins> bin;
            for (std::size_t i = first; i < last; ++i) bin[static_cast<std::size_t>(bin_of(pieces[i], axis))].add(pieces[i]);
            std::array<double, bins> below;
            Extent left, right;
            for (std::size_t k = 0; k < bins; ++k) left.add(bin[k]), below[k] = left.levels ? left.cost(scale_) : 0.0;
            for (std::size_t k = bins - 1; k > 0; --k) {
                right.add(bin[k]);
                const double cost = below[k - 1] + (right.levels ? right.cost(scale_) : 0.0);
                if (cost < best) best = cost, best_axis = axis, best_bin = static_cast<int>(k);
            }
        }
        if (best_axis < 0) return first;
        const auto at = std::partition(pieces.begin() + static_cast<std::ptrdiff_t>(first), pieces.begin() + static_cast<std::ptrdiff_t>(last),
                                       [&](const Piece& p) { return bin_of(p, best_axis) < best_bin; });
        return static_cast<std::size_t>(at - pieces.begin());
    }

    static double middle(const Piece& p, int axis) { return p.lo[axis] + p.hi[axis]; }

    static void sort(std::vector<Piece>& pieces, std::size_t first, std::size_t last, int axis)
    {
        const auto at = [&](std::size_t i) { return pieces.begin() + static_cast<std::ptrdiff_t>(i); };
        // Ties are broken by the cell, so that the result does not depend on the order of an earlier sort.
        std::sort(at(first), at(last), [axis](const Piece& p, const Piece& q) {
            const double s = p.lo[axis] + p.hi[axis], t = q.lo[axis] + q.hi[axis];
            if (s != t) return s < t;
            if (p.chain->b != q.chain->b) return p.chain->b < q.chain->b;
            if (p.chain->a != q.chain->a) return p.chain->a < q.chain->a;
            return p.chain->levels.front().z < q.chain->levels.front().z;
        });
    }

    void pack(const std::vector<Piece>& pieces, std::size_t first, std::size_t last, const Extent& extent);
    GradientCone cone(const std::vector<Piece>& pieces, std::size_t first, std::size_t last) const;

    const Lattice& lattice_;
    int a0_, b0_;
    ClusterList& out_;
    Vec3d scale_;
    std::vector<double> costs_;
    std::vector<GradientCone> wide_cones_;

public:
    void finish() { out_.cones.insert(out_.cones.end(), wide_cones_.begin(), wide_cones_.end()); }
};

GradientCone Grouper::cone(const std::vector<Piece>& pieces, std::size_t first, std::size_t last) const
{
    // The derivative along an axis is bilinear across it: its extremes are differences of corner values.
    Vec3d lo(kInfinity), hi(-kInfinity);
    const auto take = [&](int k, double d) { lo[k] = std::min(lo[k], d / scale_[k]), hi[k] = std::max(hi[k], d / scale_[k]); };
    for (std::size_t i = first; i < last; ++i) {
        const std::vector<Level>& levels = pieces[i].chain->levels;
        for (std::size_t q = 0; q < levels.size(); ++q) {
            const std::array<double, 4>& v = levels[q].value;
            take(0, v[1] - v[0]), take(0, v[3] - v[2]);
            take(1, v[2] - v[0]), take(1, v[3] - v[1]);
            if (q + 1 == levels.size()) continue;
            for (int c = 0; c < 4; ++c) take(2, (levels[q + 1].value[c] - v[c]) / (levels[q + 1].z - levels[q].z));
        }
    }
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(lo[k]), std::abs(hi[k])});
    GradientCone cone;
    for (int k = 0; k < 3; ++k) {
        // A hundredth of a step outwards: more than single precision loses when the cone is tested.
        cone.lo[k] = static_cast<std::int8_t>(std::max(-127.0, std::floor(lo[k] * 125.0 / largest - 0.01)));
        cone.hi[k] = static_cast<std::int8_t>(std::min(127.0, std::ceil(hi[k] * 125.0 / largest + 0.01)));
    }
    return cone;
}

void Grouper::pack(const std::vector<Piece>& pieces, std::size_t first, std::size_t last, const Extent& extent)
{
    bool compact = lattice_.whole && std::abs(extent.z0) <= 32000.0;
    for (std::size_t i = first; i < last; ++i)
        for (const Level& l : pieces[i].chain->levels)
            for (const double v : l.value) compact = compact && std::abs(v) <= 2047.0;

    CompactCluster narrow{};
    WideCluster wide{};
    std::size_t lane = 0;
    std::uint16_t slabs = 0;
    std::uint64_t offsets = 0;
    for (std::size_t i = first; i < last; ++i) {
        const Chain& chain = *pieces[i].chain;
        const std::uint64_t offset = static_cast<std::uint64_t>((chain.a - extent.a0) | ((chain.b - extent.b0) << 2));
        for (std::size_t q = 0; q < chain.levels.size(); ++q, ++lane) {
            const Level& l = chain.levels[q];
            if (q + 1 < chain.levels.size()) slabs = static_cast<std::uint16_t>(slabs | (1u << lane));
            offsets |= offset << (4 * lane);
            narrow.z[lane] = static_cast<std::uint8_t>(l.z - extent.z0);
            wide.z[lane] = l.z;
            for (int c = 0; c < 4; ++c) {
                const auto bits = static_cast<unsigned>(static_cast<int>(compact ? l.value[c] : 0.0)) & 0xfffu;
                narrow.low[c][lane] = static_cast<std::uint8_t>(bits);
                narrow.high[c / 2][lane] = static_cast<std::uint8_t>(narrow.high[c / 2][lane] | ((bits >> 8) << (4 * (c % 2))));
                wide.value[c][lane] = static_cast<float>(l.value[c]);
            }
        }
    }
    const auto x0 = static_cast<std::uint8_t>(extent.a0 - a0_), y0 = static_cast<std::uint8_t>(extent.b0 - b0_);
    if (compact) {
        narrow.slabs = slabs, narrow.offsets = offsets, narrow.x0 = x0, narrow.y0 = y0, narrow.z_base = static_cast<std::int16_t>(extent.z0);
        out_.compact.push_back(narrow);
        out_.cones.push_back(cone(pieces, first, last));
    } else {
        wide.slabs = slabs, wide.offsets = offsets, wide.x0 = x0, wide.y0 = y0;
        out_.wide.push_back(wide);
        wide_cones_.push_back(cone(pieces, first, last));
    }
}

}  // namespace

Slab CellTile::slab(std::uint32_t i, int lane, double delta) const
{
    Slab s;
    if (i < compact.size()) {
        const CompactCluster& c = compact[i];
        const auto offset = static_cast<int>((c.offsets >> (4 * lane)) & 15u);
        s.x = c.x0 + (offset & 3), s.y = c.y0 + (offset >> 2);
        s.z0 = c.z_base + c.z[lane], s.z1 = c.z_base + c.z[lane + 1];
        for (int k = 0; k < 8; ++k) {
            const int corner = k & 3, level = lane + (k >> 2);
            const unsigned nibble = (static_cast<unsigned>(c.high[corner / 2][level]) >> (4 * (corner % 2))) & 15u;
            const auto bits = static_cast<std::int32_t>((nibble << 28) | (static_cast<unsigned>(c.low[corner][level]) << 20));
            s.value[k] = static_cast<double>(bits >> 20) - delta;
        }
    } else {
        const WideCluster& c = wide[i - compact.size()];
        const auto offset = static_cast<int>((c.offsets >> (4 * lane)) & 15u);
        s.x = c.x0 + (offset & 3), s.y = c.y0 + (offset >> 2);
        s.z0 = c.z[lane], s.z1 = c.z[lane + 1];
        for (int k = 0; k < 8; ++k) s.value[k] = static_cast<double>(c.value[k & 3][lane + (k >> 2)]) - delta;
    }
    return s;
}

ClusterList make_clusters(const Lattice& lattice, int a0, int b0, const std::vector<Chain>& chains)
{
    ClusterList list;
    std::vector<Piece> pieces;
    pieces.reserve(chains.size());
    for (const Chain& chain : chains) pieces.push_back(make_piece(lattice, chain));
    if (pieces.empty()) return list;
    Grouper grouper(lattice, a0, b0, list);
    grouper.group(pieces, 0, pieces.size());
    grouper.finish();
    return list;
}

ClusterMemory::ClusterMemory(std::span<const ClusterList> lists, std::span<CellTile> tiles)
{
    std::size_t compact = 0, wide = 0, cones = 0;
    for (const ClusterList& l : lists) compact += l.compact.size(), wide += l.wide.size(), cones += l.cones.size();
    bytes_ = compact * sizeof(CompactCluster) + wide * sizeof(WideCluster) + cones * sizeof(GradientCone);
    if (bytes_ == 0) return;
    constexpr std::size_t page = std::size_t{1} << 21;
    const std::size_t alignment = bytes_ >= page ? page : 64;
    const std::size_t size = (bytes_ + alignment - 1) / alignment * alignment;
    block_.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, size)));
    if (!block_) throw std::bad_alloc();
    if (alignment == page) madvise(block_.get(), size, MADV_HUGEPAGE);  // a wish: refused, nothing but speed is lost

    // Compact records, wide records, cones: each kind in one run, tiles in order.
    std::byte* at[3] = {block_.get(), block_.get() + compact * sizeof(CompactCluster),
                        block_.get() + compact * sizeof(CompactCluster) + wide * sizeof(WideCluster)};
    const auto place = [](auto& list, std::byte*& to) {
        using T = typename std::remove_cvref_t<decltype(list)>::value_type;
        if (!list.empty()) std::memcpy(to, list.data(), list.size() * sizeof(T));
        const std::span<const T> span(reinterpret_cast<const T*>(to), list.size());
        to += list.size() * sizeof(T);
        return span;
    };
    for (std::size_t i = 0; i < lists.size(); ++i) {
        tiles[i].compact = place(lists[i].compact, at[0]);
        tiles[i].wide = place(lists[i].wide, at[1]);
        tiles[i].cones = place(lists[i].cones, at[2]);
    }
}

void cluster_box(const CellTile& tile, std::uint32_t index, const Lattice& lattice, Vec3d& lo, Vec3d& hi)
{
    lo = Vec3d(kInfinity), hi = Vec3d(-kInfinity);
    const std::uint16_t slabs = tile.slabs(index);
    for (int lane = 0; lane < 15; ++lane) {
        if (!((slabs >> lane) & 1u)) continue;
        const Slab s = tile.slab(index, lane, lattice.delta);
        Vec3d l, h;
        tight_box(s.value, l, h);
        const Vec3d base(tile.a0 + s.x, tile.b0 + s.y, s.z0), size(1.0, 1.0, s.z1 - s.z0);
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], base[k] + l[k] * size[k]), hi[k] = std::max(hi[k], base[k] + h[k] * size[k]);
    }
}

}  // namespace hoodoo
