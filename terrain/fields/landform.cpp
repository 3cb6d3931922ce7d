// The tree as a height, and nodes seen from elsewhere: warped and moved.
// A warp asks its node at q = p + d(p): with the derivative D of q, |D| <= 1 + |d'|, slopes are multiplied by |D| and curvatures become
// K |D|^2 + L |d''|; the image of an area lies in the box of its moved points and within |D| radius of the image of its point. A move is a
// similarity, exact in all bounds. Bounds of the whole tree are counted from the height at the middle of the area (Elevated), which makes differences
// small.
#include "terrain/fields/landform.h"

#include "terrain/error.h"

#include <cmath>

namespace hoodoo
{

namespace
{

class Warped final : public Landform
{
public:
    Warped(LandformPtr node, std::shared_ptr<const Height> x, std::shared_ptr<const Height> y)
        : node_(std::move(node)), x_(std::move(x)), y_(std::move(y))
    {
    }

    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        const Elevated<Jet2> there = node_->at(image(p), datum);
        const Vec2d gx = x_->gradient(p), gy = y_->gradient(p);
        const auto back = [&](const Jet2& jet) { return Jet2{jet.value, jet.gradient + gx * jet.gradient.x + gy * jet.gradient.y}; };
        return {back(there.height), back(there.weight), {}};
    }

    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        const HeightBounds x = x_->bounds(area.box), y = y_->bounds(area.box);
        const double stretch = 1.0 + std::hypot(x.slope, y.slope), bend = std::hypot(x.curvature, y.curvature);
        Area there{
            {area.box.min + Vec2d(x.value.lo, y.value.lo), area.box.max + Vec2d(x.value.hi, y.value.hi)}, image(area.at), stretch * area.radius};
        if (std::isfinite(there.radius)) {
            const double reach = there.radius * (1.0 + 0x1p-40);
            for (int k = 0; k < 2; ++k) {
                there.box.min[k] = std::max(there.box.min[k], there.at[k] - reach);
                there.box.max[k] = std::min(there.box.max[k], there.at[k] + reach);
            }
        }
        const Elevated<AreaJet> known = node_->over(there, datum);
        const Elevated<Jet2> here = at(area.at, datum);
        const auto back = [&](const AreaJet& jet, const Jet2& point) {
            AreaJet b = jet;
            for (std::size_t k = 0; k < 2; ++k) b.gradient[k] = jet.gradient[k] + jet.gradient[0] * x.gradient[k] + jet.gradient[1] * y.gradient[k];
            b.slope = jet.slope * stretch;
            b.curvature = jet.curvature == 0.0 && jet.slope == 0.0 ? 0.0 : jet.curvature * stretch * stretch + jet.slope * bend;
            b.at = point;
            b.radius = area.radius;
            b.size += jet.slope * (x.value.magnitude() + y.value.magnitude());
            return b.narrow();
        };
        return {back(known.height, here.height), back(known.weight, here.weight), known.heights};
    }

    Box2d support() const override
    {
        // p + d(p) in the node's support: p is within the largest d of it.
        const Box2d all(Vec2d(-kInfinity), Vec2d(kInfinity)), own = node_->support();
        const Interval x = x_->range(all), y = y_->range(all);
        return {own.min - Vec2d(x.hi, y.hi), own.max - Vec2d(x.lo, y.lo)};
    }
    double least_weight() const override { return node_->least_weight(); }
    double most_weight() const override { return node_->most_weight(); }
    std::uint64_t memory_bytes() const override { return node_->memory_bytes(); }

private:
    Vec2d image(const Vec2d& p) const { return p + Vec2d(x_->height(p), y_->height(p)); }

    LandformPtr node_;
    std::shared_ptr<const Height> x_, y_;
};

