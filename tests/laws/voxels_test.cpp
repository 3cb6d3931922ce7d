// Rays through voxels against an oracle in long double that knows neither blocks nor Bernstein polynomials: no miss, no false hit, no leak.
#include "terrain/surfaces/voxels.h"
#include "tests/counts.h"
#include "tests/support/numbers.h"
#include "tests/support/surface_laws.h"
#include "tests/support/voxel_oracle.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// Of ten rays: two tangent to the surface, one from a hit, one along an axis, one in a plane of samples, one through samples along a diagonal; the
/// others from anywhere to anywhere. Half of them ask for entering.
Ray hard_ray(const DenseVoxels& voxels, const Surface& surface, std::uint64_t seed, int n)
{
    Numbers random(seed, static_cast<std::uint64_t>(n));
    const Vec3d size(voxels.size[0] * voxels.cell, voxels.size[1] * voxels.cell, voxels.size[2] * voxels.cell);
    const Box3d box(voxels.first - Vec3d(voxels.cell), voxels.first + size);
    Ray ray;
    ray.crossing = random() < 0.5 ? Crossing::any : Crossing::entering;
    ray.direction = random.direction();
    ray.origin = random.in(box)-ray.direction * (random() < 0.5 ? 0.0 : size.length() * random());
    const auto on_plane = [&](int k) {
        ray.origin[k] = voxels.first[k] + voxels.cell * std::floor(random() * voxels.size[static_cast<std::size_t>(k)]);
    };
    const int kind = n % 10, axis = static_cast<int>(3.0 * random());
    if (kind == 3 || kind == 4) {
        ray.direction = Vec3d(0.0);
        ray.direction[axis] = random() < 0.5 ? 1.0 : -1.0;
        if (random() < 0.5) on_plane((axis + 1) % 3);
        if (random() < 0.3) on_plane((axis + 2) % 3);
    } else if (kind == 5) {
        on_plane(axis);
        ray.direction[axis] = 0.0;
        ray.direction.normalize();
    } else if (kind == 6) {
        for (int k = 0; k < 3; ++k) on_plane(k);
        ray.direction = Vec3d(random() < 0.5 ? 1 : -1, random() < 0.5 ? 1 : -1, random() < 0.5 ? 1 : 0).normalized();
        ray.origin -= ray.direction * (size.length() * std::floor(2.0 * random()));
    } else if (kind < 3) {
        Ray probe = ray;
        probe.crossing = Crossing::any;
        const Hit hit = nearest_hit(surface, probe);
        if (!std::isfinite(hit.t)) return ray;
        const Interaction at = surface.interact(probe, hit);
        ray.direction = random.direction();
        if (kind < 2) {
            Vec3d u, v;
            orthonormal_frame(at.geometric_normal, u, v);
            const double phi = random.between(0.0, 6.283185307179586);
            ray.direction = (u * std::cos(phi) + v * std::sin(phi) + at.geometric_normal * random.between(-0.0199, 0.0199)).normalized();
            ray.origin = at.position - ray.direction * (0.2 * size.length() * random());
        } else {
            ray.origin = at.position - ray.direction * (0.5 * voxels.cell * random());
        }
    }
    return ray;
}

/// Values within this of zero may be taken for either side: a thousand roundings of what is computed.
constexpr double kMargin = 1e-12;

struct Count {
    int misses = 0, false_hits = 0, hits = 0;
};

Count compare(const DenseVoxels& voxels, const Surface& surface, std::uint64_t seed, int rays)
{
    Count count;
    for (int n = 0; n < rays; ++n) {
        const Ray ray = hard_ray(voxels, surface, seed, n);
        const Hit hit = nearest_hit(surface, ray);
        if (std::isfinite(hit.t)) {
            ++count.hits;
            const Vec3d p = ray.at(hit.t);
            // Rounding of the point, at a slope of at most one unit a cell and axis.
            const double allowed = kMargin + 64 * 0x1p-52 * (ray.origin.length() + hit.t) / voxels.cell;
            if (std::abs(static_cast<double>(voxels.value(p.x, p.y, p.z))) > allowed) ++count.false_hits;
        }
        // A crossing that is certain before the reported one, or without a report.
        if (certain_crossing(voxels, ray, std::isfinite(hit.t) ? hit.t - 1e-12 : kInfinity, kMargin)) ++count.misses;
    }
    return count;
}

