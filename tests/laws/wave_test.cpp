// The breaking wave as what it should be: water where the flow carries water, smooth where one flow takes over from the other, met by every ray from
// outside and from inside at every stage of its life, and without a jump in time. Each law has a mutant.
#include "terrain/fields/foam.h"
#include "terrain/fields/ripples.h"
#include "tests/counts.h"
#include "tests/expect_law.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/numbers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <functional>
#include <numbers>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;
using Json = nlohmann::json;

constexpr WaveShape kHero{6.0, 0.75, 2.0, 0.8};

// -- Water is where the flow carries it ------------------------------------------------------------------------------

/// Equations 9 and 10 forwards: round the centre until straight above it, then along the parabola.
Vec2d carried(const WaveProfile& wave, const Vec2d& from, double duration)
{
    // Angles from -3 pi / 2 to pi / 2: what is past the top already goes round once more.
    const double r = from.length(), v = wave.speed(r), turn = std::atan2(from.y, from.x),
                 start = from.x < 0.0 && turn > 0.0 ? turn - 2.0 * std::numbers::pi : turn;
    const double top = v > 0.0 ? r * (0.5 * std::numbers::pi - start) / v : kInfinity;
    if (duration <= top) {
        const double at = start + v / r * duration;
        return {r * std::cos(at), r * std::sin(at)};
    }
    const double fall = duration - top;
    return {-v * fall, r - v * v * fall * fall / (2.0 * r)};
}

using Section = std::function<double(const Vec2d&, double)>;  ///< F of the flat sea at (x, z) and T

double turned(const WaveProfile& wave, const Vec2d& p, double T)
{
    return wave.circular(p, T).at.y + wave.shape().depth;
}
double flown(const WaveProfile& wave, const Vec2d& p, double T)
{
    return wave.parabolic(p, T).at.y + wave.shape().depth;
}
double united(const WaveProfile& wave, const Vec2d& p, double T)
{
    return p.x >= 0.0 ? turned(wave, p, T) : std::min(turned(wave, p, T), flown(wave, p, T));
}
/// As printed: whatever has flown, and only what has not is looked for on the circle.
double parabola_first(const WaveProfile& wave, const Vec2d& p, double T)
{
    if (p.x >= 0.0) return turned(wave, p, T);
    const WaveOrigin o = wave.parabolic(p, T);
    return o.falling > 0.0 ? o.at.y + wave.shape().depth : turned(wave, p, T);
}

/// Every particle of water lies in F < 0, and every place well inside F < 0 has particles about it.
Verdict water_is_where_the_flow_carries_it(const Section& f, double T)
{
    const WaveProfile wave(kHero);
    constexpr double bin = 0.06, lo_x = -5.0, lo_z = -2.2, step = 0.014;
    constexpr int nx = 160, nz = 96;
    std::vector<std::uint8_t> seen(static_cast<std::size_t>(nx) * nz, 0);
    for (double x0 = -7.0; x0 < 7.0; x0 += step) {
        for (double z0 = -kHero.depth - 1e-4; z0 > -6.5; z0 -= step) {
            const Vec2d p = carried(wave, {x0, z0}, T);
            if (f(p, T) > 1e-9) return {fmt::format("T = {}: water at ({:.4f}, {:.4f}) lies in air, F = {:.4f}", T, p.x, p.y, f(p, T))};
            const int i = static_cast<int>(std::floor((p.x - lo_x) / bin)), j = static_cast<int>(std::floor((p.y - lo_z) / bin));
            if (i >= 0 && i < nx && j >= 0 && j < nz) seen[static_cast<std::size_t>(j) * nx + static_cast<std::size_t>(i)] = 1;
        }
    }
    for (int j = 1; j < nz - 1; ++j) {
        for (int i = 1; i < nx - 1; ++i) {
            const Vec2d p(lo_x + (i + 0.5) * bin, lo_z + (j + 0.5) * bin);
            if (f(p, T) > -0.05) continue;
            bool near = false;
            for (int dj = -1; dj <= 1; ++dj)
                for (int di = -1; di <= 1; ++di) near = near || seen[static_cast<std::size_t>(j + dj) * nx + static_cast<std::size_t>(i + di)];
            if (!near) return {fmt::format("T = {}: ({:.3f}, {:.3f}) is water, F = {:.3f}, but no water was carried there", T, p.x, p.y, f(p, T))};
        }
    }
    return {};
}

