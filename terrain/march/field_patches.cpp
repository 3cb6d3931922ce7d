// Boxes that may hold the surface, by halving a domain as long as the field's proved range leaves zero in; in each box a certified march.
// Gamito2001, section 3.1, with the paper's own remark made good: "interval arithmetic or Lipschitz bounds could possibly be used to increase the
// robustness". Building: a box is dropped when the field's range over it has no zero; a box small enough, or so small that the field is nearly linear
// in it (K r < |g| / 16), becomes a patch, shrunk to what the mean value theorem leaves of it (where the gradient jumps: to the hull of what is left
// after three more halvings). Each patch keeps bounds of slope and curvature over itself; the march in it is that of first_crossing.h. Every box is
// widened a little, so that a crossing at the common side of two boxes lies well inside one of them. The domain is first cut into tiles, which are
// built in parallel; a patch's box is kept relative to its tile, rounded outwards.
#include "terrain/march/field_patches.h"

#include "terrain/error.h"
#include "terrain/march/area_march.h"
#include "terrain/march/first_crossing.h"
#include "terrain/march/first_crossing_batched.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace hoodoo
{

namespace
{

struct FieldPatch {
    Vec3f lo, hi;  ///< relative to the tile's corner
    float slope, curvature, mixed, upright;
};

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
            tiles_.push_back({lo, {{Vec3f(0.0f), round_up(hi - lo), 0.0f, 0.0f, 0.0f, 0.0f}}});
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
        // The whole of the box, whatever was found before: a crossing must not depend on the order in which boxes are met.
        double a = ray.t_min, b = ray.t_max;
        if (!clip(patch_bounds(id), ray, a, b) || a >= hit.t) return false;
        double t = 0.0;
        const FieldPatch& patch = tiles_[id.tile].patches[id.index];
        const bool found =
            settings_.mode == MarchMode::paper ? paper(ray, a, b, t, hit.evaluations) : certified(patch, ray, a, b, t, hit.evaluations);
        if (!found || !(t > ray.t_min && t < hit.t)) return false;
        hit.t = t;
        hit.patch = id;
        return true;
    }

    bool occluded(PatchId id, const Ray& ray) const override
    {
        Hit hit;
        hit.t = ray.t_max;
        return intersect(id, ray, hit);
    }

    std::uint64_t memory_bytes() const override
    {
        std::uint64_t bytes = tiles_.size() * sizeof(Tile);
        for (const Tile& tile : tiles_) bytes += tile.patches.capacity() * sizeof(FieldPatch);
        return bytes;
    }

private:
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
        const bool small = weighed[longest_side(weighed)] <= settings_.size + settings_.growth * std::hypot(from.x, from.y);
        double least = 0.0;
        for (const Interval& g : known.gradient) least += g.contains(0.0) ? 0.0 : std::min(g.lo * g.lo, g.hi * g.hi);
        const bool nearly_linear = std::max({known.curvature, known.mixed, known.upright}) * 0.5 * size.length() * 16.0 < std::sqrt(least);
        if (!small && !nearly_linear) {
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
        if (hull.isEmpty() || (field_.batched() && !settings_.moving && !tighten(hull, known))) return;
        // Wide enough that the coarse numbers of a patch do not let its bounds end before its box does.
        const Vec3d pad(1e-6 * hull.size().length() + 8.0 * rounding_ + 0x1p-22 * (hull.max - tile.corner).length());
        hull = Box3d(hull.min - pad, hull.max + pad);
        known = field_.local(Box3d(hull.min - pad, hull.max + pad));
        tile.patches.push_back({round_down(hull.min - tile.corner), round_up(hull.max - tile.corner), above(known.slope()), above(known.curvature),
                                above(known.mixed), above(known.upright)});
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

    /// Shrinks a box to the hull of those of its 64 parts that may hold a zero, again as long as that takes a fifth away. Over a part the field lies
    /// within sum |F_kk| h_k^2 / 8 of what its corners interpolate (trilinear interpolation, axis by axis), so within that of the corners' hull.
    /// False if nothing is left. What decides how many boxes a ray meets: ranges over whole boxes leave many that are empty.
    bool tighten(Box3d& box, const LocalField& known) const
    {
        constexpr int n = 4, m = n + 1;
        for (int round = 0; round < 3; ++round) {
            const Vec3d part = box.size() / n;
            const double error = settings_.flat + (known.curvature * (part.x * part.x + part.y * part.y) + known.upright * part.z * part.z) / 8.0;
            double value[m * m * m + 15];
            for (int first = 0; first < m * m * m; first += 16) {
                Vec3d p[16];
                for (int i = 0; i < 16; ++i) {
                    const int k = std::min(first + i, m * m * m - 1);
                    p[i] = box.min + Vec3d(part.x * (k % m), part.y * (k / m % m), part.z * (k / (m * m)));
                }
                field_.values(p, 0.0, value + first);
            }
            Box3d left;
            for (int k = 0; k < n * n * n; ++k) {
                const int x = k % n, y = k / n % n, z = k / (n * n);
                double low = kInfinity, high = -kInfinity;
                for (int c = 0; c < 8; ++c) {
                    const double v = value[((z + (c >> 2)) * m + y + (c >> 1 & 1)) * m + x + (c & 1)];
                    low = std::min(low, v), high = std::max(high, v);
                }
                if (low > error || high < -error) continue;
                left.extendBy(box.min + Vec3d(part.x * x, part.y * y, part.z * z));
                left.extendBy(box.min + Vec3d(part.x * (x + 1), part.y * (y + 1), part.z * (z + 1)));
            }
            if (left.isEmpty()) return false;
            const Vec3d before = box.size(), after = left.size();
            box = left;
            if (after.x * after.y * after.z > 0.8 * before.x * before.y * before.z) break;
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

    static bool clip(const Box3d& box, const Ray& ray, double& a, double& b)
    {
        for (int k = 0; k < 3; ++k) {
            const double d = ray.direction[k], o = ray.origin[k];
            if (d == 0.0) {
                if (o < box.min[k] || o > box.max[k]) return false;
                continue;
            }
            const double inverse = 1.0 / d, t0 = (box.min[k] - o) * inverse, t1 = (box.max[k] - o) * inverse;
            a = std::max(a, std::min(t0, t1));
            b = std::min(b, std::max(t0, t1));
        }
        return a < b && b < kInfinity;
    }

    bool certified(const FieldPatch& patch, const Ray& ray, double a, double b, double& t, std::uint32_t& evaluations) const
    {
        const auto f = [&](double s) { return field_.value(ray.at(s), ray.time); };
        const PieceBound bound{patch.slope, LocalField::curvature_along(patch.curvature, patch.mixed, patch.upright, ray.direction)};
        const auto closer = [&](double from, double to) {
            Box3d box(ray.at(from));
            box.extendBy(ray.at(to));
            const LocalField known = field_.local(Box3d(box.min - Vec3d(rounding_), box.max + Vec3d(rounding_)));
            return PieceBound{known.slope_along(ray.direction), known.curvature_along(ray.direction)};
        };
        const double accuracy = std::max(settings_.accuracy, 4.0 * (rounding_ + 0x1p-52 * (std::abs(a) + std::abs(b))));
        if (field_.batched()) return certified_batched(ray, bound, closer, a, b, accuracy, t, evaluations);
        double fa = f(a);
        const double fb = f(b);
        evaluations += 2;
        const bool entering = ray.crossing == Crossing::entering;
        while (first_crossing(f, closer, {a, fa, b, fb}, entering, bound, settings_.flat, accuracy, t, evaluations)) {
            if (field_.exists(ray.at(t), ray.time)) return true;
            a = t + accuracy;
            if (!(a < b)) return false;
            fa = f(a);
            ++evaluations;
        }
        return false;
    }

    template <class Closer>
    bool certified_batched(const Ray& ray, const PieceBound& bound, const Closer& closer, double a, double b, double accuracy, double& t,
                           std::uint32_t& evaluations) const
    {
        const auto f = [&](const double* s, double* out) {
            Vec3d p[16];
            for (int i = 0; i < 16; ++i) p[i] = ray.at(s[i]);
            field_.values(p, ray.time, out);
        };
        while (first_crossing_batched(f, closer, a, b, ray.crossing == Crossing::entering, bound, settings_.flat, accuracy, t, evaluations)) {
            if (field_.exists(ray.at(t), ray.time)) return true;
            a = t + accuracy;
            if (!(a < b)) return false;
        }
        return false;
    }

    bool paper(const Ray& ray, double a, double b, double& t, std::uint32_t& evaluations) const
    {
        const auto place = [&](double s) { return field_.inverse(ray.at(s), ray.time); };
        const auto base = [&](const Vec3d& q) { return field_.base_value(q); };
        const AreaSettings area{settings_.epsilon, settings_.epsilon_distance, 20};
        const bool entering = ray.crossing == Crossing::entering;
        while (area_march(place, base, a, b, entering, area, t, evaluations)) {
            if (field_.exists(ray.at(t), ray.time)) return true;
            a = std::nextafter(t, kInfinity);
            if (!(a < b)) return false;
        }
        return false;
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
