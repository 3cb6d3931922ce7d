// Flows and warps against golden values, differences, an error-controlled integrator, and their own bounds.
#include "terrain/fields/warp.h"
#include "terrain/math/noise_hessian.h"

#include "tests/counts.h"
#include "tests/support/dormand_prince.h"
#include "tests/support/flows.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

nlohmann::json golden()
{
    return nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/d_canyon.json"));
}

TEST(NoiseHessian, equals_the_golden_values_and_agrees_with_the_noise)
{
    const nlohmann::json values = golden();
    for (const auto& row : values["noise"]) {
        const NoiseJet2 n = noise_jet(Vec2d(row["p"][0].get<double>(), row["p"][1].get<double>()), 7);
        EXPECT_NEAR(n.value, row["n"].get<double>(), 1e-14);
        EXPECT_NEAR(n.gradient.x, row["grad"][0].get<double>(), 1e-13);
        EXPECT_NEAR(n.gradient.y, row["grad"][1].get<double>(), 1e-13);
        EXPECT_NEAR(n.xx, row["hess"][0].get<double>(), 1e-12);
        EXPECT_NEAR(n.xy, row["hess"][1].get<double>(), 1e-12);
        EXPECT_NEAR(n.yy, row["hess"][2].get<double>(), 1e-12);
    }
    Numbers random(3);
    for (int i = 0; i < 200; ++i) {
        const Vec3d p = random.in(Box3d(Vec3d(-9.0), Vec3d(9.0)));
        const NoiseJet3 a = noise_jet(p, 5);
        const Noise3 b = gradient_noise(p, 5);
        EXPECT_NEAR(a.value, b.value, 1e-14);
        EXPECT_NEAR((a.gradient - b.gradient).length(), 0.0, 1e-13);
        // Central differences of the gradient: h^2/6 of the fifth derivative's size, below 1e-6 here.
        const double h = 1e-5;
        const Vec3d dx = (gradient_noise(p + Vec3d(h, 0, 0), 5).gradient - gradient_noise(p - Vec3d(h, 0, 0), 5).gradient) / (2 * h);
        const Vec3d dz = (gradient_noise(p + Vec3d(0, 0, h), 5).gradient - gradient_noise(p - Vec3d(0, 0, h), 5).gradient) / (2 * h);
        EXPECT_NEAR((dx - Vec3d(a.xx, a.xy, a.xz)).length(), 0.0, 1e-6);
        EXPECT_NEAR((dz - Vec3d(a.xz, a.yz, a.zz)).length(), 0.0, 1e-6);
    }
}

TEST(NoiseHessian, no_sample_passes_the_bounds_and_the_bounds_are_not_idle)
{
    double second2 = 0.0, second3 = 0.0, third2 = 0.0;
    Numbers random(8);
    for (int i = 0; i < count(200000, 5000000); ++i) {
        const Vec3d p = random.in(Box3d(Vec3d(-1e3), Vec3d(1e3)));
        const Vec3d u = random.direction();
        const NoiseJet2 n = noise_jet(Vec2d(p.x, p.y), 11);
        const double mean = 0.5 * (n.xx + n.yy), off = std::hypot(0.5 * (n.xx - n.yy), n.xy);
        second2 = std::max(second2, std::abs(mean) + off);
        const NoiseJet3 m = noise_jet(p, 11);
        second3 = std::max(
            second3,
            std::abs(u.dot(Vec3d(m.xx * u.x + m.xy * u.y + m.xz * u.z, m.xy * u.x + m.yy * u.y + m.yz * u.z, m.xz * u.x + m.yz * u.y + m.zz * u.z))));
        // The change of the Hessian over a small step is at most the third derivative's bound, whichever side of a cell it is on.
        const double h = 1e-4;
        const NoiseJet2 k = noise_jet(Vec2d(p.x + h, p.y), 11);
        third2 = std::max(third2, std::abs(k.xx - n.xx) / h);
    }
    EXPECT_LE(second2, kNoise2Derivatives.hessian);
    EXPECT_GT(second2, 0.7 * kNoise2Derivatives.hessian);
    EXPECT_LE(second3, kNoise3Derivatives.hessian);
    EXPECT_GT(second3, 0.5 * kNoise3Derivatives.hessian);
    EXPECT_LE(third2, kNoise2Derivatives.third + 1e-3);
    EXPECT_GT(third2, 0.5 * kNoise2Derivatives.third);
}

