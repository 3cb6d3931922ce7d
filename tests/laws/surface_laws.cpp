// The laws of surfaces over every row of the catalogue; and mutants, each of which breaks one thing and must be caught.

#include "terrain/catalogue.h"
#include "tests/counts.h"
#include "tests/support/catalogue_rows.h"
#include "tests/expect_law.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

TEST(Catalogue, every_row_has_an_instance_for_the_laws)
{
    for (const CatalogueEntry& entry : catalogue()) {
        const bool known = std::any_of(row_instances().begin(), row_instances().end(), [&](const RowInstance& i) { return i.row == entry.name; });
        EXPECT_TRUE(known) << "no instance of \"" << entry.name << "\" in tests/support/catalogue_rows.cpp";
    }
}

class SurfaceLaws : public ::testing::TestWithParam<std::size_t>
{
protected:
    void SetUp() override
    {
        try {
            built_ = build_row(instance());
        } catch (const Error& error) {
            FAIL() << error.what();
        }
        rays_ = law_rays(surface(), 21, count(400, 4000));
    }
    const RowInstance& instance() const { return row_instances()[GetParam()]; }
    const Surface& surface() const { return built_.surface(); }

    BuiltRow built_;
    std::vector<Ray> rays_;
};

TEST_P(SurfaceLaws, enough_rays_hit)
{
    EXPECT_GT(std::count_if(rays_.begin(), rays_.end(), [&](const Ray& r) { return std::isfinite(nearest_hit(surface(), r).t); }),
              static_cast<long>(rays_.size() / 5));
}
TEST_P(SurfaceLaws, bounds_contain_hits)
{
    EXPECT_LAW(bounds_contain_hits(surface(), rays_));
}
TEST_P(SurfaceLaws, nearest_is_nearest)
{
    EXPECT_LAW(nearest_is_nearest(surface(), rays_, instance().trusted));
}
TEST_P(SurfaceLaws, occluded_agrees)
{
    EXPECT_LAW(occluded_agrees(surface(), rays_));
}
TEST_P(SurfaceLaws, normals_are_gradients)
{
    EXPECT_LAW(normals_are_gradients(surface(), rays_));
}
TEST_P(SurfaceLaws, spawned_rays_leave)
{
    EXPECT_LAW(spawned_rays_leave(surface(), rays_));
}
TEST_P(SurfaceLaws, a_closed_surface_leaks_none)
{
    EXPECT_LAW(closed_leaks_none(surface(), 5, count(2000, 100000)));
}
TEST_P(SurfaceLaws, same_seed_same_bits)
{
    EXPECT_LAW(same_bits(surface(), build_row(instance()).surface(), rays_));
}

TEST_P(SurfaceLaws, translation_moves_hits)
{
    for (const Vec3d& shift : {Vec3d(64.0, -128.0, 16.0), Vec3d(1.5e5, 1234.0, -250.0), Vec3d(4e6, 3e6, 1000.0)})
        EXPECT_LAW(translation_moves_hits(surface(), build_row(instance(), shift).surface(), shift, rays_));
}

TEST_P(SurfaceLaws, laws_hold_far_from_the_origin)
{
    for (const Vec3d& shift : {Vec3d(1.5e5, 1234.0, -250.0), Vec3d(4e6, 3e6, 1000.0)}) {
        const BuiltRow far = build_row(instance(), shift);
        const std::vector<Ray> rays = law_rays(far.surface(), 22, count(150, 2000));
        EXPECT_LAW(bounds_contain_hits(far.surface(), rays));
        EXPECT_LAW(nearest_is_nearest(far.surface(), rays, instance().trusted));
        EXPECT_LAW(spawned_rays_leave(far.surface(), rays));
        EXPECT_LAW(closed_leaks_none(far.surface(), 6, count(500, 20000)));
    }
}

TEST_P(SurfaceLaws, field_bounds_hold)
{
    if (!surface().field()) GTEST_SKIP() << "no field";
    EXPECT_LAW(field_bounds_hold(*surface().field(), surface_bounds(surface()), 8, count(2000, 50000)));
}

INSTANTIATE_TEST_SUITE_P(Catalogue, SurfaceLaws, ::testing::Range(std::size_t{0}, row_instances().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& i) { return row_instances()[i.param].name; });

// -- Mutants: a law that one of these passes proves nothing -------------------------------------------------------------------------------

/// Passes everything on; each mutant changes one verb.
class Mutant : public Surface
{
public:
    explicit Mutant(const Surface& s) : s_(s) {}
    std::uint32_t tile_count() const override { return s_.tile_count(); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return s_.patch_count(tile); }
    Box3d patch_bounds(PatchId p) const override { return s_.patch_bounds(p); }
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override { return s_.intersect(p, ray, hit); }
    bool occluded(PatchId p, const Ray& ray) const override { return s_.occluded(p, ray); }
    Interaction interact(const Ray& ray, const Hit& hit) const override { return s_.interact(ray, hit); }
    bool contains(const Vec3d& p) const override { return s_.contains(p); }
    std::vector<std::string> materials() const override { return s_.materials(); }
    bool closed() const override { return s_.closed(); }
    SurfaceInfo info() const override { return s_.info(); }
    const Field* field() const override { return s_.field(); }

protected:
    const Surface& s_;
};

struct ShrunkBox final : Mutant {
    using Mutant::Mutant;
    Box3d patch_bounds(PatchId p) const override
    {
        const Box3d b = s_.patch_bounds(p);
        return {b.min + b.size() * 0.05, b.max - b.size() * 0.05};
    }
};

