// What combines nodes, bends them, roughens them, and what brings other terrains in.
//
// All three set operators are one minimum with signs: union min(v), intersection -min(-v), difference -min(-a, b, c ...). With a width k two values
// become, where they are nearer than k to each other,
//   m(a, b) = min(a, b) - (k - |a - b|)^2 / (4 k),   grad m = (1 - w) grad a + w grad b,   w = (1 + (a - b) / k) / 2 in [0, 1],
// and more than two one after another, in the order of the scene. m is once continuously differentiable; its gradient is a mean of the nodes', so its
// slope is at most theirs; it rises with each, so ranges give its range; it turns by at most what they turn and |grad a - grad b|^2 / (2 k). What
// lies more than k above the least changes no bit and is not asked, if its box says so. Noise adds its own bounds (math/noise.h). The tree is
// Wyvill1999's; there densities fall off with the distance and add up, here distances are blended, which keeps a unit, a slope of 1 and an end to
// every influence. Missing: edges of intersections as objects of their own (creases are met by the certified march like all else).
#include "terrain/fields/blob_tree.h"

#include "terrain/math/noise.h"
#include "terrain/math/noise_hessian.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hoodoo
{

namespace
{

/// Two nodes' values in one.
struct Joined {
    double value, share;  ///< share: of the second
};

Joined join(double a, double b, double width)
{
    // What was left out is infinitely far.
    if (a == kInfinity) return {b, 1.0};
    if (b == kInfinity) return {a, 0.0};
    const double apart = a - b;
    if (apart >= width) return {b, 1.0};
    if (apart <= -width) return {a, 0.0};
    const double near = width - std::abs(apart);
    return {std::min(a, b) - near * near / (4.0 * width), 0.5 + 0.5 * apart / width};
}

/// Two nodes' bounds in one; `centre` is left to the caller.
LocalField join(const LocalField& a, const LocalField& b, double width)
{
    if (a.value.hi + width <= b.value.lo) return a;
    if (b.value.hi + width <= a.value.lo) return b;
    LocalField known = a;
    known.value = {join(a.value.lo, b.value.lo, width).value, join(a.value.hi, b.value.hi, width).value};
    known.mixed = 0.0;
    const auto share = [&](double apart) { return width > 0.0 ? std::clamp(0.5 + 0.5 * apart / width, 0.0, 1.0) : apart > 0.0 ? 1.0 : 0.0; };
    const Interval second{share(a.value.lo - b.value.hi), share(a.value.hi - b.value.lo)};
    double apart = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Interval hull = Interval::hull(a.gradient[k], b.gradient[k]), difference = b.gradient[k] + -a.gradient[k];
        known.gradient[k] = std::isfinite(difference.magnitude()) ? Interval::common(hull, a.gradient[k] + second * difference) : hull;
        apart += difference.magnitude() * difference.magnitude();
    }
    const double bend = std::max({a.curvature, a.mixed, a.upright, b.curvature, b.mixed, b.upright});
    known.curvature = known.upright = width > 0.0 ? bend + apart / (2.0 * width) : kInfinity;
    return known;
}

class Combine final : public BlobNode
{
public:
    Combine(BlobOperator what, std::vector<BlobPtr> nodes, double width) : what_(what), nodes_(std::move(nodes)), width_(width)
    {
        outer_ = what == BlobOperator::unite ? 1.0 : -1.0;
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            signs_.push_back(what == BlobOperator::unite || (what == BlobOperator::subtract && n > 0) ? 1.0 : -1.0);
    }

    double value(const Vec3d& p) const override
    {
        Few few;
        std::vector<double> many;
        const double* v = values(p, few, many);
        double all = v[0];
        for (std::size_t n = 1; n < nodes_.size(); ++n) all = join(all, v[n], width_).value;
        return outer_ * all;
    }

    Vec3d gradient(const Vec3d& p) const override
    {
        Vec3d g(0.0);
        each_share(p, [&](std::size_t n, double share) { g += nodes_[n]->gradient(p) * (share * signs_[n] * outer_); });
        return g;
    }

    LocalField local(const Box3d& box) const override
    {
        const Vec3d centre = box.center();
        const double radius = 0.5 * box.size().length();
        // What has the least lower bound first: most others need not be asked then.
        std::vector<std::optional<LocalField>> each(nodes_.size());
        std::vector<double> bounds(nodes_.size());
        for (std::size_t n = 0; n < nodes_.size(); ++n) bounds[n] = signs_[n] > 0.0 ? nodes_[n]->lower_bound(centre) - radius : -kInfinity;
        const auto first = static_cast<std::size_t>(std::min_element(bounds.begin(), bounds.end()) - bounds.begin());
        double highest = kInfinity;  // the least of the upper ends
        const auto ask = [&](std::size_t n) {
            if (each[n] || bounds[n] > highest + width_) return;
            LocalField own = nodes_[n]->local(box);
            if (signs_[n] < 0.0) negate(own);
            highest = std::min(highest, own.value.hi);
            each[n] = own;
        };
        ask(first);
        for (std::size_t n = 0; n < nodes_.size(); ++n) ask(n);
        std::optional<LocalField> known;
        for (const auto& own : each) {
            if (own) known = known ? join(*known, *own, width_) : *own;
        }
        known->centre = outer_ * value(centre);
        if (width_ > 0.0 && std::isfinite(known->curvature)) narrow_by_gradient(box, gradient(centre) * outer_, *known);
        known->value = {known->value.lo - 1e-12 * width_, known->value.hi + 1e-12 * width_};
        if (outer_ < 0.0) negate(*known);
        return *known;
    }

    double lower_bound(const Vec3d& p) const override
    {
        if (what_ == BlobOperator::unite) {
            double least = kInfinity;
            for (const BlobPtr& node : nodes_) least = std::min(least, node->lower_bound(p));
            return least - bulge();
        }
        double most = nodes_[0]->lower_bound(p);
        if (what_ == BlobOperator::intersect)
            for (const BlobPtr& node : nodes_) most = std::max(most, node->lower_bound(p));
        return most;
    }

    void shares(const Vec3d& p, double weight, BlobShares& out) const override
    {
        each_share(p, [&](std::size_t n, double share) {
            if (share < 1e-4) return;
            if (what_ != BlobOperator::subtract || n == 0) return nodes_[n]->shares(p, share * weight, out);
            // What carves shows what is carved, but where it was given a material.
            BlobShares cut;
            nodes_[n]->shares(p, share * weight, cut);
            for (const BlobShares::Share& s : cut.list) {
                if (s.source == BlobShares::kNoSource) {
                    nodes_[0]->shares(p, s.weight, out);
                } else {
                    out.add(s.source, s.weight);
                }
            }
        });
    }

    Box3d bounds() const override
    {
        Box3d box = nodes_[0]->bounds();
        for (const BlobPtr& node : nodes_) {
            const Box3d other = node->bounds();
            if (what_ == BlobOperator::unite) box.extendBy(other);
            if (what_ == BlobOperator::intersect)
                for (int k = 0; k < 3; ++k) box.min[k] = std::max(box.min[k], other.min[k]), box.max[k] = std::min(box.max[k], other.max[k]);
        }
        const double more = what_ == BlobOperator::unite ? bulge() : 0.0;
        return {box.min - Vec3d(more), box.max + Vec3d(more)};
    }

private:
    using Few = std::array<double, 16>;

    static void negate(LocalField& f)
    {
        f.value = -f.value;
        f.centre = -f.centre;
        for (Interval& g : f.gradient) g = -g;
    }

    /// How far below the minimum n values can come: each joining takes a quarter of the width at most, where they are equal.
    double bulge() const { return 0.25 * width_ * static_cast<double>(nodes_.size() - 1); }

    /// The nodes' values with their signs, or infinity where a node is certainly too far above the least to count.
    const double* values(const Vec3d& p, Few& few, std::vector<double>& many) const
    {
        double* v = few.data();
        if (nodes_.size() > few.size()) {
            many.resize(nodes_.size());
            v = many.data();
        }
        for (std::size_t n = 0; n < nodes_.size(); ++n) v[n] = signs_[n] > 0.0 ? nodes_[n]->lower_bound(p) : -kInfinity;
        const auto first = static_cast<std::size_t>(std::min_element(v, v + nodes_.size()) - v);
        double least = v[first] = signs_[first] * nodes_[first]->value(p);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (n == first) continue;
            v[n] = v[n] > least + width_ ? kInfinity : signs_[n] * nodes_[n]->value(p);
            least = std::min(least, v[n]);
        }
        return v;
    }

    /// visit(n, share) for the nodes that the value at p is made of; shares sum to 1.
    template <class Visit>
    void each_share(const Vec3d& p, const Visit& visit) const
    {
        Few few, share_of_few;
        std::vector<double> many, shares_of_many;
        const double* v = values(p, few, many);
        double* share = share_of_few.data();
        if (nodes_.size() > few.size()) {
            shares_of_many.resize(nodes_.size());
            share = shares_of_many.data();
        }
        double all = v[0];
        share[0] = 1.0;
        for (std::size_t n = 1; n < nodes_.size(); ++n) {
            const Joined joined = join(all, v[n], width_);
            for (std::size_t m = 0; m < n; ++m) share[m] *= 1.0 - joined.share;
            share[n] = joined.share;
            all = joined.value;
        }
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            if (share[n] > 0.0) visit(n, share[n]);
    }

    BlobOperator what_;
    std::vector<BlobPtr> nodes_;
    std::vector<double> signs_;
    double width_, outer_;
};

