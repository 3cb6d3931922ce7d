// The inverse warp: back along the flow by a fixed number of Runge-Kutta steps, or in closed form, with proved bounds of its derivatives.
// Gamito2001, eq. (1) to (3). Corrections: (3), Warp^-1 = Warp(-T), holds for steady flows only; here the path is followed from t = T down to 0. The
// number of steps is N = ceil(3.5 L T) whatever the duration, L about the largest |Dv|: an adaptive integrator changes its steps from point to point,
// and each change is a crack in the surface. The surface traced is that of the discrete map; its normals and bounds are the discrete map's own.
// Accuracy against the true flow: |dx| < 3e-5 at L T = 1.1, below 1e-3 at L T = 5 (measured for the canyon's flow, tests).
// Forward: Newton's iteration on inverse(), started by RK4 forwards, so that warping there and back is exact.
// Bounds over a box of radius r (Euclid): the path of the centre is followed with its Jacobian. At step n the bundle has a radius R_n <= (|J_n| + B_n
// r/2) r, so |Dv| <= |Dv(centre's stage)| + M R at each stage, M over a box about the stages; norm_jet.h turns these into bounds of the step's first
// and second derivatives, and the steps are chained: B_(n+1) = |DR| B_n + |D2R| |J_n|^2. A closed form is followed in as many steps as bounds need;
// over one, |D2R| <= M/L (e^2Lh - e^Lh).
#include "terrain/fields/warp.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

namespace
{

const Box3d kEverywhere(Vec3d(-kInfinity), Vec3d(kInfinity));

/// Stands for a second derivative without bound.
constexpr double kBeyond = 1e30;

/// (e^{a t} - 1) / a.
double grown(double a, double t)
{
    return a * t < 1e-9 ? t * (1.0 + a * t) : std::expm1(a * t) / a;
}

/// One step of the exact flow: |x'| <= e^{Lh}, |x''| <= M e^{Lh} (e^{Lh} - 1)/L, and the same chains for h (x_h = v, x_xh = Dv x_x, x_hh = Dv v).
NormJet exact_jet(double step, double speed, double gradient, double hessian)
{
    const double e = std::exp(gradient * step);
    return {e, speed, hessian * e * grown(gradient, step), gradient * e, gradient * speed};
}

}  // namespace

double norm_bound(const Matrix3d& m)
{
    const Matrix3d s = m.transposed() * m, q = s * s;
    double most = 0.0;
    for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(q[i][0]) + std::abs(q[i][1]) + std::abs(q[i][2]));
    return std::sqrt(std::sqrt(most)) * (1.0 + 1e-14);
}

std::string Warp::why_not(const Flow& flow, double longest)
{
    const double lipschitz = flow.bound(kEverywhere, {0.0, longest}).gradient;
    if (!std::isfinite(lipschitz)) return "no bound of the flow's derivative can be found: it grows without limit";
    if (lipschitz * longest > kMostGrowth)
        return fmt::format("the flow's derivative is up to {:.4g}, and {:.4g} times the duration {:.4g} is {:.4g}: at most {:.4g} can be traced",
                           lipschitz, lipschitz, longest, lipschitz * longest, kMostGrowth);
    return {};
}

Warp::Warp(FlowPtr flow, double longest, double usual) : flow_(std::move(flow)), longest_(longest)
{
    lipschitz_ = flow_->bound(kEverywhere, {0.0, longest}).gradient;
    steps_ = std::max(1, static_cast<int>(std::ceil(3.5 * flow_->usual_gradient() * std::min(longest, usual))));
}

