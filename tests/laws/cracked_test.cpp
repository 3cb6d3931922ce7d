// Cracked ground against an oracle that knows neither its diagram nor its search: no miss, no false hit; and surfaces that are wrong, which must
// fail.
#include "terrain/surfaces/cracked.h"
#include "tests/counts.h"
#include "tests/support/crack_oracle.h"
#include "tests/support/surface_laws.h"
#include "tests/support/wavy_ground.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

constexpr int kSites = 200;

struct Shape {
    double width = 0.1, psi = 0.4, epsilon = 0.2;
    Vec2d corner{0.0};
    double level = 0.45;
};

std::unique_ptr<CrackedSurface> cracked(const Shape& shape = {}, CrackedSurface::Looks looks = {})
{
    const auto ground = std::make_shared<WavyGround>(shape.level, shape.corner);
    const Box2d unit(Vec2d(0.0), Vec2d(1.0));
    CrackNetwork network(VoronoiDiagram(golden_sites(kSites), unit), shape.width / std::sqrt(kSites));
    CrackedField field(std::shared_ptr<const Height>(ground, ground->height()), std::move(network), {0.3, shape.psi, shape.epsilon},
                       Box2d(shape.corner, shape.corner + Vec2d(1.0)), 0.0, 1.0);
    return std::make_unique<CrackedSurface>(ground, std::move(field), CrackedPatchSettings{1.0 / 16.0, 1e-9}, looks);
}

CrackOracle oracle_for(const Shape& shape = {})
{
    return CrackOracle(golden_sites(kSites), {0.3, shape.psi, shape.epsilon, shape.width / std::sqrt(kSites), 1.25},
                       [level = shape.level](const Vec2d& p) { return WavyHeight(level).height(p); });
}

/// How many rays of `count` the oracle objects to.
int objections(const Surface& surface, const CrackOracle& oracle, int count, std::string& first)
{
    int bad = 0, hits = 0;
    for (const Ray& ray : law_rays(surface, 77, count)) {
        const Hit hit = nearest_hit(surface, ray);
        hits += std::isfinite(hit.t);
        const std::string fault = oracle.judge(ray, hit.t, 1e-7);
        if (!fault.empty() && bad++ == 0) first = fault;
    }
    EXPECT_GT(hits * 3, count) << "too few rays hit";
    return bad;
}

TEST(Cracked, no_ray_misses_and_none_hits_falsely)
{
    std::string fault;
    EXPECT_EQ(objections(*cracked(), oracle_for(), count(20000, 1000000), fault), 0) << fault;
}

TEST(Cracked, no_ray_misses_where_cracks_are_wide_and_end_abruptly)
{
    const Shape shape{0.6, 0.45, 0.01};
    std::string fault;
    EXPECT_EQ(objections(*cracked(shape), oracle_for(shape), count(6000, 300000), fault), 0) << fault;
}

TEST(Cracked, the_oracle_sees_what_is_wrong)
{
    std::string fault;
    Shape wider, higher;
    wider.width = 0.102;
    EXPECT_GT(objections(*cracked(wider), oracle_for(), 2000, fault), 0) << "cracks wider by a fiftieth";
    higher.psi = 0.41;
    EXPECT_GT(objections(*cracked(higher), oracle_for(), 2000, fault), 0) << "a border line higher by a hundredth";

    const auto right = cracked();
    struct NoExits final : Surface {
        const Surface& s;
        explicit NoExits(const Surface& surface) : s(surface) {}
        std::uint32_t patch_count(std::uint32_t tile) const override { return s.patch_count(tile); }
        Box3d patch_bounds(PatchId p) const override { return s.patch_bounds(p); }
        bool intersect(PatchId p, const Ray& ray, Hit& hit) const override
        {
            Ray entering = ray;
            entering.crossing = Crossing::entering;
            return s.intersect(p, entering, hit);
        }
        Interaction interact(const Ray& ray, const Hit& hit) const override { return s.interact(ray, hit); }
        bool contains(const Vec3d& p) const override { return s.contains(p); }
        std::vector<std::string> materials() const override { return s.materials(); }
        bool closed() const override { return false; }
        SurfaceInfo info() const override { return s.info(); }
    };
    EXPECT_GT(objections(NoExits(*right), oracle_for(), 2000, fault), 0) << "exits overlooked";
}

TEST(Cracked, golden_rays_hit_where_they_should)
{
    const auto surface = cracked();
    const auto golden = nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/c_cracks.json"));
    int walls = 0;
    for (const auto& r : golden["rays"]) {
        Ray ray;
        ray.origin = Vec3d(r["o"][0], r["o"][1], r["o"][2]);
        ray.direction = Vec3d(r["d"][0], r["d"][1], r["d"][2]).normalized();
        const Hit hit = nearest_hit(*surface, ray);
        ASSERT_EQ(std::isfinite(hit.t), !r["t"].is_null()) << r;
        if (r["t"].is_null()) continue;
        EXPECT_NEAR(hit.t, r["t"].get<double>(), 5e-7) << r;
        const bool wall = surface->interact(ray, hit).geometric_normal.z == 0.0;
        EXPECT_EQ(wall, r["kind"] == "crack wall") << r;
        walls += wall;
    }
    EXPECT_EQ(walls, 1);
}