class Moved final : public Landform
{
public:
    Moved(LandformPtr node, double scale, double angle, const Vec3d& shift)
        : node_(std::move(node)), scale_(scale), cosine_(std::cos(angle)), sine_(std::sin(angle)), shift_(shift)
    {
    }

    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        const Elevated<Jet2> there = node_->at(back(p), below(datum));
        return {
            {there.height.value * scale_, turned(there.height.gradient)}, {there.weight.value, turned(there.weight.gradient) * (1.0 / scale_)}, {}};
    }

    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        const Box2d box = around(area.box, [&](const Vec2d& p) { return back(p); });
        const Elevated<AreaJet> there = node_->over({box, back(area.at), area.radius / scale_}, below(datum));
        const auto moved = [&](AreaJet jet, double by) {
            jet.value = jet.value.scaled(by);
            const Interval x = jet.gradient[0].scaled(by / scale_), y = jet.gradient[1].scaled(by / scale_);
            jet.gradient = {x.scaled(cosine_) + y.scaled(-sine_), x.scaled(sine_) + y.scaled(cosine_)};
            jet.slope *= by / scale_;
            jet.curvature *= by / (scale_ * scale_);
            jet.at = {jet.at.value * by, turned(jet.at.gradient) * (by / scale_)};
            jet.radius = area.radius;
            jet.size = jet.size * by + jet.slope * (std::abs(shift_.x) + std::abs(shift_.y));
            return jet.narrow();
        };
        return {moved(there.height, scale_), moved(there.weight, 1.0), there.heights.scaled(scale_)};
    }

    Box2d support() const override
    {
        return around(node_->support(), [&](const Vec2d& q) { return turned(q * scale_) + Vec2d(shift_.x, shift_.y); });
    }
    double least_weight() const override { return node_->least_weight(); }
    double most_weight() const override { return node_->most_weight(); }
    std::uint64_t memory_bytes() const override { return node_->memory_bytes(); }

private:
    Vec2d turned(const Vec2d& v) const { return {cosine_ * v.x - sine_ * v.y, sine_ * v.x + cosine_ * v.y}; }
    Vec2d back(const Vec2d& p) const
    {
        const Vec2d q = (p - Vec2d(shift_.x, shift_.y)) * (1.0 / scale_);
        return {cosine_ * q.x + sine_ * q.y, -sine_ * q.x + cosine_ * q.y};
    }
    double below(double datum) const { return (datum - shift_.z) / scale_; }

    /// A box around the images of a box's corners, rounded outwards; what is infinite stays so.
    template <class F>
    static Box2d around(const Box2d& box, const F& image)
    {
        for (int k = 0; k < 2; ++k)
            if (!std::isfinite(box.min[k]) || !std::isfinite(box.max[k])) return {Vec2d(-kInfinity), Vec2d(kInfinity)};
        Box2d out;
        for (int corner = 0; corner < 4; ++corner) {
            const Vec2d p = image({corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y});
            const double hair = 0x1p-48 * (std::abs(p.x) + std::abs(p.y) + box.size().length());
            out.extendBy(p - Vec2d(hair));
            out.extendBy(p + Vec2d(hair));
        }
        return out;
    }

    LandformPtr node_;
    double scale_, cosine_, sine_;
    Vec3d shift_;
};

}  // namespace

LandformPtr landform_warp(LandformPtr node, std::shared_ptr<const Height> shift_x, std::shared_ptr<const Height> shift_y)
{
    return std::make_shared<Warped>(std::move(node), std::move(shift_x), std::move(shift_y));
}

LandformPtr landform_move(LandformPtr node, double scale, double angle, const Vec3d& shift)
{
    return std::make_shared<Moved>(std::move(node), scale, angle, shift);
}

LandformHeight::LandformHeight(LandformPtr root) : root_(std::move(root))
{
    if (!root_->covers()) throw Error(ErrorKind::internal, "the root of landforms covers the plane");
}

HeightBounds LandformHeight::bounds(const Box2d& box) const
{
    const Area area = Area::of(box);
    const double datum = root_->at(area.at, 0.0).height.value;
    const AreaJet known = shifted(root_->over(area, datum).height, datum).widened();
    return {known.value, known.slope, known.curvature, known.gradient};
}

}  // namespace hoodoo
