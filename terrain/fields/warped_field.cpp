// A base field seen through an inverse warp: F = s0 o Psi, grad F = J^T grad s0, with bounds from those of base and warp.
// Gamito2001, section 3. With g = grad s0 over the image of the box, J = D Psi at the centre, |D2 Psi| <= B, |D Psi| <= A:
//   component k of grad F lies in sum_i J[i][k] g_i +- |g| B r                          for any base, kinks included;
//   where s0 has a curvature bound H, grad F has one: K = H A^2 + |g| B, and grad F lies within K r of its value at the centre;
//   F lies in s0's range over the image, in F(c) +- sum_k |dF_k| h_k, and in F(c) +- (sum_k |dF(c)_k| h_k + K r^2 / 2).
// A span of durations adds what the time derivative |g| |dPsi/dT| allows.
#include "terrain/fields/warped_field.h"

#include "terrain/fields/blob_node.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

/// Of two computations of one value, relative to what the numbers involved are.
constexpr double kRounding = 1e-12;

/// 0 times infinity is 0 here: what has no extent adds nothing.
double product(double a, double b)
{
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

double length(const std::array<Interval, 3>& g)
{
    return std::sqrt(g[0].magnitude() * g[0].magnitude() + g[1].magnitude() * g[1].magnitude() + g[2].magnitude() * g[2].magnitude());
}

}  // namespace

double LocalField::slope() const
{
    return length(gradient);
}

double LocalField::slope_along(const Vec3d& unit) const
{
    Interval sum{0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
        if (unit[k] != 0.0) sum = sum + gradient[static_cast<std::size_t>(k)].scaled(unit[k]);
    }
    return sum.magnitude();
}

double LocalField::curvature_along(double curvature, double mixed, double upright, const Vec3d& unit)
{
    const double s = std::abs(unit.z), c = std::sqrt(std::max(0.0, 1.0 - s * s));
    return product(curvature, c * c) + 2.0 * product(mixed, c * s) + product(upright, s * s);
}

WarpedField::WarpedField(std::shared_ptr<const Field> base, Warp warp, double duration)
    : base_(std::move(base)),
      inner_(dynamic_cast<const WarpedField*>(base_.get())),
      blob_(dynamic_cast<const BlobNode*>(base_.get())),
      warp_(std::move(warp)),
      duration_(duration)
{
}

Vec3d WarpedField::gradient(const Vec3d& p, double duration) const
{
    const Carried at = warp_.inverse_with_jacobian(p, duration);
    return apply_transposed(at.jacobian, base_->gradient(at.point));
}

LocalField WarpedField::base_local(const Box3d& box) const
{
    if (inner_) return inner_->local(box, {inner_->duration_, inner_->duration_});
    if (blob_) return blob_->local(box);
    const double bend = base_->curvature_bound(box);
    return {base_->range(box), 0.0, base_->gradient_range(box), bend, 0.0, bend};
}

LocalField WarpedField::local(const Box3d& box, const Interval& durations, Box3d* where) const
{
    const Vec3d half = box.size() * 0.5;
    const double radius = half.length(), span = 0.5 * (durations.hi - durations.lo);
    const InverseBound warp = warp_.inverse_bound(box, durations);
    const Box3d image(warp.image - warp.half_image, warp.image + warp.half_image);
    if (where) *where = image;
    const LocalField base = base_local(image);
    const std::array<Interval, 3>& g = base.gradient;
    const double steepest = length(g), bend = base.curvature;
    const double centre = base_->value(warp.image), rounding = kRounding * (1.0 + std::abs(centre));

    LocalField local;
    local.centre = centre;
    const double turned = product(steepest, product(warp.all.xx, radius) + product(warp.all.xh, span));
    for (int k = 0; k < 3; ++k) {
        Interval sum{-turned, turned};
        for (int i = 0; i < 3; ++i) {
            if (warp.jacobian[i][k] != 0.0) sum = sum + g[static_cast<std::size_t>(i)].scaled(warp.jacobian[i][k]);
        }
        // However the warp bends, no component is longer than the whole gradient can be.
        const double most = product(steepest, warp.all.x);
        local.gradient[static_cast<std::size_t>(k)] = Interval::common(sum, {-most, most});
    }
    const double moved = product(product(steepest, warp.all.h), span);
    double straight = 0.0;
    for (int k = 0; k < 3; ++k) straight += product((local.gradient[static_cast<std::size_t>(k)]).magnitude(), half[k]);
    double reach = straight + moved;
    if (std::isfinite(bend) && warp.all.xx < 1e20) {
        const Vec3d at_centre = apply_transposed(warp.jacobian, base_->gradient(warp.image));
        local.curvature = bend * warp.all.x * warp.all.x + product(steepest, warp.all.xx);
        local.upright = local.curvature;
        const double turn = local.curvature * radius + product(bend * warp.all.x * warp.all.h + product(steepest, warp.all.xh), span);
        double linear = 0.5 * local.curvature * radius * radius + moved;
        for (int k = 0; k < 3; ++k) {
            Interval& component = local.gradient[static_cast<std::size_t>(k)];
            component = Interval::common(component, {at_centre[k] - turn - rounding, at_centre[k] + turn + rounding});
            linear += std::abs(at_centre[k]) * half[k];
        }
        // The linear part is taken at the middle of the span.
        linear += product(bend * warp.all.x * warp.all.h + product(steepest, warp.all.xh), span * radius);
        reach = std::min(reach, linear);
    }
    local.value = Interval::common(base.value, {centre - reach, centre + reach});
    local.value = {local.value.lo - rounding, local.value.hi + rounding};
    return local;
}

double WarpedField::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length();
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const LocalField known = local(box, {duration_, duration_});
    return (length > 0.0 ? known.slope_along(along / length) : known.slope()) * (1.0 + kRounding);
}

Interval WarpedField::range(const Box3d& box) const
{
    return local(box, {duration_, duration_}).value;
}

Box3d WarpedField::bounds() const
{
    Box3d box = base_->bounds();
    const double reach = warp_.reach(box);
    return {box.min - Vec3d(reach), box.max + Vec3d(reach)};
}

}  // namespace hoodoo