TEST(Flow, gradients_are_the_velocity_s_derivatives)
{
    for (const NamedFlow& named : named_flows()) {
        Numbers random(4);
        for (int i = 0; i < 100; ++i) {
            const Vec3d p = random.in(flow_box());
            const double t = random() * named.longest, h = 1e-5;
            const Matrix3d d = named.flow->gradient(p, t);
            for (int k = 0; k < 3; ++k) {
                Vec3d e(0.0);
                e[k] = h;
                const Vec3d difference = (named.flow->velocity(p + e, t) - named.flow->velocity(p - e, t)) / (2 * h);
                EXPECT_NEAR((difference - Vec3d(d[0][k], d[1][k], d[2][k])).length(), 0.0, 2e-6) << named.name << " at " << p;
            }
        }
    }
}

/// Largest share of its bound that is seen of speed, gradient, hessian, over boxes and times. A bound that is wrong shows a share above 1.
FlowBound shares(const Flow& flow, double longest, double factor, int boxes)
{
    FlowBound most;
    Numbers random(6);
    for (int i = 0; i < boxes; ++i) {
        Box3d box(random.in(flow_box()));
        box.extendBy(box.min + Vec3d(random(), random(), random()) * std::pow(10.0, -3.0 * random()) * 2.0);
        const double t0 = random() * longest, t1 = t0 + random() * (longest - t0);
        FlowBound bound = flow.bound(box, {t0, t1});
        for (int k = 0; k < 8; ++k) {
            const Vec3d p = random.in(box), q = random.in(box);
            const double s = random.between(t0, t1), t = random.between(t0, t1), apart = (p - q).length() + bound.drift * std::abs(s - t);
            most.speed = std::max(most.speed, flow.velocity(p, s).length() / (factor * bound.speed + 1e-12));
            most.gradient = std::max(most.gradient, (flow.velocity(p, s) - flow.velocity(q, t)).length() / (factor * bound.gradient * apart + 1e-10));
            if (!std::isfinite(bound.hessian)) continue;
            const Vec3d u = random.direction();
            const Vec3d turn = apply(flow.gradient(p, s), u) - apply(flow.gradient(q, t), u);
            most.hessian = std::max(most.hessian, turn.length() / (factor * bound.hessian * apart + 1e-10));
        }
    }
    return most;
}

TEST(Flow, bounds_hold)
{
    for (const NamedFlow& named : named_flows()) {
        const FlowBound most = shares(*named.flow, named.longest, 1.0, count(1500, 50000));
        EXPECT_LE(most.speed, 1.0 + 1e-9) << named.name;
        EXPECT_LE(most.gradient, 1.0 + 1e-9) << named.name;
        EXPECT_LE(most.hessian, 1.0 + 1e-9) << named.name;
    }
}

TEST(Flow, bounds_times_nine_tenths_fail_where_they_are_attained)
{
    for (const NamedFlow& named : named_flows()) {
        if (named.name != "rotation" && named.name != "shear" && named.name != "vortex") continue;
        EXPECT_GT(shares(*named.flow, named.longest, 0.9, 20000).gradient, 1.0) << named.name;
    }
}