TEST(Cracked, walls_are_horizontal_across_the_nearest_border)
{
    const auto surface = cracked({0.3});
    const CrackOracle oracle = oracle_for({0.3});
    int walls = 0;
    for (const Ray& ray : law_rays(*surface, 5, count(4000, 100000))) {
        const Hit hit = nearest_hit(*surface, ray);
        if (!std::isfinite(hit.t)) continue;
        const Interaction at = surface->interact(ray, hit);
        const Vec2d p(at.position.x, at.position.y);
        if (std::abs(oracle.distance(p) - 0.15 / std::sqrt(kSites)) > 1e-10) continue;  // no wall
        const double h = WavyHeight().height(p);
        if (at.position.z > h - 1e-6 || at.position.z < oracle.cracked_height(p) + 1e-6) continue;  // its edges belong to two parts
        ++walls;
        EXPECT_LE(std::abs(at.geometric_normal.z), 1e-12);
        EXPECT_NEAR(at.geometric_normal.length(), 1.0, 1e-12);
        const CrackOracle::Edge& edge = oracle.nearest(p);
        EXPECT_NEAR(Vec2d(at.geometric_normal.x, at.geometric_normal.y).dot((edge.b - edge.a).normalized()), 0.0, 1e-9);
        // Towards the middle of the crack: into its air.
        EXPECT_LT(oracle.distance(p + Vec2d(at.geometric_normal.x, at.geometric_normal.y) * 1e-4), oracle.distance(p));
    }
    EXPECT_GT(walls, 40);
}

TEST(Cracked, traced_heights_equal_equation_1)
{
    const auto surface = cracked();
    const CrackOracle oracle = oracle_for();
    int torn = 0;
    for (int j = 0; j < 50; ++j) {
        for (int i = 0; i < 50; ++i) {
            const Vec2d p((i + 0.5) / 50, (j + 0.5) / 50);
            Ray ray;
            ray.origin = Vec3d(p.x, p.y, 2.0);
            ray.direction = Vec3d(0, 0, -1);
            const Hit hit = nearest_hit(*surface, ray);
            ASSERT_TRUE(std::isfinite(hit.t));
            EXPECT_NEAR(2.0 - hit.t, oracle.cracked_height(p), 2e-9) << p;
            torn += oracle.cracked_height(p) < WavyHeight().height(p);
        }
    }
    EXPECT_GT(torn, 200);
}

TEST(Cracked, ground_at_or_below_height_zero_has_no_crack)
{
    // Between -0.35 and 0.15: most of it lies below 0.
    const auto surface = cracked({0.2, 0.4, 0.2, Vec2d(0.0), -0.1});
    int low = 0;
    for (int k = 0; k < 4000; ++k) {
        const Vec2d p((k % 63 + 0.5) / 63, (k / 63 + 0.5) / 64);
        const double h = WavyHeight(-0.1).height(p);
        if (h > 0.0) continue;
        ++low;
        Ray ray;
        ray.origin = Vec3d(p.x, p.y, 2.0);
        ray.direction = Vec3d(0, 0, -1);
        const Hit hit = nearest_hit(*surface, ray);
        ASSERT_TRUE(std::isfinite(hit.t));
        EXPECT_NEAR(2.0 - hit.t, h, 2e-9) << p;
        EXPECT_GT(surface->interact(ray, hit).geometric_normal.z, 0.6) << "a wall where there is no crack";
    }
    EXPECT_GT(low, 2000);
}

TEST(Cracked, materials_follow_the_cracks_and_the_border_line)
{
    CrackedSurface::Looks looks;
    looks.inside = "clay";
    looks.above = "grass";
    const auto surface = cracked({}, looks);
    ASSERT_EQ(surface->materials(), (std::vector<std::string>{"ground", "clay", "grass"}));
    int seen[3] = {};
    for (int k = 0; k < 2500; ++k) {
        const Vec2d p((k % 50 + 0.5) / 50, (k / 50 + 0.5) / 50);
        Ray ray;
        ray.origin = Vec3d(p.x, p.y, 2.0);
        ray.direction = Vec3d(0, 0, -1);
        const Interaction at = surface->interact(ray, nearest_hit(*surface, ray));
        double share[3] = {};
        for (std::size_t m = 0; m < at.materials.count; ++m) share[at.materials.index[m]] += at.materials.weight[m];
        const double h = WavyHeight().height(p), iota = h <= 0.4 ? 1.0 : std::max(0.0, 1.0 - (h - 0.4) / 0.2);
        const bool torn = surface->cracks().cracked(p) && iota > 0.0;
        EXPECT_NEAR(share[1], torn ? 1.0 : 0.0, 1e-6) << p;
        EXPECT_NEAR(share[2], torn ? 0.0 : 1.0 - iota, 1e-6) << p;
        for (int m = 0; m < 3; ++m) seen[m] += share[m] > 0.5;
    }
    for (const int n : seen) EXPECT_GT(n, 200);
}

}  // namespace
}  // namespace hoodoo
