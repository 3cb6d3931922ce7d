// Operators of the tree, written once for points and for areas (area_jet.h): what holds at a point holds, in enclosures, over an area.
// Genevaux2015, Guerin2016 as they were made public by the same group: blend h = sum w h / sum w; replace h = (1 - w1) h0 + w1 h1 with the weight
// (1 - w1) w0 + w1^2; the older replace (inset here) h = h0 + q(w1) (h1 - h0), q = 6 w^5 - 15 w^4 + 10 w^3; add h = h0 + w1 h1; warp h(omega^-1(p)).
// Nodes that do not cover the plane hand out m = w h, so that nothing is ever divided by a weight that goes to 0: of those formulas only h's of
// covering nodes and products w h remain, q(w1) h1 being w1^2 (6 w1^2 - 15 w1 + 10) m1. A blend without cover is m = sum m. Where it is `united`, m =
// g sum m with g = (1 - prod (1 - w)) / sum w: g falls in each weight, |dg/dw_k| <= 1 everywhere (with f_k = prod_{j != k} (1 - w_j), s_k = sum_{j !=
// k} w_j: dg/dw_k = (f_k (1 + s_k) - 1) / s^2, and 1 - f_k <= s_k), so that its bounds hold where all weights vanish. A united blend has a corner
// there, which no picture shows. Maximum and minimum ("unions by max(h)") are h0 + max(0, w1 (h1 - h0)): for w1 = 1 the maximum, and without a step
// where the weight ends. No node is asked over an area outside of its support (support_tree.h). Missing: erosion.
#include "terrain/error.h"
#include "terrain/fields/landform.h"
#include "terrain/fields/support_tree.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

/// c[0] + c[1] x + ... of the degree given by its length, with its derivative.
template <std::size_t N>
std::pair<double, double> polynomial(const std::array<double, N>& c, double x)
{
    double value = 0.0, slope = 0.0;
    for (std::size_t k = N; k-- > 0;) {
        slope = slope * x + value;
        value = value * x + c[k];
    }
    return {value, slope};
}

template <std::size_t N>
std::array<double, N - 1> derivative(const std::array<double, N>& c)
{
    std::array<double, N - 1> d{};
    for (std::size_t k = 1; k < N; ++k) d[k - 1] = c[k] * static_cast<double>(k);
    return d;
}

/// Values over an interval, from the ends and the places where the derivative is 0.
template <std::size_t N, std::size_t M>
Interval extremes(const std::array<double, N>& c, const Interval& x, const std::array<double, M>& level)
{
    const double a = polynomial(c, x.lo).first, b = polynomial(c, x.hi).first;
    Interval range{std::min(a, b), std::max(a, b)};
    for (const double at : level) {
        // The place itself is rounded, the extreme there almost not.
        const double v = polynomial(c, std::clamp(at, x.lo, x.hi)).first;
        range = Interval::hull(range, {v, v});
    }
    return range;
}

/// q(w) and q(w) / w, with the places in [0, 1] where their derivatives of orders 1, 2 and 3 vanish.
constexpr std::array<double, 6> kQuintic{0.0, 0.0, 0.0, 10.0, -15.0, 6.0};
constexpr std::array<double, 2> kQuinticLevel{0.0, 1.0};
const std::array<double, 3> kQuinticSteepest{0.0, 0.5, 1.0};
const std::array<double, 2> kQuinticBent{0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)};
constexpr std::array<double, 5> kShare{0.0, 0.0, 10.0, -15.0, 6.0};
const std::array<double, 2> kShareLevel{0.0, (45.0 - std::sqrt(105.0)) / 48.0};
const std::array<double, 2> kShareSteepest{(45.0 - std::sqrt(585.0)) / 72.0, (45.0 + std::sqrt(585.0)) / 72.0};
constexpr std::array<double, 1> kShareBent{0.625};

template <std::size_t N, std::size_t A, std::size_t B, std::size_t C>
Jet2 curve_of(const std::array<double, N>& c, const std::array<double, A>&, const std::array<double, B>&, const std::array<double, C>&, const Jet2& w)
{
    const auto [value, slope] = polynomial(c, w.value);
    return {value, w.gradient * slope};
}