TEST(Wave, the_forward_flow_of_this_test_is_that_of_the_golden_integrations)
{
    std::ifstream file(HOODOO_SOURCE_DIR "/tests/golden/d_wave.json");
    const Json golden = Json::parse(file);
    for (const Json& f : golden["forward"]) {
        const Json& p = golden["params"][f["p"].get<std::string>()];
        const Vec2d at = carried(WaveProfile({p["R1"], p["R2"], p["alpha"], p["d"]}), {f["x0"], f["z0"]}, f["T"]);
        EXPECT_NEAR(at.x, f["x"].get<double>(), 1e-7) << f;
        EXPECT_NEAR(at.y, f["z"].get<double>(), 1e-7) << f;
    }
}

TEST(Wave, water_is_where_the_flow_carries_it)
{
    const WaveProfile wave(kHero);
    for (const double T : {0.5, 1.0, 2.0, 2.8, 3.6, 4.3, 5.0})
        EXPECT_LAW(water_is_where_the_flow_carries_it([&](const Vec2d& p, double d) { return united(wave, p, d); }, T));
}

TEST(Wave, without_the_union_rule_the_trough_is_torn_and_without_the_parabola_the_lip_curls_on)
{
    const WaveProfile wave(kHero);
    EXPECT_FALSE(water_is_where_the_flow_carries_it([&](const Vec2d& p, double d) { return parabola_first(wave, p, d); }, 4.3).holds());
    EXPECT_FALSE(water_is_where_the_flow_carries_it([&](const Vec2d& p, double d) { return turned(wave, p, d); }, 4.3).holds());
    EXPECT_FALSE(water_is_where_the_flow_carries_it([&](const Vec2d& p, double d) { return united(wave, p, 0.98 * d); }, 4.3).holds());
}

// -- Smooth above the centre -----------------------------------------------------------------------------------------

/// The slope across x = 0 is one number, above the centre.
Verdict smooth_across_the_seam(const Section& f)
{
    constexpr double h = 1e-6;
    int seen = 0;
    for (std::uint64_t n = 0; n < 4000; ++n) {
        Numbers random(41, n);
        const double T = random.between(0.2, 5.0), z = random.between(0.05, 4.0);
        // The core's rim is a crease of the flow itself.
        if (std::abs(z - kHero.core) < 1e-3) continue;
        const double middle = f({0.0, z}, T), left = (middle - f({-h, z}, T)) / h, right = (f({h, z}, T) - middle) / h;
        // So are the clamps, in air.
        if (middle > 2.0 * kHero.depth) continue;
        ++seen;
        if (!(std::abs(left - right) < 2e-4)) return {fmt::format("T = {}, z = {}: slopes {} and {}", T, z, left, right)};
    }
    return seen > 1000 ? Verdict{} : Verdict{fmt::format("only {} places", seen)};
}

TEST(Wave, the_parabola_leaves_the_circle_smoothly)
{
    const WaveProfile wave(kHero);
    EXPECT_LAW(smooth_across_the_seam([&](const Vec2d& p, double T) { return united(wave, p, T); }));
    // A flight one part in fifty too fast joins with a crease.
    EXPECT_FALSE(smooth_across_the_seam([&](const Vec2d& p, double T) { return united(wave, p.x < 0.0 ? Vec2d(0.98 * p.x, p.y) : p, T); }).holds());
}

// -- Rays ------------------------------------------------------------------------------------------------------------

BuiltRow wave_at(double time)
{
    // At the middle of the crest T = 5 S(t / 5): 0, 1, 2.2, 2.8, 3.6, 4.3, 4.7, 5, and then the collapse.
    return build_row({"breaking_wave", "wave_law", [=](const Vec3d&) {
                          return fmt::format(
                              "extent = 9.0\npatch = 0.5\ngrowth = 0.0\ntime = {}\n"
                              "[[wave]]\ncentre = [{}, 0]\nspeed = 3.0\nsteepening = 5.0\npeel = 3.0\npeel_width = 2.0\nintensity = 5.0\n"
                              "[[swell]]\nwavelength = 7.0\nheight = 0.15\nheading_deg = 200\nphase_deg = 40\n",
                              time, 3.0 * time);
                      }});
}