TEST(Warp, equals_the_golden_flows)
{
    const nlohmann::json values = golden();
    int rows = 0;
    for (const auto& row : values["flow"]) {
        const double duration = row["T"].get<double>();
        const Vec3d p(row["p"][0].get<double>(), row["p"][1].get<double>(), 0.4);
        // Negative durations are the flow backwards.
        const Warp warp(scaled_flow(noise_gradient_flow(Vec3d(0.0), 1.0, 7), duration < 0 ? -1.0 : 1.0), std::abs(duration));
        const Carried at = warp.inverse_with_jacobian(p, std::abs(duration));
        // RK4 with ceil(3.5 L T) steps, at most 0.29 of the shortest time scale each.
        EXPECT_NEAR(at.point.x, row["x0"][0].get<double>(), 5e-4);
        EXPECT_NEAR(at.point.y, row["x0"][1].get<double>(), 5e-4);
        EXPECT_EQ(at.point.z, 0.4);
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < 2; ++k) EXPECT_NEAR(at.jacobian[i][k], row["J"][i][k].get<double>(), 5e-3);
        // The reference integrator is held to the golden values much closer: it then judges the others.
        const Vec3d exact = follow(*noise_gradient_flow(Vec3d(0.0), 1.0, 7), p, duration, 0.0);
        EXPECT_NEAR(exact.x, row["x0"][0].get<double>(), 1e-9);
        EXPECT_NEAR(exact.y, row["x0"][1].get<double>(), 1e-9);
        ++rows;
    }
    EXPECT_EQ(rows, 14);
}

TEST(Warp, follows_the_flow)
{
    for (const NamedFlow& named : named_flows()) {
        const Warp warp(named.flow, named.longest);
        Numbers random(12);
        double most = 0.0;
        for (int i = 0; i < count(60, 2000); ++i) {
            const Vec3d p = random.in(flow_box());
            const double duration = random() * named.longest;
            most = std::max(most, (warp.inverse(p, duration) - follow(*named.flow, p, duration, 0.0)).length());
        }
        // Closed forms are exact; the rest is RK4 (D2 of the maths: 1e-4 of the flow's scale at these durations).
        EXPECT_LT(most, named.flow->closed_form() ? 1e-11 : 2e-4) << named.name;
    }
}

TEST(Warp, there_and_back_is_where_it_began)
{
    for (const NamedFlow& named : named_flows()) {
        const Warp warp(named.flow, named.longest);
        Numbers random(13);
        for (int i = 0; i < count(300, 20000); ++i) {
            const Vec3d p = random.in(flow_box());
            const double duration = random() * named.longest;
            EXPECT_LT((warp.inverse(warp.forward(p, duration), duration) - p).length(), 1e-9) << named.name;
            EXPECT_LT((warp.forward(warp.inverse(p, duration), duration) - p).length(), 1e-9) << named.name;
        }
    }
}

TEST(Warp, a_flow_that_depends_on_time_cannot_be_undone_by_running_it_on)
{
    // Eq. (3) as printed follows the flow from 0 to -T. In coordinates that move with the pattern, q = p - c t, the drifting flow is v0(q) - c.
    const Vec3d drift(2.0, -1.0, 0.5);
    const FlowPtr still = curl_flow(Vec3d(0.3, 0.1, 0.2), 6.0, 2, 0.2, 5), drifting = drifting_flow(still, drift);
    const Warp warp(drifting, 0.3);
    class Moving final : public Flow
    {
    public:
        Moving(FlowPtr flow, const Vec3d& c) : flow_(std::move(flow)), c_(c) {}
        Vec3d velocity(const Vec3d& p, double) const override { return flow_->velocity(p, 0.0) - c_; }
        Matrix3d gradient(const Vec3d& p, double) const override { return flow_->gradient(p, 0.0); }
        FlowBound bound(const Box3d& b, const Interval& t) const override { return flow_->bound(b, t); }

    private:
        FlowPtr flow_;
        Vec3d c_;
    };
    const Moving moving(still, drift);
    Numbers random(14);
    double printed = 0.0;
    for (int i = 0; i < 50; ++i) {
        const Vec3d p = random.in(flow_box());
        const Vec3d truth = follow(moving, p - drift * 0.3, 0.3, 0.0);  // at t = 0 both frames agree
        EXPECT_LT((warp.inverse(p, 0.3) - truth).length(), 2e-4);
        printed = std::max(printed, (follow(*drifting, p, 0.0, -0.3) - truth).length());
    }
    EXPECT_GT(printed, 0.01);
}