template <std::size_t N, std::size_t A, std::size_t B, std::size_t C>
AreaJet curve_of(const std::array<double, N>& c, const std::array<double, A>& level, const std::array<double, B>& steepest,
                 const std::array<double, C>& bent, const AreaJet& w)
{
    const Interval x{std::clamp(w.value.lo, 0.0, 1.0), std::clamp(w.value.hi, 0.0, 1.0)};
    const auto d = derivative(c);
    const CurveBounds bounds{extremes(c, x, level), extremes(d, x, steepest), extremes(derivative(d), x, bent).magnitude()};
    const auto [value, slope] = polynomial(c, w.at.value);
    return compose(value, slope, bounds, w);
}

Jet2 constant_like(const Jet2&, double value)
{
    return {value};
}

AreaJet constant_like(const AreaJet& like, double value)
{
    return AreaJet::constant(value, like.radius);
}

/// w (h - datum) and w of any node.
template <class T>
Elevated<T> weighted(const Elevated<T>& e, bool covers)
{
    return {covers ? e.height * e.weight : e.height, e.weight, e.heights};
}

/// Narrows what is known of a node by the range of its heights.
Elevated<AreaJet> settled(Elevated<AreaJet> e, bool covers)
{
    if (e.heights.lo > e.heights.hi) return e;
    e.height.within(covers ? e.heights : Interval::hull({0.0, 0.0}, e.weight.value * e.heights));
    return e;
}
Elevated<Jet2> settled(const Elevated<Jet2>& e, bool)
{
    return e;
}

/// The range of heights that an operator makes of two; `share`: of the second's weights.
Interval heights_after(LandformOperator what, const Interval& a, const Interval& b, const Interval& share)
{
    if (b.lo > b.hi || a.lo > a.hi) return a;
    switch (what) {
        case LandformOperator::add:
            return a + b * share;
        case LandformOperator::raise:
            return {a.lo, std::max(a.hi, b.hi)};
        case LandformOperator::lower:
            return {std::min(a.lo, b.lo), a.hi};
        default:
            return Interval::hull(a, b);
    }
}

/// The same with weights above 1 taken for 1.
template <class T>
Elevated<T> capped(const Elevated<T>& e)
{
    const T above = positive_part(shifted(e.weight, -1.0));
    return settled({quotient(e.height, shifted(above, 1.0)), e.weight - above, e.heights}, false);
}

double least_of(const std::vector<LandformPtr>& nodes, BlendWeight weight)
{
    double sum = 0.0, without = 1.0;
    for (const LandformPtr& node : nodes) {
        sum += node->least_weight();
        without *= 1.0 - std::min(1.0, node->least_weight());
    }
    return weight == BlendWeight::sum ? sum : 1.0 - without;
}

std::vector<Box2d> supports(std::span<const LandformPtr> nodes)
{
    std::vector<Box2d> boxes;
    for (const LandformPtr& node : nodes) boxes.push_back(node->support());
    return boxes;
}

Box2d hull(std::span<const Box2d> boxes)
{
    Box2d all;
    for (const Box2d& box : boxes) {
        all.extendBy(box.min);
        all.extendBy(box.max);
    }
    return all;
}

std::uint64_t bytes_of(const std::vector<LandformPtr>& nodes)
{
    std::uint64_t sum = 0;
    for (const LandformPtr& node : nodes) sum += node->memory_bytes();
    return sum;
}

// -- Blend -------------------------------------------------------------------------------------------------------------

/// (1 - prod (1 - w)) / sum w at a point.
double united_share(std::span<const double> weights)
{
    double sum = 0.0, without = 1.0;
    for (const double w : weights) {
        sum += w;
        without *= 1.0 - w;
    }
    return sum > 0.0 ? (1.0 - without) / sum : 1.0;
}

Jet2 united_factor(const std::vector<Elevated<Jet2>>& parts, const Jet2& sum, const Jet2& united)
{
    return parts.size() == 1 || !(sum.value > 0.0) ? Jet2{1.0} : quotient(united, sum);
}