const std::vector<double>& life_times()
{
    static const std::vector<double> times{0.0, 1.44, 2.35, 2.72, 3.25, 3.76, 4.12, 5.0, 5.7, 8.0};
    return times;
}

/// Half of them from inside the water.
std::vector<Ray> rays_about(const Surface& surface, std::uint64_t seed, int count)
{
    std::vector<Ray> rays = law_rays(surface, seed, count), chosen;
    const Box3d box = surface_bounds(surface);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        if (n % 2) {
            Numbers random(seed + 1, n);
            Vec3d p = rays[n].origin;
            for (int k = 0; k < 50 && !(surface.field()->value(p) < -1e-3); ++k) p = random.in(box);
            rays[n].origin = p;
            rays[n].crossing = Crossing::any;
        }
        chosen.push_back(rays[n]);
    }
    return chosen;
}

TEST(Wave, no_ray_misses_it_from_outside_or_inside_at_any_stage_of_its_life)
{
    int inside = 0, hits = 0;
    for (std::size_t k = 0; k < life_times().size(); ++k) {
        const BuiltRow built = wave_at(life_times()[k]);
        const std::vector<Ray> rays = rays_about(built.surface(), 50 + k, count(2000, 10000));
        const Verdict verdict = nearest_is_nearest(built.surface(), rays, 0.9);
        EXPECT_TRUE(verdict.holds()) << "at " << life_times()[k] << " s: " << verdict.fault;
        for (const Ray& ray : rays) {
            inside += built.surface().field()->value(ray.origin) < 0.0;
            hits += std::isfinite(nearest_hit(built.surface(), ray).t);
        }
    }
    EXPECT_GT(inside, count(6000, 30000));
    EXPECT_GT(hits, count(8000, 40000));
}

TEST(Wave, rays_from_inside_the_water_find_the_way_out)
{
    const BuiltRow built = wave_at(3.76);
    int seen = 0;
    for (const Ray& ray : rays_about(built.surface(), 77, 2000)) {
        if (!(built.surface().field()->value(ray.origin) < -1e-3) || !(std::max(std::abs(ray.origin.x), std::abs(ray.origin.y)) < 9.0)) continue;
        Ray up = ray;
        up.direction = Vec3d(0.0, 0.0, 1.0);
        up.t_max = kInfinity;
        up.crossing = Crossing::any;
        const Hit hit = nearest_hit(built.surface(), up);
        ASSERT_TRUE(std::isfinite(hit.t)) << ray.origin;
        EXPECT_GT(built.surface().interact(up, hit).geometric_normal.z, -1e-6) << "a way out looks along the normal";
        ++seen;
    }
    EXPECT_GT(seen, 500);
}

// -- Time ------------------------------------------------------------------------------------------------------------

BreakingSea lively_sea()
{
    Breaker b;
    b.shape = kHero;
    b.centre = {20.0, 0.0};
    b.intensity = 5.0;
    b.steepening = 4.0;
    Breaker c = b;
    c.centre = {40.0, 6.0};
    c.start = 2.0;
    return {{b, c}, Swells({{0.1, {-0.5, 0.1}, 2.2, 0.3}, {0.04, {-1.1, -0.6}, 3.5, 1.0}}, {60.0, 80.0, {0.0, 0.0}}), 0.0};
}

/// A jump stays as high however short the step; what is continuous shrinks with it.
Verdict does_not_pop(const std::function<double(const Vec3d&, double)>& f, int points)
{
    const auto largest = [&](double step) {
        double most = 0.0;
        for (int i = 0; i < points; ++i) {
            Numbers random(61, static_cast<std::uint64_t>(i));
            const double t = random.between(0.0, 14.0);
            const Vec3d p = random.in(Box3d(Vec3d(-14.0 - 2.0 * t, -10.0, -2.0), Vec3d(30.0, 10.0, 3.0)));
            most = std::max(most, std::abs(f(p, t + step) - f(p, t)));
        }
        return most;
    };
    const double coarse = largest(1e-2), fine = largest(1e-5);
    if (!(coarse > 1e-3)) return {fmt::format("nothing happens: {}", coarse)};
    if (!(fine < 0.01 * coarse)) return {fmt::format("changes by {} in 1e-2 s and by {} in 1e-5 s", coarse, fine)};
    return {};
}

