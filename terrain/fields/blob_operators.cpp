// What combines nodes, bends them, roughens them, and what brings other terrains in.
//
// All three set operators are one minimum with signs: union min(v), intersection -min(-v), difference -min(-a, b, c ...). With a width k the minimum
// is
//   m = -k ln(sum_i exp(-v_i / k)),   grad m = sum_i w_i grad v_i,   w_i = exp((m - v_i) / k),
// the logarithm of densities that add up (Blinn1982): its gradient is a mean of the nodes', so its slope is at most theirs; it rises with each v, so
// the nodes' ranges give its range; and it turns by at most what they turn and what mixing adds, Var(grad v) / k: at most (D / 2)^2 / k with D the
// diagonal of the box that holds their gradients, and at most the second moment about one node's gradient, with the weights the ranges allow. A node
// more than 36 k above the least weighs under a unit in the last place: it is left out, as are nodes whose box is that far away (pruning changes no
// bit of a minimum). Noise adds its own bounds (math/noise.h). The tree is Wyvill1999's, with distances for potentials. Missing: intersections of
// surfaces as edges of their own (creases are met by the certified march like all else).
#include "terrain/fields/blob_tree.h"

#include "terrain/math/noise.h"
#include "terrain/math/noise_hessian.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kCut = 36.8;  // exp(-36.8) < 2^-53

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
        std::array<double, kFew> few;
        std::vector<double> many;
        const auto [v, least] = values(p, few, many);
        if (width_ == 0.0) return outer_ * least;
        double sum = 0.0;
        for (std::size_t n = 0; n < nodes_.size(); ++n) sum += weight(v[n] - least);
        return outer_ * (least - width_ * std::log(sum));
    }

    Vec3d gradient(const Vec3d& p) const override
    {
        std::array<double, kFew> few;
        std::vector<double> many;
        const auto [v, least] = values(p, few, many);
        Vec3d g(0.0);
        double sum = 0.0;
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const double w = width_ == 0.0 ? (v[n] == least ? 1.0 : 0.0) : weight(v[n] - least);
            if (w == 0.0) continue;
            g += nodes_[n]->gradient(p) * (w * signs_[n]);
            sum += w;
            if (width_ == 0.0) break;  // one side of a crease
        }
        return g * (outer_ / sum);
    }

    LocalField local(const Box3d& box) const override
    {
        const Vec3d centre = box.center();
        const double radius = 0.5 * box.size().length();
        // The nearest first, so that the far ones need not be asked.
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t n = 0; n < nodes_.size(); ++n) order.emplace_back(signs_[n] > 0.0 ? nodes_[n]->lower_bound(centre) - radius : -kInfinity, n);
        std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        std::vector<LocalField> each;
        double highest = kInfinity;  // the least of the upper ends
        for (const auto& [least, n] : order) {
            if (least > highest + kCut * width_) break;
            LocalField own = nodes_[n]->local(box);
            if (signs_[n] < 0.0) {
                own.value = -own.value;
                for (Interval& g : own.gradient) g = -g;
                own.centre = -own.centre;
            }
            highest = std::min(highest, own.value.hi);
            each.push_back(own);
        }
        std::vector<const LocalField*> near;
        for (const LocalField& own : each)
            if (own.value.lo <= highest + kCut * width_) near.push_back(&own);
        LocalField known = mixed(near);
        known.centre = outer_ * value(box.center());
        if (width_ > 0.0) narrow_by_gradient(box, gradient(box.center()) * outer_, known);
        if (outer_ < 0.0) {
            known.value = -known.value;
            known.centre = -known.centre;
            for (Interval& g : known.gradient) g = -g;
        }
        return known;
    }

    double lower_bound(const Vec3d& p) const override
    {
        if (what_ == BlobOperator::unite) {
            double least = kInfinity;
            for (const BlobPtr& node : nodes_) least = std::min(least, node->lower_bound(p));
            return least - width_ * std::log(static_cast<double>(nodes_.size()));
        }
        double most = nodes_[0]->lower_bound(p);
        if (what_ == BlobOperator::intersect)
            for (const BlobPtr& node : nodes_) most = std::max(most, node->lower_bound(p));
        return most;
    }

    void shares(const Vec3d& p, double weight_here, BlobShares& out) const override
    {
        std::array<double, kFew> few;
        std::vector<double> many;
        const auto [v, least] = values(p, few, many);
        double sum = 0.0;
        for (std::size_t n = 0; n < nodes_.size(); ++n) sum += share(v[n], least);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const double w = share(v[n], least) / sum * weight_here;
            if (w < 1e-4 * weight_here) continue;
            // What carves shows what is carved, unless it was given a material.
            const bool carved = what_ == BlobOperator::subtract && n > 0 && !nodes_[n]->paints();
            nodes_[carved ? 0 : n]->shares(p, w, out);
        }
    }

    bool paints() const override
    {
        return std::any_of(nodes_.begin(), nodes_.end(), [](const BlobPtr& node) { return node->paints(); });
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
        // A filled edge bulges by at most this.
        const double bulge = what_ == BlobOperator::unite ? width_ * std::log(static_cast<double>(nodes_.size())) : 0.0;
        return {box.min - Vec3d(bulge), box.max + Vec3d(bulge)};
    }