/// One step of RK4 with its exact derivative: from time t by h, both signed. `stages` are where the velocity was taken.
Carried Warp::step(const Carried& at, double t, double h, Stage (&stages)[4]) const
{
    const Matrix3d& j = at.jacobian;
    const Motion m1 = flow_->motion(at.point, t);
    const Vec3d k1 = m1.velocity, y2 = at.point + k1 * (0.5 * h);
    const Motion m2 = flow_->motion(y2, t + 0.5 * h);
    const Vec3d k2 = m2.velocity, y3 = at.point + k2 * (0.5 * h);
    const Motion m3 = flow_->motion(y3, t + 0.5 * h);
    const Vec3d k3 = m3.velocity, y4 = at.point + k3 * h;
    const Motion m4 = flow_->motion(y4, t + h);
    const Vec3d k4 = m4.velocity;
    stages[0] = {at.point, k1.length(), m1.gradient};
    stages[1] = {y2, k2.length(), m2.gradient};
    stages[2] = {y3, k3.length(), m3.gradient};
    stages[3] = {y4, k4.length(), m4.gradient};
    const Matrix3d d1 = stages[0].gradient * j;
    const Matrix3d d2 = stages[1].gradient * (j + d1 * (0.5 * h));
    const Matrix3d d3 = stages[2].gradient * (j + d2 * (0.5 * h));
    const Matrix3d d4 = stages[3].gradient * (j + d3 * h);
    return {at.point + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0), j + (d1 + (d2 + d3) * 2.0 + d4) * (h / 6.0)};
}