TEST(Wave, nothing_about_it_pops)
{
    const BreakingSea sea = lively_sea();
    const FoamShape shape{1.0, 1.5, 1.0, 0.6, 0.8, 3};
    const SeaFoam foam(sea, shape, Vec3d(0.0), 0.0, 20.0);
    const int points = count(60000, 600000);
    EXPECT_LAW(does_not_pop([&](const Vec3d& p, double t) { return sea.value(p, t); }, points));
    EXPECT_LAW(does_not_pop([&](const Vec3d& p, double t) { return foam.value(p, t / 20.0); }, points));
    EXPECT_LAW(does_not_pop([&](const Vec3d& p, double t) { return ripple_slope({0.1, 1.2, {1.0, 0.0}, 5}, p, t, 0.02).gradient.x; }, points));
    // A sea that is told only every tenth of a second.
    EXPECT_FALSE(does_not_pop([&](const Vec3d& p, double t) { return sea.value(p, std::floor(10.0 * t) / 10.0); }, points).holds());
}

TEST(Wave, what_is_painted_on_the_water_does_not_pop_either)
{
    // On the surface itself: straight below or above points of the sea, followed through time.
    const BreakingSea sea = lively_sea();
    const SeaFoam foam(sea, {1.0, 1.5, 1.0, 0.6, 0.8, 3}, Vec3d(0.0), 0.0, 20.0);
    const auto lowest = [&](const Vec3d& p, double t) {
        // The lowest crossing above the deep: always there, and it moves without a jump as long as no sheet lands on it.
        double lo = -5.0, hi = lo;
        while (sea.value({p.x, p.y, hi}, t) < 0.0) lo = hi, hi += 0.05;
        for (int k = 0; k < 50; ++k) {
            const double m = 0.5 * (lo + hi);
            (sea.value({p.x, p.y, m}, t) < 0.0 ? lo : hi) = m;
        }
        return Vec3d(p.x, p.y, lo);
    };
    int jumps = 0, seen = 0;
    for (int i = 0; i < count(4000, 40000); ++i) {
        Numbers random(62, static_cast<std::uint64_t>(i));
        const double t = random.between(0.0, 14.0), step = 1e-6;
        const Vec3d p = random.in(Box3d(Vec3d(-10.0, -8.0, 0.0), Vec3d(20.0, 8.0, 0.0)));
        const Vec3d a = lowest(p, t), b = lowest(p, t + step);
        if ((a - b).length() > 1e-3) continue;
        const SeaRest before = sea.rest(a, t), after = sea.rest(b, t + step);
        ++seen;
        jumps += (before.point - after.point).length() > 1e-3;
        jumps += std::abs(foam.cover(a, before.point, t, 0.01) - foam.cover(b, after.point, t + step, 0.01)) > 1e-2;
    }
    EXPECT_EQ(jumps, 0);
    EXPECT_GT(seen, count(3900, 39000));
}

// -- Foam and ripples ------------------------------------------------------------------------------------------------