/// Whether what inverse_bound says of a box holds at points and durations in it; empty, or what failed. Bounds are multiplied by `factor`.
std::string bound_fault(const Warp& warp, double factor, std::uint64_t seed, int boxes)
{
    Numbers random(seed);
    for (int i = 0; i < boxes; ++i) {
        Box3d box(random.in(flow_box()));
        box.extendBy(box.min + Vec3d(random(), random(), random()) * std::pow(10.0, -4.0 * random()));
        const double t0 = random() * warp.longest(), t1 = t0 + (i % 3 ? random() * std::pow(10.0, -3.0 * random()) * (warp.longest() - t0) : 0.0);
        InverseBound b = warp.inverse_bound(box, {t0, t1});
        b.all = b.all * factor;
        b.half_image *= factor;
        for (int k = 0; k < 8; ++k) {
            const Vec3d p = k == 0 ? box.min : k == 1 ? box.max : random.in(box), q = random.in(box);
            const double s = k % 2 ? t0 : t1, t = random.between(t0, t1), apart = (p - q).length(), later = std::abs(s - t);
            const Carried a = warp.inverse_with_jacobian(p, s), c = warp.inverse_with_jacobian(q, t);
            const Vec3d off = a.point - b.image;
            for (int axis = 0; axis < 3; ++axis)
                if (std::abs(off[axis]) > b.half_image[axis] + 1e-11) return "image";
            if ((a.point - c.point).length() > b.all.x * apart + b.all.h * later + 1e-11) return "first derivatives";
            const Vec3d u = random.direction();
            if ((apply(a.jacobian, u) - apply(c.jacobian, u)).length() > b.all.xx * apart + b.all.xh * later + 1e-9) return "second derivatives";
            const double h = 1e-5;
            if (s + h <= t1 && t + h <= t1) {
                const Vec3d ra = (warp.inverse(p, s + h) - a.point) / h, rc = (warp.inverse(q, t + h) - c.point) / h;
                if ((ra - rc).length() > b.all.xh * apart + b.all.hh * (later + h) + 1e-5) return "derivatives by the duration";
            }
        }
    }
    return {};
}

TEST(Warp, bounds_of_the_inverse_hold)
{
    for (const NamedFlow& named : named_flows())
        EXPECT_EQ(bound_fault(Warp(named.flow, named.longest), 1.0, 15, count(1000, 30000)), "") << named.name;
}

TEST(Warp, bounds_of_the_inverse_times_nine_tenths_fail)
{
    for (const NamedFlow& named : named_flows()) EXPECT_NE(bound_fault(Warp(named.flow, named.longest), 0.9, 15, 3000), "") << named.name;
}

TEST(Warp, says_why_it_cannot_be)
{
    EXPECT_EQ(Warp::why_not(*noise_gradient_flow(Vec3d(0.0), 1.0, 7), 2.0),
              "the flow's derivative is up to 9.236, and 9.236 times the duration 2 is 18.47: at most 8 can be traced");
    const Box3d half(Vec3d(-kInfinity, -kInfinity, 0.0), Vec3d(kInfinity));
    EXPECT_EQ(Warp::why_not(*masked_flow(rotation_flow(Vec3d(0.0), Vec3d(0, 0, 1)), half, 1.0), 1.0),
              "no bound of the flow's derivative can be found: it grows without limit");
    EXPECT_EQ(Warp::why_not(*rotation_flow(Vec3d(0.0), Vec3d(0, 0, 1)), 1.0), "");
}

}  // namespace
}  // namespace hoodoo