Vec3d Warp::inverse(const Vec3d& p, double duration) const
{
    if (flow_->closed_form()) return flow_->carry(p, -duration).point;
    Vec3d x = p;
    const double h = duration / steps_;
    for (int n = 0; n < steps_; ++n) {
        const double t = duration - n * h;
        const Vec3d k1 = flow_->velocity(x, t);
        const Vec3d k2 = flow_->velocity(x - k1 * (0.5 * h), t - 0.5 * h);
        const Vec3d k3 = flow_->velocity(x - k2 * (0.5 * h), t - 0.5 * h);
        const Vec3d k4 = flow_->velocity(x - k3 * h, t - h);
        x -= (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
    }
    return x;
}

Carried Warp::inverse_with_jacobian(const Vec3d& p, double duration) const
{
    if (flow_->closed_form()) return flow_->carry(p, -duration);
    Carried at{p, Matrix3d()};
    const double h = duration / steps_;
    Stage stages[4];
    for (int n = 0; n < steps_; ++n) at = step(at, duration - n * h, -h, stages);
    return at;
}

Vec3d Warp::forward(const Vec3d& p, double duration) const
{
    if (flow_->closed_form()) return flow_->carry(p, duration).point;
    Carried guess{p, Matrix3d()};
    const double h = duration / steps_;
    Stage stages[4];
    for (int n = 0; n < steps_; ++n) guess = step(guess, n * h, h, stages);
    Vec3d x = guess.point;
    // Newton converges quadratically from an error of the order h^4.
    for (int k = 0; k < 8; ++k) {
        const Carried back = inverse_with_jacobian(x, duration);
        const Vec3d miss = back.point - p;
        x -= apply(back.jacobian.inverse(), miss);
        if (miss.length2() <= 1e-28 * (1.0 + p.length2())) break;
    }
    return x;
}

double Warp::reach(const Box3d& box) const
{
    const double speed = flow_->bound(box, {0.0, longest_}).speed;
    const double here = speed * grown(lipschitz_, longest_);
    // A flow of bounded speed reaches no farther than that speed, however it grows.
    const double anywhere = flow_->bound(kEverywhere, {0.0, longest_}).speed * longest_;
    return std::min(here, anywhere);
}

/// Bounds of one step over a bundle of points within `spread` of `at`, and of its map at the centre. `t` is the centre's time, `times` all that are
/// met.
Warp::StepBound Warp::bound_step(const Vec3d& at, double spread, const Interval& lengths, double t, const Interval& times) const
{
    const double middle = 0.5 * (lengths.lo + lengths.hi), uneven = 0.5 * (lengths.hi - lengths.lo);
    const double longest = std::max(std::abs(lengths.lo), std::abs(lengths.hi)), growth = std::exp(lipschitz_ * longest);
    StepBound bound;
    if (flow_->closed_form()) {
        bound.centre = flow_->carry(at, -middle);
        // Along a path of a steady flow the speed grows no faster than e^(L t).
        const double wide = spread * growth + flow_->velocity(at, 0.0).length() * grown(lipschitz_, longest);
        const FlowBound here = flow_->bound(Box3d(at - Vec3d(wide), at + Vec3d(wide)), times);
        bound.jet = exact_jet(longest, here.speed, here.gradient, std::min(here.hessian, kBeyond));
        return bound;
    }
    Stage stages[4];
    bound.centre = step({at, Matrix3d()}, t, -middle, stages);
    // At each stage the bundle is at most so wide about the centre's own: w = (spread + uneven (|v| + L w)) e^(L h), solved for w.
    double speed = 0.0;
    Box3d hull;
    for (const Stage& stage : stages) {
        hull.extendBy(stage.point);
        speed = std::max(speed, stage.speed);
    }
    // Stages of other durations are taken at other times.
    const double flow_drift = flow_->bound(hull, times).drift, apart = uneven * steps_;
    const double feedback = 1.0 - uneven * lipschitz_ * growth;
    const double wide = feedback > 0.1 ? (spread + uneven * (speed + lipschitz_ * flow_drift * apart)) * growth / feedback : kBeyond;
    const FlowBound here = flow_->bound(Box3d(hull.min - Vec3d(wide), hull.max + Vec3d(wide)), times);
    const double hessian = std::min(here.hessian, kBeyond);
    double gradients[4];
    for (int k = 0; k < 4; ++k) gradients[k] = std::min(here.gradient, norm_bound(stages[k].gradient) + hessian * (wide + here.drift * apart));
    bound.jet = rk4_jet(longest, here.speed, gradients, hessian, here.drift * steps_);
    return bound;
}

InverseBound Warp::inverse_bound(const Box3d& box, const Interval& durations) const
{
    const Vec3d half = box.size() * 0.5;
    const double radius = std::max(half.length(), 1e-300), span = 0.5 * (durations.hi - durations.lo);
    // Steps of the discrete map itself, or as many as keep the bounds of an exact one close.
    const int steps = flow_->closed_form()
                          ? std::max(1, static_cast<int>(std::ceil(4.0 * lipschitz_ * std::max(std::abs(durations.lo), std::abs(durations.hi)))))
                          : steps_;
    const Interval lengths{durations.lo / steps, durations.hi / steps};

    Carried at{box.center(), Matrix3d()};
    NormJet all = NormJet::identity();
    for (int n = 0; n < steps; ++n) {
        // How far the bundle is spread at the beginning of this step.
        const double spread = std::min(all.x * radius, (norm_bound(at.jacobian) + 0.5 * all.xx * radius) * radius) + all.h * span / steps;
        const Interval times{durations.lo * (steps - n - 1) / steps, durations.hi * (steps - n) / steps};
        StepBound bound = bound_step(at.point, spread, lengths, 0.5 * (durations.lo + durations.hi) * (steps - n) / steps, times);
        // The derivative at the centre is known; elsewhere it differs by what the second derivatives allow.
        bound.jet.x = std::min(bound.jet.x, norm_bound(bound.centre.jacobian) + bound.jet.xx * spread + bound.jet.xh * span / steps);
        all = all.then(bound.jet);
        at = {bound.centre.point, bound.centre.jacobian * at.jacobian};
    }
    // From the step to the duration: h = T / steps.
    all.h /= steps, all.xh /= steps, all.hh /= static_cast<double>(steps) * steps;
    all.x = std::min(all.x, norm_bound(at.jacobian) + all.xx * radius + all.xh * span);
    InverseBound bound{at.point, at.jacobian, all, Vec3d(0.0)};
    const double curved = 0.5 * all.xx * radius * radius + all.h * span + all.xh * radius * span;
    const double most = all.x * radius + all.h * span;
    for (int i = 0; i < 3; ++i) {
        double straight = 0.0;
        for (int k = 0; k < 3; ++k) straight += std::abs(at.jacobian[i][k]) * half[k];
        bound.half_image[i] = std::min(straight + curved, most);
    }
    return bound;
}

}  // namespace hoodoo