AreaJet united_factor(const std::vector<Elevated<AreaJet>>& parts, const AreaJet& sum, const AreaJet& united)
{
    if (parts.size() == 1) return AreaJet::constant(1.0, sum.radius);
    std::vector<double> low, high;
    double slope = 0.0;
    for (const auto& part : parts) {
        low.push_back(std::clamp(part.weight.value.lo, 0.0, 1.0));
        high.push_back(std::clamp(part.weight.value.hi, 0.0, 1.0));
        slope += part.weight.slope;
    }
    AreaJet g = AreaJet::constant(1.0, sum.radius);
    if (sum.value.lo > 0.0) {
        g = quotient(united, sum);
    } else {
        g.gradient = {Interval{-slope, slope}, Interval{-slope, slope}};
        g.curvature = slope == 0.0 ? 0.0 : kInfinity;
        g.at = sum.at.value > 0.0 ? quotient(united.at, sum.at) : Jet2{1.0};
        g.slope = slope;
        g.value = {0.0, 1.0};
    }
    g.slope = std::min(g.slope, slope);
    g.value = Interval::common(g.value, {united_share(high), united_share(low)});
    return g.narrow();
}

class Blend final : public Landform
{
public:
    Blend(std::vector<LandformPtr> nodes, BlendWeight weight)
        : nodes_(std::move(nodes)), boxes_(supports(nodes_)), tree_(boxes_), weight_(weight), least_(least_of(nodes_, weight))
    {
        for (const LandformPtr& node : nodes_) {
            if (weight == BlendWeight::united && node->most_weight() > 1.0) throw Error(ErrorKind::internal, "united weights are at most 1");
            most_ += node->most_weight();
        }
        if (weight == BlendWeight::united) most_ = 1.0;
    }

    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        return mixed<Jet2>(Box2d(p), {}, [&](const Landform& node) { return node.at(p, datum); });
    }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        return mixed<AreaJet>(area.box, AreaJet::constant(0.0, area.radius), [&](const Landform& node) { return node.over(area, datum); });
    }
    Box2d support() const override { return hull(boxes_); }
    double least_weight() const override { return least_; }
    double most_weight() const override { return most_; }
    std::uint64_t memory_bytes() const override { return bytes_of(nodes_) + boxes_.size() * 2 * sizeof(Box2d); }

private:
    template <class T, class Ask>
    Elevated<T> mixed(const Box2d& box, const T& none, const Ask& ask) const
    {
        std::vector<Elevated<T>> parts;
        Interval heights{kInfinity, -kInfinity};
        T height = none, sum = none, without = constant_like(none, 1.0);
        tree_.for_each(box, [&](std::uint32_t n) {
            parts.push_back(weighted(ask(*nodes_[n]), nodes_[n]->covers()));
            heights = Interval::hull(heights, parts.back().heights);
            height = height + parts.back().height;
            sum = sum + parts.back().weight;
            if (weight_ == BlendWeight::united) without = without * shifted(scaled(parts.back().weight, -1.0), 1.0);
        });
        if (parts.empty()) return {none, none, heights};
        const T united = shifted(scaled(without, -1.0), 1.0), weight = weight_ == BlendWeight::united ? united : sum;
        if (covers()) {
            if constexpr (std::is_same_v<T, AreaJet>) sum.value.lo = std::max(sum.value.lo, least_);
            return settled({quotient(height, sum), weight, heights}, true);
        }
        if (weight_ == BlendWeight::united) height = height * united_factor(parts, sum, united);
        return settled({height, weight, heights}, false);
    }

    std::vector<LandformPtr> nodes_;
    std::vector<Box2d> boxes_;
    SupportTree tree_;
    BlendWeight weight_;
    double least_, most_ = 0.0;
};

// -- One after another -------------------------------------------------------------------------------------------------