private:
    static constexpr std::size_t kFew = 16;

    double weight(double above) const { return above > kCut * width_ ? 0.0 : std::exp(-above / width_); }
    double share(double v, double least) const { return width_ == 0.0 ? (v == least ? 1.0 : 0.0) : weight(v - least); }

    /// The nodes' values with their signs, or infinity where a node is certainly too far above the least to count; and the least.
    std::pair<const double*, double> values(const Vec3d& p, std::array<double, kFew>& few, std::vector<double>& many) const
    {
        double* v = few.data();
        if (nodes_.size() > kFew) {
            many.resize(nodes_.size());
            v = many.data();
        }
        // First what may be the nearest, so that most others need not be asked.
        std::size_t first = 0;
        double lowest = kInfinity;
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            v[n] = signs_[n] > 0.0 ? nodes_[n]->lower_bound(p) : -kInfinity;
            if (v[n] < lowest) lowest = v[n], first = n;
        }
        double least = v[first] = signs_[first] * nodes_[first]->value(p);
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (n == first) continue;
            v[n] = v[n] > least + kCut * width_ ? kInfinity : signs_[n] * nodes_[n]->value(p);
            least = std::min(least, v[n]);
        }
        return {v, least};
    }

    /// Bounds of the minimum of nodes of which each can be the least, or near it.
    LocalField mixed(const std::vector<const LocalField*>& near) const
    {
        LocalField known = *near.front();
        double least_lo = kInfinity, least_hi = kInfinity, bend = 0.0;
        for (const LocalField* own : near) {
            for (std::size_t k = 0; k < 3; ++k) known.gradient[k] = Interval::hull(known.gradient[k], own->gradient[k]);
            least_lo = std::min(least_lo, own->value.lo);
            least_hi = std::min(least_hi, own->value.hi);
            bend = std::max({bend, own->curvature, own->mixed, own->upright});
        }
        known.value = {least_lo, least_hi};
        if (near.size() == 1) return known;
        known.mixed = 0.0;
        if (width_ == 0.0) {
            known.curvature = known.upright = kInfinity;
            return known;
        }
        double lo = 0.0, hi = 0.0;
        const LocalField* first = near.front();
        for (const LocalField* own : near) {
            lo += std::exp((least_lo - own->value.lo) / width_);
            hi += std::exp((least_hi - own->value.hi) / width_);
            if (own->value.hi < first->value.hi) first = own;
        }
        known.value = {least_lo - width_ * std::log(lo) - 1e-12 * width_, least_hi - width_ * std::log(hi) + 1e-12 * width_};

        // grad m = g_1 + sum over the others of w_i (g_i - g_1), each w_i at most what the ranges allow; likewise the second moment about g_1.
        std::array<Interval, 3> leaning = first->gradient;
        double turn = std::max({first->curvature, first->mixed, first->upright});
        for (const LocalField* own : near) {
            if (own == first) continue;
            const double most = std::min(1.0, std::exp((first->value.hi - own->value.lo) / width_));
            if (most == 0.0) continue;  // even of an infinite difference
            double apart = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Interval difference = own->gradient[k] + -first->gradient[k];
                leaning[k] = leaning[k] + Interval{std::min(0.0, most * difference.lo), std::max(0.0, most * difference.hi)};
                apart += difference.magnitude() * difference.magnitude();
            }
            turn += most * (std::max({own->curvature, own->mixed, own->upright}) + apart / width_);
        }
        double spread = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            spread += (known.gradient[k].hi - known.gradient[k].lo) * (known.gradient[k].hi - known.gradient[k].lo);
            known.gradient[k] = Interval::common(known.gradient[k], leaning[k]);
        }
        known.curvature = known.upright = std::min(turn, bend + 0.25 * spread / width_);
        return known;
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
    bool paints() const override { return node_->paints(); }
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
    bool paints() const override { return node_->paints(); }
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
    bool paints() const override { return true; }
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