struct PushedHit final : Mutant {
    using Mutant::Mutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        Hit pushed = hit;
        if (!s_.intersect(p, ray, pushed) || !(pushed.t + 1e-3 < hit.t)) return false;
        hit = pushed;
        hit.t += 1e-3;
        return true;
    }
};

/// Overlooks one hit in twenty.
struct Overlooking final : Mutant {
    using Mutant::Mutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        Hit found = hit;
        if (!s_.intersect(p, ray, found) || static_cast<int>(found.t * 7919.0) % 20 == 0) return false;
        hit = found;
        return true;
    }
};

/// Finds the first hit of each kind of crossing: exits where entries were asked for.
struct WrongCrossing final : Mutant {
    using Mutant::Mutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        Ray entering = ray;
        entering.crossing = Crossing::entering;
        return s_.intersect(p, entering, hit);
    }
};

struct LyingOccluded final : Mutant {
    using Mutant::Mutant;
    bool occluded(PatchId p, const Ray& ray) const override
    {
        Ray shorter = ray;
        shorter.t_max = std::min(ray.t_max, 5.0);
        return s_.occluded(p, shorter);
    }
};

struct TiltedNormal final : Mutant {
    using Mutant::Mutant;
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = s_.interact(ray, hit);
        at.geometric_normal = (at.geometric_normal + Vec3d(0.03, 0.02, -0.01)).normalized();
        if (at.shading_normal.dot(at.geometric_normal) < 0.0) at.shading_normal = at.geometric_normal;
        return at;
    }
};

struct UnnormalisedShares final : Mutant {
    using Mutant::Mutant;
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = s_.interact(ray, hit);
        at.materials.weight[0] *= 1.01f;
        return at;
    }
};

/// Spawns below the surface.
struct SpawnsInside final : Mutant {
    using Mutant::Mutant;
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = s_.interact(ray, hit);
        at.position -= at.geometric_normal * (2.0 * at.spawn_offset);
        return at;
    }
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        // Asks for any crossing, as a tracer would that does not know the rule of entering.
        Ray any = ray;
        any.crossing = Crossing::any;
        return s_.intersect(p, any, hit);
    }
};

/// Sees nothing of one patch in three.
struct LeakyPatches final : Mutant {
    using Mutant::Mutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override { return (p.tile + p.index) % 3 != 0 && s_.intersect(p, ray, hit); }
};

/// One unit in the last place off in one hit of thirty.
struct OtherBits final : Mutant {
    using Mutant::Mutant;
    bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
    {
        Hit found = hit;
        if (!s_.intersect(p, ray, found)) return false;
        hit = found;
        if (static_cast<int>(hit.t * 7919.0) % 30 == 0) hit.t = std::nextafter(hit.t, 0.0);
        return true;
    }
};

class SteeperField final : public Field
{
public:
    SteeperField(const Field& f, double slope, double range) : f_(f), slope_(slope), range_(range) {}
    double value(const Vec3d& p) const override { return f_.value(p); }
    Vec3d gradient(const Vec3d& p) const override { return f_.gradient(p); }
    double slope_bound(const Segment& s) const override { return slope_ * f_.slope_bound(s); }
    Interval range(const Box3d& b) const override
    {
        const Interval i = f_.range(b);
        const double m = 0.5 * (i.lo + i.hi), r = 0.5 * range_ * (i.hi - i.lo);
        return {m - r, m + r};
    }
    Box3d bounds() const override { return f_.bounds(); }

private:
    const Field& f_;
    double slope_, range_;
};

TEST_P(SurfaceLaws, mutants_fail)
{
    const Surface& s = surface();
    EXPECT_FALSE(bounds_contain_hits(ShrunkBox(s), rays_).holds()) << "a shrunk box";
    EXPECT_FALSE(nearest_is_nearest(PushedHit(s), rays_).holds()) << "a hit pushed by a millimetre";
    EXPECT_FALSE(nearest_is_nearest(Overlooking(s), rays_).holds()) << "overlooked hits";
    EXPECT_FALSE(occluded_agrees(LyingOccluded(s), rays_).holds()) << "a lying occluded";
    EXPECT_FALSE(normals_are_gradients(TiltedNormal(s), rays_).holds()) << "a tilted normal";
    EXPECT_FALSE(normals_are_gradients(UnnormalisedShares(s), rays_).holds()) << "material shares of 1.01";
    EXPECT_FALSE(spawned_rays_leave(SpawnsInside(s), rays_).holds()) << "spawned inside";
    EXPECT_FALSE(same_bits(s, OtherBits(s), rays_).holds()) << "other bits";
    EXPECT_FALSE(translation_moves_hits(s, PushedHit(s), Vec3d(0.0), rays_).holds()) << "a hit pushed by a millimetre";
    EXPECT_TRUE(!s.closed() || !closed_leaks_none(LeakyPatches(s), 5, 2000).holds()) << "leaky patches";
    if (const Field* field = s.field()) {
        EXPECT_FALSE(nearest_is_nearest(WrongCrossing(s), rays_).holds()) << "exits overlooked";
        EXPECT_FALSE(field_bounds_hold(SteeperField(*field, 0.9, 1.0), surface_bounds(s), 8, 2000).holds()) << "a slope bound times 0.9";
        EXPECT_FALSE(field_bounds_hold(SteeperField(*field, 1.0, 0.9), surface_bounds(s), 8, 2000).holds()) << "a range shrunk by a tenth";
    }
}

}  // namespace
}  // namespace hoodoo