class Warped final : public BlobNode
{
public:
    Warped(BlobPtr node, Warp warp, double duration) : node_(node), field_(std::move(node), std::move(warp), duration) {}
    double value(const Vec3d& p) const override { return field_.value(p); }
    Vec3d gradient(const Vec3d& p) const override { return field_.gradient(p); }
    LocalField local(const Box3d& box) const override { return field_.local(box, {field_.duration(), field_.duration()}); }
    void shares(const Vec3d& p, double weight, BlobShares& out) const override
    {
        node_->shares(field_.warp().inverse(p, field_.duration()), weight, out);
    }
    Box3d bounds() const override { return field_.bounds(); }

private:
    BlobPtr node_;
    WarpedField field_;
};

class Noisy final : public BlobNode
{
public:
    Noisy(BlobPtr node, const BlobNoise& n) : node_(std::move(node)), n_(n), fractal_{n.octaves, 2.0, n.gain}
    {
        const NoiseBound bound = fbm_bound(kNoise3Bound, fractal_);
        scale_ = n.amplitude / bound.value;
        slope_ = scale_ * bound.slope / n.wavelength;
        // Octave k is turned, so its second derivative keeps its norm; it grows by the frequency squared.
        double sum = 0.0, factor = 1.0;
        for (double k = 0.0; k < n.octaves; k += 1.0, factor *= n.gain * 4.0) sum += factor;
        curvature_ = scale_ * kNoise3Derivatives.hessian * sum / (n.wavelength * n.wavelength);
    }