TEST(Voxels, no_crossing_is_missed_and_none_is_false_in_solids_of_every_kind)
{
    // Four kinds of solids, three of each: 2e4 rays in all in CI, 1e6 nightly.
    const int rays = count(1667, 83400);
    for (int kind = 0; kind < 4; ++kind) {
        for (const std::uint64_t seed : {1ull, 2ull, 3ull}) {
            const DenseVoxels voxels = hard_voxels(kind, seed, {11, 9, 12});
            const auto surface = make_voxel_surface(std::make_shared<VoxelGrid>(voxels.grid()));
            const Count found = compare(voxels, *surface, seed, rays);
            EXPECT_EQ(found.misses, 0) << "kind " << kind << ", seed " << seed;
            EXPECT_EQ(found.false_hits, 0) << "kind " << kind << ", seed " << seed;
            EXPECT_GT(found.hits, rays / 4);
        }
    }
}

TEST(Voxels, trimming_changes_no_hit)
{
    for (int kind = 0; kind < 4; ++kind) {
        // Larger than two blocks along each axis, with room that trimming can forget.
        DenseVoxels voxels = hard_voxels(kind, 4, {29, 26, 27});
        for (int i = 0; i < 29; ++i)
            for (int j = 0; j < 26; ++j)
                for (int k = 0; k < 27; ++k) {
                    float& f = voxels.values[static_cast<std::size_t>((i * 26 + j) * 27 + k)];
                    if (i < 12) f = 0.3f + 0.01f * static_cast<float>(j);
                    if (i > 17 && k < 13) f = -0.2f - 0.02f * static_cast<float>(k);
                }
        auto whole = std::make_shared<VoxelGrid>(voxels.grid()), trimmed = std::make_shared<VoxelGrid>(voxels.grid());
        trimmed->trim();
        EXPECT_LT(trimmed->values.stored_blocks(), whole->values.stored_blocks());
        const auto a = make_voxel_surface(whole), b = make_voxel_surface(trimmed);
        for (int n = 0; n < count(400, 20000); ++n) {
            const Ray ray = hard_ray(voxels, *a, 9, n);
            EXPECT_EQ(nearest_hit(*a, ray).t, nearest_hit(*b, ray).t) << "kind " << kind << ", ray " << n;
        }
    }
}

// -- Mutants --------------------------------------------------------------------------------------------------------

/// Passes everything on but what a mutant changes.
class VoxelMutant : public Surface
{
public:
    explicit VoxelMutant(const Surface& s) : s_(s) {}
    std::uint32_t patch_count(std::uint32_t tile) const override { return s_.patch_count(tile); }
    Box3d patch_bounds(PatchId p) const override { return s_.patch_bounds(p); }
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override { return s_.intersect(p, ray, hit); }
    Interaction interact(const Ray& ray, const Hit& hit) const override { return s_.interact(ray, hit); }
    bool contains(const Vec3d& p) const override { return s_.contains(p); }
    std::vector<std::string> materials() const override { return s_.materials(); }
    bool closed() const override { return true; }
    SurfaceInfo info() const override { return s_.info(); }

protected:
    const Surface& s_;
};

/// Sees nothing in one patch of five.
struct BlindPatch final : VoxelMutant {
    using VoxelMutant::VoxelMutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override { return p.index % 5 != 2 && s_.intersect(p, ray, hit); }
};

/// Overlooks what leaves again within a twentieth of a cell: what a march with steps of that length does.
struct Stepping final : VoxelMutant {
    using VoxelMutant::VoxelMutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        Ray rest = ray;
        for (;;) {
            Hit found = hit;
            if (!s_.intersect(p, rest, found)) return false;
            Hit out = hit;
            Ray leaving = ray;
            leaving.crossing = Crossing::any;
            leaving.t_min = found.t + 1e-9;
            if (!s_.intersect(p, leaving, out) || out.t - found.t > 0.02) {
                hit = found;
                return true;
            }
            rest.t_min = out.t + 1e-9;
        }
    }
};

/// A hit off by a ten-thousandth of a cell.
struct Pushed final : VoxelMutant {
    using VoxelMutant::VoxelMutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        if (!s_.intersect(p, ray, hit)) return false;
        hit.t += 1e-4 * 0.37;
        return true;
    }
};

TEST(Voxels, mutants_fail_against_the_oracle)
{
    const DenseVoxels voxels = hard_voxels(0, 1, {11, 9, 12});
    const auto surface = make_voxel_surface(std::make_shared<VoxelGrid>(voxels.grid()));
    EXPECT_GT(compare(voxels, BlindPatch(*surface), 1, 1667).misses, 0);
    EXPECT_GT(compare(voxels, Stepping(*surface), 1, 1667).misses, 0);
    EXPECT_GT(compare(voxels, Pushed(*surface), 1, 1667).false_hits, 0);
}

}  // namespace
}  // namespace hoodoo