class Applied final : public Landform
{
public:
    Applied(LandformOperator what, std::vector<LandformPtr> nodes)
        : what_(what), nodes_(std::move(nodes)), boxes_(supports(std::span(nodes_).subspan(1))), tree_(boxes_), least_(nodes_[0]->least_weight())
    {
        if (what != LandformOperator::replace) return;
        if (!nodes_[0]->covers()) throw Error(ErrorKind::internal, "what is replaced covers the plane");
        // (1 - w1) w0 + w1^2 is least at w1 = w0 / 2, or at 1.
        for (std::size_t n = 1; n < nodes_.size(); ++n) least_ = least_ < 2.0 ? least_ - 0.25 * least_ * least_ : 1.0;
    }

    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        return after<Jet2>(Box2d(p), datum, [&](const Landform& node, double from) { return node.at(p, from); });
    }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        return after<AreaJet>(area.box, datum, [&](const Landform& node, double from) { return node.over(area, from); });
    }
    Box2d support() const override { return nodes_[0]->support(); }
    double least_weight() const override { return least_; }
    double most_weight() const override { return what_ == LandformOperator::replace ? std::max(1.0, first_most()) : first_most(); }
    std::uint64_t memory_bytes() const override { return bytes_of(nodes_) + boxes_.size() * 2 * sizeof(Box2d); }

private:
    double first_most() const { return nodes_[0]->most_weight(); }

    template <class T, class Ask>
    Elevated<T> after(const Box2d& box, double datum, const Ask& ask) const
    {
        Elevated<T> sum = ask(*nodes_[0], datum);
        tree_.for_each(box, [&](std::uint32_t n) {
            const Landform& node = *nodes_[n + 1];
            // What is added is a height by itself; all else is one beside the first.
            Elevated<T> next = weighted(ask(node, what_ == LandformOperator::add ? 0.0 : datum), node.covers());
            if (node.most_weight() > 1.0) next = capped(next);
            sum = applied(what_, sum, next, nodes_[0]->covers());
        });
        return sum;
    }

    LandformOperator what_;
    std::vector<LandformPtr> nodes_;
    std::vector<Box2d> boxes_;
    SupportTree tree_;
    double least_;
};

}  // namespace

template <class T>
static Elevated<T> combined(LandformOperator what, const Elevated<T>& a, const Elevated<T>& b, bool covered)
{
    const T rest = shifted(scaled(b.weight, -1.0), 1.0);  // 1 - w1
    switch (what) {
        case LandformOperator::replace:
            return {rest * a.height + b.height, rest * a.weight + b.weight * b.weight, {}};
        case LandformOperator::inset: {
            const T q = curve_of(kQuintic, kQuinticLevel, kQuinticSteepest, kQuinticBent, b.weight);
            const T share = curve_of(kShare, kShareLevel, kShareSteepest, kShareBent, b.weight) * b.height;
            return {shifted(scaled(q, -1.0), 1.0) * a.height + (covered ? share : a.weight * share), a.weight, {}};
        }
        case LandformOperator::add:
            return {a.height + (covered ? b.height : a.weight * b.height), a.weight, {}};
        case LandformOperator::raise:
        case LandformOperator::lower: {
            const double sign = what == LandformOperator::raise ? 1.0 : -1.0;
            const T rise = (covered ? b.height : a.weight * b.height) - b.weight * a.height;
            return {a.height + scaled(positive_part(scaled(rise, sign)), sign), a.weight, {}};
        }
    }
    throw Error(ErrorKind::internal, "no such operator");
}

template <class T>
Elevated<T> applied(LandformOperator what, const Elevated<T>& a, const Elevated<T>& b, bool covered)
{
    Elevated<T> c = combined(what, a, b, covered);
    if constexpr (std::is_same_v<T, AreaJet>) c.heights = heights_after(what, a.heights, b.heights, b.weight.value);
    return settled(c, covered);
}

template Elevated<Jet2> applied(LandformOperator, const Elevated<Jet2>&, const Elevated<Jet2>&, bool);
template Elevated<AreaJet> applied(LandformOperator, const Elevated<AreaJet>&, const Elevated<AreaJet>&, bool);

LandformPtr landform_blend(std::vector<LandformPtr> nodes, BlendWeight weight)
{
    return std::make_shared<Blend>(std::move(nodes), weight);
}

LandformPtr landform_apply(LandformOperator what, std::vector<LandformPtr> nodes)
{
    return std::make_shared<Applied>(what, std::move(nodes));
}

}  // namespace hoodoo