    double value(const Vec3d& p) const override { return node_->value(p) + scale_ * at(p).value; }
    Vec3d gradient(const Vec3d& p) const override { return node_->gradient(p) + at(p).gradient * (scale_ / n_.wavelength); }
    LocalField local(const Box3d& box) const override
    {
        LocalField known = node_->local(box);
        const Noise3 n = at(box.center());
        const LocalField own = local_from_centre(box, scale_ * n.value, n.gradient * (scale_ / n_.wavelength), slope_, curvature_);
        known.value = known.value + Interval::common(own.value, {-n_.amplitude, n_.amplitude});
        for (std::size_t k = 0; k < 3; ++k) known.gradient[k] = known.gradient[k] + own.gradient[k];
        known.centre += own.centre;
        known.curvature += curvature_;
        known.upright += curvature_;
        known.value = {known.value.lo - 1e-12, known.value.hi + 1e-12};
        return known;
    }
    double lower_bound(const Vec3d& p) const override { return node_->lower_bound(p) - n_.amplitude; }
    void shares(const Vec3d& p, double weight, BlobShares& out) const override { node_->shares(p, weight, out); }
    Box3d bounds() const override
    {
        const Box3d box = node_->bounds();
        return {box.min - Vec3d(n_.amplitude), box.max + Vec3d(n_.amplitude)};
    }

private:
    Noise3 at(const Vec3d& p) const { return fbm((p - n_.origin) / n_.wavelength, n_.seed, fractal_); }

    BlobPtr node_;
    BlobNoise n_;
    Fractal fractal_;
    double scale_ = 0.0, slope_ = 0.0, curvature_ = 0.0;
};

class Terrain final : public BlobNode
{
public:
    Terrain(std::shared_ptr<const Field> field, const Box3d& bounds, double scale, std::int32_t number)
        : field_(std::move(field)), box_(bounds), scale_(scale), number_(number)
    {
    }
    double value(const Vec3d& p) const override { return scale_ * field_->value(p); }
    Vec3d gradient(const Vec3d& p) const override { return field_->gradient(p) * scale_; }
    LocalField local(const Box3d& box) const override
    {
        LocalField known;
        known.value = field_->range(box).scaled(scale_);
        known.centre = value(box.center());
        known.gradient = field_->gradient_range(box);
        for (Interval& g : known.gradient) g = g.scaled(scale_);
        known.curvature = known.upright = scale_ * field_->curvature_bound(box);
        return known;
    }
    void shares(const Vec3d&, double weight, BlobShares& out) const override { out.add(BlobShares::kTerrain + number_, weight); }
    Box3d bounds() const override { return box_; }

private:
    std::shared_ptr<const Field> field_;
    Box3d box_;
    double scale_;
    std::int32_t number_;
};

}  // namespace

BlobPtr blob_combine(BlobOperator what, std::vector<BlobPtr> nodes, double width)
{
    return std::make_shared<Combine>(what, std::move(nodes), width);
}

BlobPtr blob_warp(BlobPtr node, Warp warp, double duration)
{
    return std::make_shared<Warped>(std::move(node), std::move(warp), duration);
}

BlobPtr blob_noise(BlobPtr node, const BlobNoise& noise)
{
    return std::make_shared<Noisy>(std::move(node), noise);
}

BlobPtr blob_terrain(std::shared_ptr<const Field> field, const Box3d& bounds, double scale, std::int32_t number)
{
    return std::make_shared<Terrain>(std::move(field), bounds, scale, number);
}

}  // namespace hoodoo
