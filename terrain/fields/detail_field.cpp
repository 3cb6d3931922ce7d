// Level of detail of a field without octaves: the mean of two of its coarser forms, weighted by the footprint at the place (Gamito2001 leaves it
// open). F = w_k F_(k-1) + (1 - w_k) F_k where the footprint lies in [f_k, 2 f_k], w_k = 1 - smoothstep(footprint / f_k - 1); fades do not overlap.
// Then
//   grad F = w grad F_(k-1) + (1 - w) grad F_k + (F_(k-1) - F_k) grad w
//   |D2F| <= max |D2F_i| + 2 |w'| |grad (F_(k-1) - F_k)| + |w''| |F_(k-1) - F_k|
// over a box with the levels that any of its points uses. A mean of two fields is zero only where they differ in sign or are zero both: the surface
// stays between its two forms, and there is no hole where neither has one.
#include "terrain/fields/detail_field.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 1e-12;

double length(const std::array<Interval, 3>& g)
{
    return std::sqrt(g[0].magnitude() * g[0].magnitude() + g[1].magnitude() * g[1].magnitude() + g[2].magnitude() * g[2].magnitude());
}

double product(double a, double b)
{
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

}  // namespace

DetailField::DetailField(std::vector<std::shared_ptr<const Field>> levels, std::vector<double> widths, const DetailView& view)
    : levels_(std::move(levels))
{
    for (const double width : widths) fades_.emplace_back(view, width);
}

double DetailField::value(const Vec3d& p) const
{
    // Fades do not overlap: the first that has not come to its end is the only one that may have begun.
    for (std::size_t k = 0; k < fades_.size(); ++k) {
        const double w = fades_[k].at(p).value;
        if (w == 1.0) return levels_[k]->value(p);
        if (w > 0.0) return w * levels_[k]->value(p) + (1.0 - w) * levels_[k + 1]->value(p);
    }
    return levels_.back()->value(p);
}

Vec3d DetailField::gradient(const Vec3d& p) const
{
    for (std::size_t k = 0; k < fades_.size(); ++k) {
        const DetailFade::Weight w = fades_[k].at(p);
        if (w.value == 1.0) return levels_[k]->gradient(p);
        if (w.value > 0.0)
            return levels_[k]->gradient(p) * w.value + levels_[k + 1]->gradient(p) * (1.0 - w.value) +
                   w.gradient * (levels_[k]->value(p) - levels_[k + 1]->value(p));
    }
    return levels_.back()->gradient(p);
}

DetailField::Mixed DetailField::mixed(const Box3d& box) const
{
    Mixed m;
    while (m.first < fades_.size() && fades_[m.first].over(box).value.hi == 0.0) ++m.first;
    m.last = m.first;
    while (m.last < fades_.size() && fades_[m.last].over(box).value.lo < 1.0) {
        const DetailFade::Bound w = fades_[m.last].over(box);
        m.slope = std::max(m.slope, w.slope), m.curve = std::max(m.curve, w.curve);
        const Interval a = levels_[m.last]->range(box), b = levels_[m.last + 1]->range(box);
        m.apart = std::max({m.apart, a.hi - b.lo, b.hi - a.lo});
        ++m.last;
    }
    return m;
}

double DetailField::slope_bound(const Segment& segment) const
{
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const Mixed m = mixed(box);
    double most = 0.0;
    for (std::size_t k = m.first; k <= m.last; ++k) most = std::max(most, levels_[k]->slope_bound(segment));
    return (most + product(m.slope, m.apart)) * (1.0 + kRounding);
}

Interval DetailField::range(const Box3d& box) const
{
    const Mixed m = mixed(box);
    Interval all = levels_[m.first]->range(box);
    for (std::size_t k = m.first + 1; k <= m.last; ++k) all = Interval::hull(all, levels_[k]->range(box));
    const double rounding = kRounding * (1.0 + all.magnitude());
    return m.first == m.last || !std::isfinite(rounding) ? all : Interval{all.lo - rounding, all.hi + rounding};
}

Box3d DetailField::bounds() const
{
    Box3d box;
    for (const auto& level : levels_) box.extendBy(level->bounds());
    return box;
}

std::array<Interval, 3> DetailField::gradient_range(const Box3d& box) const
{
    const Mixed m = mixed(box);
    std::array<Interval, 3> all = levels_[m.first]->gradient_range(box);
    for (std::size_t k = m.first + 1; k <= m.last; ++k) {
        const std::array<Interval, 3> own = levels_[k]->gradient_range(box);
        for (std::size_t a = 0; a < 3; ++a) all[a] = Interval::hull(all[a], own[a]);
    }
    const double by_weight = product(m.slope, m.apart) * (1.0 + kRounding);
    for (Interval& g : all) g = {g.lo - by_weight, g.hi + by_weight};
    return all;
}

double DetailField::curvature_bound(const Box3d& box) const
{
    const Mixed m = mixed(box);
    double most = 0.0, steepest = 0.0;
    for (std::size_t k = m.first; k <= m.last; ++k) {
        most = std::max(most, levels_[k]->curvature_bound(box));
        steepest = std::max(steepest, length(levels_[k]->gradient_range(box)));
    }
    return (most + product(2.0 * m.slope, 2.0 * steepest) + product(m.curve, m.apart)) * (1.0 + kRounding);
}

}  // namespace hoodoo
