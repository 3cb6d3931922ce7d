// Boxes that may hold the surface, by halving a domain as long as the field's proved range leaves zero in; in each box a certified march.
// Gamito2001, section 3.1, with the paper's own remark made good: "interval arithmetic or Lipschitz bounds could possibly be used to increase the
// robustness". Building: a box is dropped when the field's range over it has no zero; a box small enough, or so small that the field is nearly linear
// in it (K r < |g| / 16), becomes a patch, shrunk to what the mean value theorem leaves of it (where the gradient jumps: to the hull of what is left
// after three more halvings). Each patch keeps bounds of gradient and curvature over itself and a quadratic with a proved error (patch_model.h); what
// a ray does with them field_search.cpp says. Every box is widened a little, so that a crossing at the common side of two boxes lies well inside one
// of them. The domain is first cut into tiles, which are built in parallel; a patch's box is kept relative to its tile, rounded outwards.
#include "terrain/march/field_patches.h"

#include "terrain/error.h"
#include "terrain/march/field_search.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace hoodoo
{

namespace
{

struct Tile {
    Vec3d corner{0.0};
    std::vector<FieldPatch> patches;
};

float above(double x)
{
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}
float below(double x)
{
    return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

int longest_side(const Vec3d& size)
{
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

std::pair<Box3d, Box3d> halves(const Box3d& box, int k)
{
    Box3d low = box, high = box;
    low.max[k] = high.min[k] = 0.5 * (box.min[k] + box.max[k]);
    return {low, high};
}

class FieldPatches final : public FieldIntersector
{
public:
    FieldPatches(const MarchedField& field, const PatchSettings& settings) : field_(field), settings_(settings)
    {
        const Vec3d &lo = settings.domain.min, &hi = settings.domain.max;
        const double far = std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), std::abs(hi.x), std::abs(hi.y), std::abs(hi.z)});
        rounding_ = 0x1p-48 * far;
        if (settings.mode == MarchMode::paper) {
            FieldPatch whole;
            whole.lo = Vec3f(0.0f), whole.hi = round_up(hi - lo);
            tiles_.push_back({lo, {whole}});
            return;
        }
        lay_tiles();
        std::atomic<std::size_t> count{0};
        tbb::parallel_for(std::size_t{0}, tiles_.size(), [&](std::size_t i) {
            if (count < settings_.most_patches) divide(tile_boxes_[i], tiles_[i]);
            count += tiles_[i].patches.size();
        });
        if (count > settings_.most_patches)
            throw Error(ErrorKind::memory,
                        fmt::format("the surface needs more than {} patches of {:.4g} m: ask for larger patches or a smaller region",
                                    settings_.most_patches, settings_.size));
    }

    std::uint32_t tile_count() const override { return static_cast<std::uint32_t>(tiles_.size()); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return static_cast<std::uint32_t>(tiles_[tile].patches.size()); }

    Box3d patch_bounds(PatchId id) const override
    {
        const Tile& tile = tiles_[id.tile];
        const FieldPatch& p = tile.patches[id.index];
        const Vec3d pad(rounding_);
        return {tile.corner + Vec3d(p.lo) - pad, tile.corner + Vec3d(p.hi) + pad};
    }

    bool intersect(PatchId id, const Ray& ray, Hit& hit) const override
    {
        double t = 0.0;
        if (!search().first(patch(id), patch_bounds(id), ray, hit.t, false, t, hit.evaluations)) return false;
        hit.t = t;
        hit.patch = id;
        return true;
    }

    bool occluded(PatchId id, const Ray& ray) const override
    {
        double t = 0.0;
        std::uint32_t evaluations = 0;
        return search().first(patch(id), patch_bounds(id), ray, ray.t_max, true, t, evaluations);
    }

    std::uint64_t memory_bytes() const override
    {
        std::uint64_t bytes = tiles_.size() * sizeof(Tile);
        for (const Tile& tile : tiles_) bytes += tile.patches.capacity() * sizeof(FieldPatch);
        return bytes;
    }

private:
    /// A box is halved, so often at most, while the quadratic's error is more than this share of what the field may change by in the box.
    static constexpr int kMostRefinements = 2;
    static constexpr double kBent = 0.02;

    const FieldPatch& patch(PatchId id) const { return tiles_[id.tile].patches[id.index]; }
    FieldSearch search() const { return {field_, settings_, rounding_}; }

    static Vec3f round_up(const Vec3d& v) { return {above(v.x), above(v.y), above(v.z)}; }
    static Vec3f round_down(const Vec3d& v) { return {below(v.x), below(v.y), below(v.z)}; }

    /// About 32 patches along the side of a tile, and no side of the domain in more than 64 of them.
    void lay_tiles()
    {
        const Vec3d lo = settings_.domain.min, size = settings_.domain.size();
        const double side = std::max(32.0 * settings_.size, std::max({size.x, size.y, size.z}) / 64.0);
        int n[3];
        for (int k = 0; k < 3; ++k) n[k] = std::max(1, static_cast<int>(std::ceil(size[k] / side)));
        for (int z = 0; z < n[2]; ++z) {
            for (int y = 0; y < n[1]; ++y) {
                for (int x = 0; x < n[0]; ++x) {
                    const auto corner = [&](int i, int j, int k) { return lo + Vec3d(size.x * i / n[0], size.y * j / n[1], size.z * k / n[2]); };
                    tile_boxes_.emplace_back(corner(x, y, z), corner(x + 1, y + 1, z + 1));
                    tiles_.push_back({corner(x, y, z), {}});
                }
            }
        }
    }

    bool may_hold(const Box3d& box, LocalField& known) const
    {
        known = field_.local(box);
        return known.value.lo <= settings_.flat && known.value.hi >= -settings_.flat;
    }

    /// A box's sides, the upright one counted by how much more the field may change along it than across: where it climbs in steps, boxes are flat.
    static Vec3d weigh(const Vec3d& size, const LocalField& known)
    {
        const double across = std::max(known.gradient[0].magnitude(), known.gradient[1].magnitude()), up = known.gradient[2].magnitude();
        const double ratio = across > 0.0 && std::isfinite(up) ? up / across : 1.0;
        return {size.x, size.y, size.z * std::clamp(ratio, 1.0, 64.0)};
    }

    void divide(const Box3d& box, Tile& tile) const
    {
        LocalField known;
        if (tile.patches.size() > settings_.most_patches || !may_hold(box, known)) return;
        const Vec3d size = box.size();
        const Vec3d from = box.center() - settings_.focus;
        const Vec3d weighed = weigh(size, known);
        const double wanted = settings_.size + settings_.growth * std::hypot(from.x, from.y);
        const bool small = weighed[longest_side(weighed)] <= wanted;
        double least = 0.0;
        for (const Interval& g : known.gradient) least += g.contains(0.0) ? 0.0 : std::min(g.lo * g.lo, g.hi * g.hi);
        const bool nearly_linear = std::max({known.curvature, known.mixed, known.upright}) * 0.5 * size.length() * 16.0 < std::sqrt(least);
        if (!small && !(nearly_linear && (!settings_.cut_edges || field_.exists_throughout(box)))) {
            const auto [low, high] = halves(box, longest_side(weighed));
            divide(low, tile);
            divide(high, tile);
            return;
        }
        Box3d hull;
        if (std::isfinite(known.curvature)) {
            hull = clip_by_gradient(box, known);
        } else {
            shrink(box, 3, hull);
        }
        // Far away, where boxes are large on purpose, no such care is taken.
        if (!hull.isEmpty())
            refine(hull, known, field_.batched() && !settings_.moving && wanted <= 2.0 * settings_.size ? kMostRefinements : -1, tile);
    }

    /// A small box, of which `known` is known: shrunk once more, and halved up to `levels` times where the field is still too bent to be a quadratic;
    /// -1: taken as it is.
    void refine(Box3d box, const LocalField& known, int levels, Tile& tile) const
    {
        if (field_.batched() && !settings_.moving && !tighten(box, known)) return;
        const FieldPatch patch = patch_of(box, tile.corner, levels >= 0);
        const bool bent = patch.model.error > kBent * patch.slope() * box.size().length();
        if (levels <= 0 || !bent) {
            tile.patches.push_back(patch);
            return;
        }
        const auto [low, high] = halves(box, longest_side(weigh(box.size(), known)));
        for (const Box3d& half : {low, high}) {
            LocalField own;
            if (may_hold(half, own)) refine(half, own, levels - 1, tile);
        }
    }

    /// A box becomes a patch, with what is known over just the box that patch_bounds() will tell; `carefully`: from its eight parts.
    FieldPatch patch_of(const Box3d& hull, const Vec3d& corner, bool carefully) const
    {
        // Wide enough that the coarse numbers of a patch do not let its bounds end before its box does.
        const Vec3d pad(1e-6 * hull.size().length() + 8.0 * rounding_ + 0x1p-22 * (hull.max - corner).length());
        FieldPatch patch;
        patch.lo = round_down(hull.min - pad - corner), patch.hi = round_up(hull.max + pad - corner);
        const Vec3d wide(rounding_);
        const Box3d box(corner + Vec3d(patch.lo) - wide, corner + Vec3d(patch.hi) + wide);
        const LocalField known = known_by_parts(box, carefully ? 3 : 0);
        patch.least = round_down({known.gradient[0].lo, known.gradient[1].lo, known.gradient[2].lo});
        patch.most = round_up({known.gradient[0].hi, known.gradient[1].hi, known.gradient[2].hi});
        patch.curvature = above(known.curvature), patch.mixed = above(known.mixed), patch.upright = above(known.upright);
        patch.everywhere = field_.exists_throughout(box);
        // A graze as shallow as `flat` need not be met; and points are rounded, by more the farther from the origin.
        if (!settings_.moving)
            patch.model = fit_model(NodeGrid(field_, box, field_.batched() ? 4 : 2), known, settings_.flat + known.slope() * rounding_);
        return patch;
    }

    /// What is known of a box from its halves, and theirs: bounds grow faster than boxes.
    LocalField known_by_parts(const Box3d& box, int levels) const
    {
        if (levels == 0) return field_.local(box);
        const auto [low, high] = halves(box, levels % 3);
        LocalField a = known_by_parts(low, levels - 1);
        const LocalField b = known_by_parts(high, levels - 1);
        a.value = Interval::hull(a.value, b.value);
        for (std::size_t k = 0; k < 3; ++k) a.gradient[k] = Interval::hull(a.gradient[k], b.gradient[k]);
        a.curvature = std::max(a.curvature, b.curvature), a.mixed = std::max(a.mixed, b.mixed), a.upright = std::max(a.upright, b.upright);
        a.sway = kInfinity;
        return a;
    }

    /// What is left of a box where the mean value theorem allows a zero: F(c) + sum_k G_k dx_k = 0, with each G_k in its range. Over the times
    /// the value at the centre strays by what is known of it; where nothing is, a moving surface keeps its box.
    Box3d clip_by_gradient(const Box3d& box, const LocalField& known) const
    {
        const Vec3d half = box.size() * 0.5, centre = box.center();
        double all = 0.0;
        for (int k = 0; k < 3; ++k)
            all += std::max(std::abs(known.gradient[static_cast<std::size_t>(k)].lo), std::abs(known.gradient[static_cast<std::size_t>(k)].hi)) *
                   half[k];
        // What the range of values says beyond the gradients is what the surface moves by.
        const double moving = settings_.moving ? known.sway + settings_.flat : settings_.flat;
        Box3d out = box;
        for (int k = 0; k < 3; ++k) {
            const Interval& g = known.gradient[static_cast<std::size_t>(k)];
            if (!(g.lo > 0.0 || g.hi < 0.0)) continue;
            const double rest = all - std::max(std::abs(g.lo), std::abs(g.hi)) * half[k] + moving;
            double lo = kInfinity, hi = -kInfinity;
            for (const double slope : {g.lo, g.hi}) {
                for (const double side : {-rest, rest}) {
                    lo = std::min(lo, (side - known.centre) / slope);
                    hi = std::max(hi, (side - known.centre) / slope);
                }
            }
            out.min[k] = std::max(out.min[k], centre[k] + lo);
            out.max[k] = std::min(out.max[k], centre[k] + hi);
            if (out.min[k] > out.max[k]) return {};
        }
        return out;
    }

    /// Shrinks a box to the hull of those of its 64 parts that may hold a zero, again as long as that takes a fifth away. False if nothing is left.
    /// What decides how many boxes a ray meets: ranges over whole boxes leave many that are empty.
    bool tighten(Box3d& box, const LocalField& known) const
    {
        for (int round = 0; round < 3; ++round) {
            const Box3d left = parts_with_zero(NodeGrid(field_, box, 4), round == 0 ? known : field_.local(box), settings_.flat);
            if (left.isEmpty()) return false;
            const Vec3d was = box.size(), now = left.size();
            box = left;
            if (now.x * now.y * now.z > 0.8 * was.x * was.y * was.z) break;
        }
        return true;
    }

    void shrink(const Box3d& box, int levels, Box3d& hull) const
    {
        LocalField known;
        if (!may_hold(box, known)) return;
        if (levels == 0) {
            hull.extendBy(box);
            return;
        }
        const auto [low, high] = halves(box, longest_side(box.size()));
        shrink(low, levels - 1, hull);
        shrink(high, levels - 1, hull);
    }

    const MarchedField& field_;
    PatchSettings settings_;
    double rounding_ = 0.0;
    std::vector<Box3d> tile_boxes_;
    std::vector<Tile> tiles_;
};

}  // namespace

std::unique_ptr<FieldIntersector> make_field_patches(const MarchedField& field, const PatchSettings& settings)
{
    return std::make_unique<FieldPatches>(field, settings);
}

}  // namespace hoodoo
