// The convolution surface met in closed form: lattice cells, packed in clusters, cut into tiles.
//
// Peytavie2009 traces a polygonised surface; here the field itself is traced. Inside a lattice cell it is trilinear between knots
// (lattice.h), so a crossing is a root of a cubic. A patch is one cluster of cells (cluster.h). A ray meets it in three steps: the cone of
// its gradients rejects what can only be left, a SIMD filter in single precision drops the slabs that hold no crossing, and what remains is
// solved in double precision (slab_root.h). Only the last step decides, so no answer depends on rounding in the filter or on the processor.
//
// Needs 2 sigma to be a multiple of the cell. What is missing: nothing known.

#include "terrain/march/exact_cells.h"

#include "terrain/march/cell_kernel.h"
#include "terrain/march/cluster.h"
#include "terrain/march/slab_root.h"
#include "terrain/march/touched.h"
#include "terrain/math/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace hoodoo
{
namespace
{

class ExactCells final : public PatchIntersector
{
public:
    explicit ExactCells(const ConvolutionField& field) : field_(field), lattice_(make_lattice(field)), filter_(cell_filter())
    {
        const Vec2i n = field.ground().stack().size();
        if (field.ground().border() == Border::extend) {
            // The rectangle of the grid; half a cell of the first and last lattice cells may lie outside and is cut off.
            domain_lo_ = Vec2d(-lattice_.shift), domain_hi_ = Vec2d(n.x - lattice_.shift, n.y - lattice_.shift);
        } else {
            // Half a kernel of matter is needed for a surface, so it never leaves the block by a whole cell.
            domain_lo_ = Vec2d(-lattice_.shift - 1.0), domain_hi_ = Vec2d(n.x - lattice_.shift + 1.0, n.y - lattice_.shift + 1.0);
        }
        first_ = Vec2i(static_cast<int>(std::floor(domain_lo_.x)), static_cast<int>(std::floor(domain_lo_.y)));
        last_ = Vec2i(static_cast<int>(std::ceil(domain_hi_.x)), static_cast<int>(std::ceil(domain_hi_.y)));
        tiles_x_ = (last_.x - first_.x + tile_cells - 1) / tile_cells;
        const int tiles_y = (last_.y - first_.y + tile_cells - 1) / tile_cells;
        tiles_.resize(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y));
        limits_.height = std::max(1.0, std::min(255.0, std::floor(4.0 * lattice_.cell / lattice_.unit)));
        std::vector<ClusterList> lists(tiles_.size());
        parallel_items(tiles_.size(), [&](std::size_t i) { lists[i] = build_tile(static_cast<int>(i)); });
        memory_ = ClusterMemory(lists, tiles_);
        inverse_cell_ = 1.0 / lattice_.cell, inverse_unit_ = 1.0 / lattice_.unit;
        // Of F: above what single precision loses inside a cluster.
        tolerance_ = static_cast<float>(2e-5 * lattice_.value_scale + 1e-4 * lattice_.factor * lattice_.kernel * lattice_.kernel);
    }

    std::uint32_t tile_count() const override { return static_cast<std::uint32_t>(tiles_.size()); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return tiles_[tile].size(); }

    Box3d patch_bounds(PatchId patch) const override
    {
        Vec3d lo, hi;
        cluster_box(tiles_[patch.tile], patch.index, lattice_, lo, hi);
        for (int k = 0; k < 2; ++k) {
            lo[k] = std::clamp(lo[k], domain_lo_[k], domain_hi_[k]);
            hi[k] = std::clamp(hi[k], domain_lo_[k], domain_hi_[k]);
        }
        // A millionth of a cell: far above the rounding of double precision, in which hits are found.
        const Vec3d slack(1e-6 * lattice_.cell);
        return {lattice_.world(lo) - slack, lattice_.world(hi) + slack};
    }

    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        double t = hit.t;
        if (!find(patch, ray, t, hit.evaluations, false)) return false;
        hit.t = t;
        hit.patch = patch;
        return true;
    }

    bool occluded(PatchId patch, const Ray& ray) const override
    {
        double t = ray.t_max;
        std::uint32_t evaluations = 0;
        return find(patch, ray, t, evaluations, true);
    }

    double value_error() const override { return lattice_.delta / lattice_.value_scale + (lattice_.whole ? 1e-9 : 2e-7); }

    std::uint64_t memory_bytes() const override
    {
        std::uint64_t bytes = memory_.bytes() + tiles_.size() * sizeof(CellTile);
        for (const ClusterMemory& own : own_) bytes += own.bytes();
        return bytes;
    }

    std::vector<std::uint32_t> rebuild(const ColumnSet& changed) override
    {
        const int tiles_y = static_cast<int>(tiles_.size()) / tiles_x_;
        std::vector<std::uint32_t> touched = touched_tiles(
            changed, Vec2i(tiles_x_, tiles_y), [&](int i) { return tiles_reading(i, first_.x, changed.size().x); },
            [&](int j) { return tiles_reading(j, first_.y, changed.size().y); });
        std::vector<ClusterList> lists(touched.size());
        tbb::parallel_for(std::size_t{0}, touched.size(), [&](std::size_t k) { lists[k] = build_tile(static_cast<int>(touched[k])); });
        own_.resize(tiles_.size());
        for (std::size_t k = 0; k < touched.size(); ++k) {
            CellTile& tile = tiles_[touched[k]];
            tile.compact = {}, tile.wide = {}, tile.cones = {};
            own_[touched[k]] = ClusterMemory({&lists[k], 1}, {&tile, 1});
        }
        return touched;
    }

private:
    static constexpr int tile_cells = MaterialStack::tile_size;

    /// First and last tile along one axis that has a vertex whose kernel reaches into column i. Edge columns go on outside the grid.
    Vec2i tiles_reading(int i, int first, int columns) const
    {
        const double reach = 0.5 * lattice_.kernel + lattice_.shift;
        // A vertex belongs to the cells on both its sides.
        const double low = i == 0 ? -kInfinity : std::floor(i - reach),
                     high = i + 1 == columns ? kInfinity : std::ceil(i + 1 + reach - 2.0 * lattice_.shift);
        const auto tile = [&](double cell) { return static_cast<int>(std::floor(std::clamp((cell - first) / tile_cells, -1.0, 1e6))); };
        return {tile(low), tile(high)};
    }

    ClusterList build_tile(int index)
    {
        const int a0 = first_.x + index % tiles_x_ * tile_cells, b0 = first_.y + index / tiles_x_ * tile_cells;
        tiles_[static_cast<std::size_t>(index)].a0 = a0, tiles_[static_cast<std::size_t>(index)].b0 = b0;
        const int a1 = std::min(a0 + tile_cells, last_.x), b1 = std::min(b0 + tile_cells, last_.y);
        ProfileRows rows(field_.ground(), lattice_, a0, a1);
        std::vector<Chain> chains;
        std::vector<Profile> near = rows.row(b0);
        for (int b = b0; b < b1; ++b) {
            std::vector<Profile> far = rows.row(b + 1);
            for (int a = a0; a < a1; ++a) {
                const auto i = static_cast<std::size_t>(a - a0);
                cell_chains(lattice_, a, b, {&near[i], &near[i + 1], &far[i], &far[i + 1]}, limits_, chains);
            }
            near = std::move(far);
        }
        return make_clusters(lattice_, a0, b0, chains);
    }

    /// Whether the cells of a cluster and their neighbours lie in the domain as a whole, so that nothing is cut off them.
    bool inside(const CellTile& tile, int x0, int y0) const
    {
        const double x = tile.a0 + x0, y = tile.b0 + y0;
        return x - 1.0 >= domain_lo_.x && x + 5.0 <= domain_hi_.x && y - 1.0 >= domain_lo_.y && y + 5.0 <= domain_hi_.y;
    }

    /// Nearest crossing before `t`, or just any if `any`.
    bool find(PatchId patch, const Ray& ray, double& t, std::uint32_t& evaluations, bool any) const
    {
        const CellTile& tile = tiles_[patch.tile];
        const std::uint32_t i = patch.index;
        const bool compact = i < tile.compact.size();
        const bool entering = ray.crossing == Crossing::entering;
        if (compact) {
            __builtin_prefetch(&tile.compact[i]);
            __builtin_prefetch(reinterpret_cast<const std::byte*>(&tile.compact[i]) + 64);
        }
        if (entering) {
            const float d[3] = {static_cast<float>(ray.direction.x), static_cast<float>(ray.direction.y), static_cast<float>(ray.direction.z)};
            if (tile.cones[i].rejects(d)) return false;
        }

        // The ray in the tile's lattice frame, and in single precision from its point nearest to the cluster.
        SlabRay exact;
        const Vec3d p = ray.origin - lattice_.origin;
        exact.origin = Vec3d(p.x * inverse_cell_ - lattice_.shift - tile.a0, p.y * inverse_cell_ - lattice_.shift - tile.b0,
                             (p.z + lattice_.sigma) * inverse_unit_);
        exact.direction = Vec3d(ray.direction.x * inverse_cell_, ray.direction.y * inverse_cell_, ray.direction.z * inverse_unit_);
        const double x0 = compact ? tile.compact[i].x0 : tile.wide[i - tile.compact.size()].x0;
        const double y0 = compact ? tile.compact[i].y0 : tile.wide[i - tile.compact.size()].y0;
        const double z0 = compact ? tile.compact[i].z_base : tile.wide[i - tile.compact.size()].z[0];
        const Vec3d local = exact.origin - Vec3d(x0, y0, z0);
        const double t_ref = -(ray.direction.x * local.x + ray.direction.y * local.y) * lattice_.cell - ray.direction.z * local.z * lattice_.unit;
        FilterRay f;
        for (int k = 0; k < 3; ++k) {
            f.origin[k] = static_cast<float>(local[k] + t_ref * exact.direction[k]);
            f.direction[k] = static_cast<float>(exact.direction[k]);
            // A direction along a plane must not make 0 times infinity; nothing inside a cluster is 1e12 away.
            f.inverse[k] = 1.0f / (std::abs(f.direction[k]) > 1e-12f ? f.direction[k] : std::copysign(1e-12f, f.direction[k]));
        }
        const double widen = 1e-4 * lattice_.cell;
        f.t_lo = static_cast<float>(std::max(ray.t_min - t_ref - widen, -1e30));
        f.t_hi = static_cast<float>(std::min(t - t_ref + widen, 1e30));
        f.tolerance = tolerance_;
        f.entering = entering;
        f.t_sure_lo = 1.0f, f.t_sure_hi = 0.0f;
        if (any && entering && inside(tile, static_cast<int>(x0), static_cast<int>(y0))) {
            f.t_sure_lo = static_cast<float>(std::max(ray.t_min - t_ref + widen, -1e30));
            f.t_sure_hi = static_cast<float>(std::min(t - t_ref - widen, 1e30));
        }

        alignas(64) float t_in[16];
        int met = 0;
        std::uint32_t lanes =
            compact ? filter_.compact(tile.compact[i], f, t_in, met) : filter_.wide(tile.wide[i - tile.compact.size()], z0, f, t_in, met);
        evaluations += 2u * static_cast<std::uint32_t>(met);
        if (lanes == 0) return false;
        if (lanes & kCertain) return true;

        exact.inverse = Vec3d(1.0 / exact.direction.x, 1.0 / exact.direction.y, 1.0 / exact.direction.z);
        exact.domain_lo = domain_lo_ - Vec2d(tile.a0, tile.b0), exact.domain_hi = domain_hi_ - Vec2d(tile.a0, tile.b0);
        exact.crossing = ray.crossing;
        bool found = false;
        while (lanes) {
            int next = __builtin_ctz(lanes);
            for (std::uint32_t rest = lanes & (lanes - 1); rest; rest &= rest - 1)
                if (t_in[__builtin_ctz(rest)] < t_in[next]) next = __builtin_ctz(rest);
            lanes &= ~(1u << next);
            if (found && t_ref + static_cast<double>(t_in[next]) - widen > t) break;
            ++evaluations;
            double candidate;
            if (first_crossing(tile.slab(i, next, lattice_.delta), exact, ray.t_min, t, any, candidate)) {
                if (any) return true;
                t = candidate;
                found = true;
            }
        }
        return found;
    }

    const ConvolutionField& field_;
    Lattice lattice_;
    CellFilter filter_;
    Vec2d domain_lo_, domain_hi_;  ///< lattice coordinates
    Vec2i first_, last_;           ///< lattice cells, half-open
    int tiles_x_ = 0;
    std::vector<CellTile> tiles_;
    ClusterMemory memory_;            ///< of all tiles as first built
    std::vector<ClusterMemory> own_;  ///< of tiles built anew, each its own; empty before the first
    ChainLimits limits_;
    double inverse_cell_ = 1.0, inverse_unit_ = 1.0;
    float tolerance_ = 0.0f;
};

}  // namespace

std::optional<std::string> why_not_exact(const ConvolutionField& field)
{
    const double cell = field.ground().stack().cell();
    if (has_lattice(field.sigma(), cell)) return std::nullopt;
    const double columns = 2.0 * field.sigma() / cell;
    return fmt::format("2 sigma is {:.6g} cells, which is not a whole number; the nearest sigma is {:.6g} m", columns,
                       std::max(1.0, std::round(columns)) * cell / 2.0);
}

std::unique_ptr<PatchIntersector> make_exact_cells(const ConvolutionField& field)
{
    return std::make_unique<ExactCells>(field);
}

}  // namespace hoodoo