/// Places where the density exceeds `scale` times its bound over a box, or lies outside the bounds.
int above_the_majorant(double scale, int boxes)
{
    const BreakingSea sea = lively_sea();
    const Vec3d origin(100.0, -50.0, 7.0);
    const SeaFoam foam(sea, {1.0, 1.5, 0.9, 0.7, 0.8, 3}, origin, 3.0, 9.0);
    const Box3d bounds = foam.bounds();
    int wrong = 0;
    for (int n = 0; n < boxes; ++n) {
        Numbers random(71, static_cast<std::uint64_t>(n));
        const double size = std::pow(10.0, random.between(-3.0, 0.7)), t0 = random();
        const Interval times{t0, random() < 0.6 ? t0 : std::min(1.0, t0 + 0.02 * random())};
        // Every other one in the white water of the first wave, where the density is as high as its bound allows.
        Vec3d lo = random.in(bounds);
        if (n % 2) {
            const double t = std::max(5.6, 3.0 + 6.0 * t0), front = 20.0 - 4.0 * t;
            lo = origin + Vec3d(front + random.between(-0.5, 0.8), random.between(-2.0, 2.0), random.between(0.2, 0.9));
        }
        const Box3d box(lo, lo + Vec3d(size, size * random(), size * random()));
        const double most = foam.majorant(box, times);
        for (int k = 0; k < 12; ++k) wrong += foam.value(random.in(box), random.between(times.lo, times.hi)) > most * scale;
        const Vec3d p = random.in(Box3d(bounds.min - Vec3d(5.0), bounds.max + Vec3d(5.0)));
        wrong += foam.value(p, random()) > 0.0 && !bounds.intersects(p);
    }
    return wrong;
}

TEST(Foam, no_place_is_denser_than_its_majorant_or_lies_outside_the_bounds)
{
    EXPECT_EQ(above_the_majorant(1.0, count(30000, 1000000)), 0);
}

TEST(Foam, a_majorant_times_nine_tenths_is_seen)
{
    EXPECT_GT(above_the_majorant(0.9, 30000), 10);
}

TEST(Foam, is_thickest_at_the_lip_and_in_the_white_water_and_absent_behind_an_unbroken_wave)
{
    const BreakingSea sea = lively_sea();
    const SeaFoam foam(sea, {1.0, 1.5, 1.0, 0.6, 0.8, 3}, Vec3d(0.0), 0.0, 20.0);
    // The first wave's centre is at x = 20 - 4 t and T = 5 S(t / 4); it collapses from 4 s on, and at 5.5 s all is white.
    const auto most = [&](double t, double x0, double x1, double z0, double z1) {
        double found = 0.0;
        for (int i = 0; i < 20000; ++i) {
            Numbers random(81, static_cast<std::uint64_t>(i));
            const double x = 20.0 - 4.0 * t + random.between(x0, x1);
            found = std::max(found, foam.value({x, random.between(-1.0, 1.0), random.between(z0, z1)}, t / 20.0));
        }
        return found;
    };
    EXPECT_EQ(most(1.2, -6.0, 6.0, -2.0, 4.0), 0.0);  // T = 1.1: a swell
    EXPECT_GT(most(3.0, -3.0, 0.0, 0.5, 3.5), 0.2);   // T = 4.2: the lip
    EXPECT_EQ(most(3.0, 1.0, 6.0, -2.0, 4.0), 0.0);   // behind it
    EXPECT_GT(most(6.0, -2.0, 1.0, 0.0, 2.0), 0.2);   // white water
}

TEST(Ripples, what_the_footprint_hides_is_what_it_does_not_show)
{
    // The mean square slope in one direction is shape.slope^2 / 2 however it is divided; 2e5 places leave an error of about 1%.
    const RippleShape shape{0.12, 1.2, {1.0, 0.0}, 5};
    for (const double footprint : {0.0, 0.02, 0.09, 0.4, 3.0}) {
        double sum = 0.0, lost = 0.0;
        const int n = 200000;
        for (int i = 0; i < n; ++i) {
            Numbers random(91, static_cast<std::uint64_t>(i));
            const Vec3d p = random.in(Box3d(Vec3d(-300.0), Vec3d(300.0)));
            const RippleSlope r = ripple_slope(shape, p, 3.0, footprint);
            sum += 0.5 * (r.gradient.x * r.gradient.x + r.gradient.y * r.gradient.y);
            lost = r.lost_variance;
        }
        EXPECT_NEAR(sum / n + lost, 0.5 * shape.slope * shape.slope, 0.03 * 0.5 * shape.slope * shape.slope) << footprint;
        EXPECT_EQ(lost == 0.0, footprint == 0.0);
        EXPECT_EQ(sum == 0.0, footprint == 3.0);
    }
}

}  // namespace
}  // namespace hoodoo
