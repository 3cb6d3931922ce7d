// The wave's two inverse maps against independent forward integrations and differences; their bounds against samples, with mutants.
#include "terrain/fields/wave_profile.h"
#include "terrain/math/hash.h"
#include "tests/counts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using Json = nlohmann::json;

const Json& golden()
{
    static const Json data = [] {
        std::ifstream file(HOODOO_SOURCE_DIR "/tests/golden/d_wave.json");
        return Json::parse(file);
    }();
    return data;
}

WaveProfile profile(const std::string& name)
{
    const Json& p = golden()["params"][name];
    return WaveProfile({p["R1"], p["R2"], p["alpha"], p["d"]});
}

/// F of the flat sea and its gradient by (x, z, T): the union of both images.
struct Flat {
    double value;
    Vec3d gradient;
};

Flat flat(const WaveProfile& wave, const Vec2d& p, double duration)
{
    const auto of = [&](const WaveOrigin& o) { return Flat{o.at.y + wave.shape().depth, Vec3d(o.by_x.y, o.by_z.y, o.by_duration.y)}; };
    const Flat turned = of(wave.circular(p, duration));
    if (p.x >= 0.0) return turned;
    const Flat fallen = of(wave.parabolic(p, duration));
    return turned.value <= fallen.value ? turned : fallen;
}

TEST(WaveProfile, particles_come_from_where_they_started)
{
    int seen = 0;
    for (const Json& f : golden()["forward"]) {
        const WaveProfile wave = profile(f["p"]);
        const Vec2d p(f["x"], f["z"]);
        const WaveOrigin from = f["branch"] == "circular" ? wave.circular(p, f["T"]) : wave.parabolic(p, f["T"]);
        EXPECT_NEAR(from.at.x, f["x0"].get<double>(), 1e-6) << f;
        EXPECT_NEAR(from.at.y, f["z0"].get<double>(), 1e-6) << f;
        ++seen;
    }
    EXPECT_EQ(seen, 24);
}

TEST(WaveProfile, field_and_gradient_are_the_golden_ones)
{
    int seen = 0;
    for (const Json& f : golden()["F"]) {
        const Flat at = flat(profile(f["p"]), {f["x"], f["z"]}, f["T"]);
        EXPECT_NEAR(at.value, f["F"].get<double>(), 1e-9) << f;
        EXPECT_NEAR(at.gradient.x, f["grad"][0].get<double>(), 1e-8) << f;
        EXPECT_NEAR(at.gradient.y, f["grad"][1].get<double>(), 1e-8) << f;
        EXPECT_NEAR(at.gradient.z, f["dFdT"].get<double>(), 1e-8) << f;
        ++seen;
    }
    EXPECT_EQ(seen, 22);
}

/// Number k in [0, 1) of sample i.
double u(std::uint64_t i, int k)
{
    return static_cast<double>(hash_combine(i, static_cast<std::uint64_t>(k)) >> 11) * 0x1p-53;
}

struct Sample {
    Interval x, z, duration;
    bool parabolic;
};

Sample sample_box(std::uint64_t i)
{
    const double size = std::pow(10.0, -2.5 + 2.5 * u(i, 0));
    Sample s;
    s.parabolic = u(i, 1) < 0.5;
    const double x = s.parabolic || u(i, 2) < 0.4 ? -6.0 * u(i, 3) : 6.0 * u(i, 3), z = -3.0 + 6.0 * u(i, 4), t = 5.0 * u(i, 5);
    s.x = x < 0.0 ? Interval{x - size, x} : Interval{x, x + size};
    if (u(i, 6) < 0.15) s.x = x < 0.0 ? Interval{-size, 0.0} : Interval{0.0, size};
    s.z = {z, z + size * (0.2 + u(i, 7))};
    s.duration = u(i, 8) < 0.5 ? Interval{t, t} : Interval{t, t + size};
    return s;
}

/// How often samples in random boxes lie outside the bounds, each scaled by `scale` about what it bounds.
int violations(double scale, int boxes)
{
    int wrong = 0;
    const auto outside = [&](double x, const Interval& i) {
        const double middle = 0.5 * (i.lo + i.hi), half = 0.5 * (i.hi - i.lo) * scale;
        return x < middle - half - 1e-9 || x > middle + half + 1e-9;
    };
    for (int b = 0; b < boxes; ++b) {
        const auto id = static_cast<std::uint64_t>(b);
        const Sample s = sample_box(id);
        const WaveProfile wave = profile(b % 2 ? "A" : "B");
        const WaveBound bound = s.parabolic ? wave.parabolic_bound(s.x, s.z, s.duration) : wave.circular_bound(s.x, s.z, s.duration);
        WaveOrigin last;
        Vec2d last_p(0.0);
        for (int k = 0; k < 24; ++k) {
            const auto at = [&](const Interval& i, int n) {
                return k < 8 ? ((k >> n) & 1 ? i.hi : i.lo) : i.lo + (i.hi - i.lo) * u(id * 24 + k, 20 + n);
            };
            Vec2d p(at(s.x, 0), at(s.z, 1));
            if (s.x.hi <= 0.0) p.x = std::min(p.x, -1e-12);  // the left side's own points
            const double t = k % 2 && k >= 8 ? s.duration.lo : at(s.duration, 2);
            const WaveOrigin o = s.parabolic ? wave.parabolic(p, t) : wave.circular(p, t);
            wrong += outside(o.at.x, bound.x0) + outside(o.at.y, bound.z0);
            for (int i = 0; i < 2; ++i)
                wrong += outside(o.by_x[i], bound.by_x[i]) + outside(o.by_z[i], bound.by_z[i]) + outside(o.by_duration[i], bound.by_duration[i]);
            // The gradient of z0 at one T is Lipschitz with the constant `second`.
            if (k >= 11 && k % 2 && std::isfinite(bound.second)) {
                const double change = (Vec2d(o.by_x.y, o.by_z.y) - Vec2d(last.by_x.y, last.by_z.y)).length();
                wrong += change > bound.second * scale * (p - last_p).length() + 1e-9;
            }
            if (k % 2) last = o, last_p = p;
        }
    }
    return wrong;
}

TEST(WaveProfile, bounds_hold_over_boxes)
{
    EXPECT_EQ(violations(1.0, testing::count(40000, 1000000)), 0);
}

TEST(WaveProfile, bounds_that_are_too_small_are_seen)
{
    EXPECT_GT(violations(0.9, 40000), 100);
}

TEST(WaveProfile, bounds_are_tight_on_small_boxes)
{
    // A millimetre's box knows the field to a few millimetres where the wave shears least and most.
    const WaveProfile wave = profile("B");
    for (const Vec2d& p : {Vec2d(1.5, 0.5), Vec2d(-1.0, 1.2), Vec2d(-2.0, -1.0)}) {
        const Interval x{p.x, p.x + 1e-3}, z{p.y, p.y + 1e-3}, t{3.0, 3.0};
        const WaveBound bound = p.x < 0.0 ? wave.parabolic_bound(x, z, t) : wave.circular_bound(x, z, t);
        EXPECT_LT(bound.z0.hi - bound.z0.lo, 0.02);
    }
}

}  // namespace
}  // namespace hoodoo
