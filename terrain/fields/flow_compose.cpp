// Flows of flows: scaled, summed, drifting, masked. Bounds follow from the sum and the product rule.
// Gamito2001, section 2, allows v(x, t): here the pattern of a steady flow moves, v(p, t) = v0(p - c t), so a step in time is a
// step in space. In coordinates that move
// along, q = p - c t, it is the steady flow v0(q) - c: how tests know its paths.
// Mask: v m, m = product over the axes of a quintic fade s with |s'| <= (15/8) / f and |s''| <= (10/sqrt 3) / f^2. |grad m|^2 <= sum of squares; of
// the Hessian the Frobenius norm. |D(vm)| <= |Dv| + |v||m'|, |D2(vm)| <= |D2v| + 2|Dv||m'| + |v||m''|; where the box lies in the mask's plateau m' =
// 0.
#include "terrain/fields/flow.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

class Scaled final : public Flow
{
public:
    Scaled(FlowPtr flow, double factor) : flow_(std::move(flow)), factor_(factor) {}
    Vec3d velocity(const Vec3d& p, double t) const override { return flow_->velocity(p, t) * factor_; }
    Matrix3d gradient(const Vec3d& p, double t) const override { return flow_->gradient(p, t) * factor_; }
    FlowBound bound(const Box3d& box, const Interval& times) const override
    {
        const FlowBound b = flow_->bound(box, times);
        const double f = std::abs(factor_);
        return {b.speed * f, b.gradient * f, b.hessian * f, b.drift};
    }
    double usual_gradient() const override { return std::abs(factor_) * flow_->usual_gradient(); }
    bool closed_form() const override { return flow_->closed_form(); }
    Carried carry(const Vec3d& p, double t) const override { return flow_->carry(p, t * factor_); }

private:
    FlowPtr flow_;
    double factor_;
};

class Sum final : public Flow
{
public:
    explicit Sum(std::vector<FlowPtr> flows) : flows_(std::move(flows)) {}
    Vec3d velocity(const Vec3d& p, double t) const override
    {
        Vec3d v(0.0);
        for (const FlowPtr& flow : flows_) v += flow->velocity(p, t);
        return v;
    }
    Matrix3d gradient(const Vec3d& p, double t) const override
    {
        Matrix3d m = Matrix3d() * 0.0;
        for (const FlowPtr& flow : flows_) m += flow->gradient(p, t);
        return m;
    }
    FlowBound bound(const Box3d& box, const Interval& times) const override
    {
        FlowBound sum;
        for (const FlowPtr& flow : flows_) {
            const FlowBound b = flow->bound(box, times);
            sum = {sum.speed + b.speed, sum.gradient + b.gradient, sum.hessian + b.hessian, std::max(sum.drift, b.drift)};
        }
        return sum;
    }
    double usual_gradient() const override
    {
        double sum = 0.0;
        for (const FlowPtr& flow : flows_) sum += flow->usual_gradient();
        return sum;
    }

private:
    std::vector<FlowPtr> flows_;
};

class Drifting final : public Flow
{
public:
    Drifting(FlowPtr flow, const Vec3d& drift) : flow_(std::move(flow)), drift_(drift) {}
    Vec3d velocity(const Vec3d& p, double t) const override { return flow_->velocity(p - drift_ * t, 0.0); }
    Matrix3d gradient(const Vec3d& p, double t) const override { return flow_->gradient(p - drift_ * t, 0.0); }
    FlowBound bound(const Box3d& box, const Interval& times) const override
    {
        Box3d swept(box.min - drift_ * times.lo, box.max - drift_ * times.lo);
        swept.extendBy(Box3d(box.min - drift_ * times.hi, box.max - drift_ * times.hi));
        FlowBound b = flow_->bound(swept, {0.0, 0.0});
        b.drift = drift_.length();
        return b;
    }
    double usual_gradient() const override { return flow_->usual_gradient(); }

private:
    FlowPtr flow_;
    Vec3d drift_;
};

class Masked final : public Flow
{
public:
    Masked(FlowPtr flow, const Box3d& box, double fade) : flow_(std::move(flow)), box_(box), fade_(fade) {}

    Vec3d velocity(const Vec3d& p, double t) const override
    {
        const Mask m = mask(p);
        return m.value > 0.0 ? flow_->velocity(p, t) * m.value : Vec3d(0.0);
    }
    Matrix3d gradient(const Vec3d& p, double t) const override
    {
        const Mask m = mask(p);
        if (!(m.value > 0.0)) return Matrix3d() * 0.0;
        const Vec3d v = flow_->velocity(p, t);
        Matrix3d d = flow_->gradient(p, t) * m.value;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) d[i][j] += v[i] * m.gradient[j];
        return d;
    }
    FlowBound bound(const Box3d& box, const Interval& times) const override
    {
        // Axes along which the box reaches into the fade, and whether it lies beyond it.
        int fading = 0;
        Box3d part = box;
        for (int k = 0; k < 3; ++k) {
            part.min[k] = std::max(box.min[k], box_.min[k] - fade_);
            part.max[k] = std::min(box.max[k], box_.max[k] + fade_);
            if (part.min[k] > part.max[k]) return {};
            fading += box.min[k] < box_.min[k] || box.max[k] > box_.max[k];
        }
        FlowBound b = flow_->bound(part, times);
        const double slope = std::sqrt(static_cast<double>(fading)) * kSlope / fade_;
        const double curve = std::sqrt(fading * kCurve * kCurve + fading * (fading - 1.0) * kSlope * kSlope * kSlope * kSlope) / (fade_ * fade_);
        if (fading > 0) {
            b.hessian += 2.0 * b.gradient * slope + b.speed * curve;
            b.gradient += b.speed * slope;
        }
        return b;
    }
    double usual_gradient() const override { return std::min(2.0 * flow_->usual_gradient(), Flow::usual_gradient()); }

private:
    static constexpr double kSlope = 1.875, kCurve = 5.7736;
    struct Mask {
        double value = 1.0;
        Vec3d gradient{0.0};
    };

    Mask mask(const Vec3d& p) const
    {
        double s[3], d[3];
        for (int k = 0; k < 3; ++k) {
            const double below = (box_.min[k] - p[k]) / fade_, above = (p[k] - box_.max[k]) / fade_;
            const double x = std::max(below, above), t = std::clamp(1.0 - x, 0.0, 1.0);
            s[k] = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
            d[k] = x > 0.0 && x < 1.0 ? 30.0 * t * t * (t - 1.0) * (t - 1.0) / fade_ * (below > above ? 1.0 : -1.0) : 0.0;
        }
        return {s[0] * s[1] * s[2], Vec3d(d[0] * s[1] * s[2], s[0] * d[1] * s[2], s[0] * s[1] * d[2])};
    }

    FlowPtr flow_;
    Box3d box_;
    double fade_;
};

}  // namespace

FlowPtr scaled_flow(FlowPtr flow, double factor)
{
    return std::make_shared<Scaled>(std::move(flow), factor);
}

FlowPtr sum_flow(std::vector<FlowPtr> flows)
{
    if (flows.size() == 1) return flows.front();
    return std::make_shared<Sum>(std::move(flows));
}

FlowPtr drifting_flow(FlowPtr flow, const Vec3d& drift)
{
    return std::make_shared<Drifting>(std::move(flow), drift);
}

FlowPtr masked_flow(FlowPtr flow, const Box3d& box, double fade)
{
    return std::make_shared<Masked>(std::move(flow), box, fade);
}

}  // namespace hoodoo
