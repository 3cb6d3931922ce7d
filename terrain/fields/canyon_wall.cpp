// The canyon's walls: the line n = 0 of a noise in the plan, carried along the noise's own gradient for the time T(z) (Gamito2001, section 4.1).
// In metres, with cells of w metres, the flow of fields/flow.h takes the time w T. Public sign: the wall's value is -w F, F(x, y, z) = n(Psi_T(z)(x,
// y)). Derivatives: dF/dz = -|grad n(x0)|^2 T' for the true flow; here that of the discrete one, by bounds of dPsi/dT and, for the normal, by
// differences in T (1e-6 of it is exact to 1e-9). Sediment: F + k ramp((zs - z)/h); the ramp is 0, then u^2 / (2 b), then u - b / 2, b = 0.05: the
// paper's linear slope with a rounded upper edge (a kink would leave the second derivative without bound). Bounds: inverse_bound over the box's plan
// and T's range, the noise's own derivatives over where that leads; upright parts by the chain rule, first order in T' and with T''.
#include "terrain/fields/canyon.h"

#include "terrain/math/noise_hessian.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

constexpr double kBlend = 0.05;       ///< of the sediment's upper edge, a share of the height
constexpr double kDifference = 1e-8;  ///< rounding of a difference of two noises over a step of 1e-6, a cell from the origin

double length2(double x, double y)
{
    return std::sqrt(x * x + y * y);
}

}  // namespace

CanyonWall::CanyonWall(const CanyonShape& shape)
    : shape_(shape),
      profile_(shape),
      warp_(noise_gradient_flow(shape.origin, shape.cell, shape.seed), profile_.most() * shape.cell, profile_.usual() * shape.cell)
{
}

double CanyonWall::ramp(double z, double* slope, double* curve) const
{
    const double u = shape_.sediment_height - (z - shape_.origin.z) / shape_.height, k = shape_.sediment;
    const double s = u <= 0.0 ? 0.0 : u < kBlend ? u / kBlend : 1.0;
    if (slope) *slope = -k * s / shape_.height;
    if (curve) *curve = u > 0.0 && u < kBlend ? k / (kBlend * shape_.height * shape_.height) : 0.0;
    return u <= 0.0 ? 0.0 : u < kBlend ? 0.5 * k * u * u / kBlend : k * (u - 0.5 * kBlend);
}

double CanyonWall::noise(const Vec2d& q, Vec2d* gradient) const
{
    const Noise2 n = gradient_noise((q - Vec2d(shape_.origin.x, shape_.origin.y)) * (1.0 / shape_.cell), shape_.seed);
    if (gradient) *gradient = n.gradient;
    return n.value;
}

Vec2d CanyonWall::carried(const Vec2d& q, double t) const
{
    const Vec3d x = warp_.inverse(Vec3d(q.x, q.y, 0.0), t * shape_.cell);
    return {x.x, x.y};
}

Vec3d CanyonWall::inverse(const Vec3d& p) const
{
    const Vec2d q = carried(Vec2d(p.x, p.y), profile_.at(p).t);
    return {q.x, q.y, p.z};
}

double CanyonWall::base_value(const Vec3d& q) const
{
    return -shape_.cell * (noise(Vec2d(q.x, q.y), nullptr) + ramp(q.z, nullptr, nullptr));
}

double CanyonWall::value(const Vec3d& p) const
{
    return base_value(inverse(p));
}

int CanyonWall::certain_sign(const Vec3d& p, double margin) const
{
    // Each step of the discrete flow goes no farther than its length at the noise's steepest slope G, on which the noise changes by G as much.
    const double here = base_value(p), most = shape_.cell * kNoise2Derivatives.slope * kNoise2Derivatives.slope * std::abs(profile_.at(p).t);
    const double rest = std::abs(here) - most - margin - 1e-12 * shape_.cell;
    return rest > 0.0 ? (here > 0.0 ? 1 : -1) : 0;
}

Vec3d CanyonWall::gradient(const Vec3d& p) const
{
    const CanyonProfile::Value t = profile_.at(p);
    const Carried at = warp_.inverse_with_jacobian(Vec3d(p.x, p.y, 0.0), t.t * shape_.cell);
    Vec2d g;
    noise(Vec2d(at.point.x, at.point.y), &g);
    const Vec3d across = apply_transposed(at.jacobian, Vec3d(g.x, g.y, 0.0));
    // How the value changes with T, by central differences: the discrete map is a polynomial in it, locally.
    const double h = 1e-6;
    const double by_t =
        shape_.cell * (noise(carried(Vec2d(p.x, p.y), t.t + h), nullptr) - noise(carried(Vec2d(p.x, p.y), t.t - h), nullptr)) / (2.0 * h);
    double slope = 0.0;
    ramp(p.z, &slope, nullptr);
    Vec3d sum(across.x - by_t * t.by_height * t.lift_gradient.x, across.y - by_t * t.by_height * t.lift_gradient.y,
              by_t * t.by_height + shape_.cell * slope);
    if (shape_.view) {
        const Vec3d from = p - shape_.view->eye;
        if (from.length() > 0.0) sum += from.normalized() * (by_t * t.by_distance);
    }
    return -sum;
}

void CanyonWall::prepare(const Box3d& domain)
{
    const double w = shape_.cell;
    lanes_ = {};
    lanes_.steps = warp_.steps();
    lanes_.speed = kNoise2Derivatives.slope;
    lanes_.reach = profile_.most() * lanes_.speed;
    const double lift = CanyonLift::bound(shape_).value / shape_.height;
    lanes_.z_lo = -0.05 - 2.0 * lift, lanes_.z_hi = 1.05 + 2.0 * lift;
    const auto lattice = [&](double cell, double reach, std::uint32_t seed) {
        CanyonLanes::Lattice l;
        const auto low = [&](double x, double o) { return std::floor((x - o) / cell - reach) - 1.0; };
        l.x0 = low(domain.min.x, shape_.origin.x);
        l.y0 = low(domain.min.y, shape_.origin.y);
        l.nx = static_cast<std::int64_t>(std::ceil((domain.max.x - shape_.origin.x) / cell + reach) + 3.0 - l.x0);
        l.ny = static_cast<std::int64_t>(std::ceil((domain.max.y - shape_.origin.y) / cell + reach) + 3.0 - l.y0);
        for (std::int64_t j = 0; j < l.ny; ++j) {
            for (std::int64_t i = 0; i < l.nx; ++i) {
                // At a lattice point the noise's gradient is that of its own plane.
                const Vec2d g = gradient_noise(Vec2d(l.x0 + static_cast<double>(i), l.y0 + static_cast<double>(j)), seed).gradient;
                l.gradient_x.push_back(g.x);
                l.gradient_y.push_back(g.y);
            }
        }
        return l;
    };
    lanes_.plan = lattice(w, lanes_.reach, shape_.seed);
    if (shape_.lift != 0.0) {
        lanes_.lift = lattice(w * shape_.lift_wavelength, (lanes_.reach + 3.0) / shape_.lift_wavelength, lift_seed(shape_));
        lanes_.lift_amplitude = shape_.lift, lanes_.lift_frequency = 1.0 / shape_.lift_wavelength;
    }
    double a = shape_.amplitude, f = shape_.frequency;
    for (int k = 0; k < shape_.octaves; ++k, a *= 0.5, f *= 2.0) {
        CanyonLanes::Octave octave;
        octave.frequency = f, octave.shift = 17.3 * k, octave.amplitude = a;
        if (shape_.view) octave.fade = shape_.view->spread * w * f * 4.0 / shape_.height;
        octave.first = std::floor(f * lanes_.z_lo + octave.shift);
        for (double x = octave.first, end = f * lanes_.z_hi + octave.shift + 2.0; x <= end; x += 1.0)
            octave.slopes.push_back(gradient_noise(x, shape_.profile_seed + static_cast<std::uint32_t>(k)).slope);
        lanes_.octaves.push_back(std::move(octave));
    }
}

void CanyonWall::values(const Vec3d (&p)[CanyonLanes::count], double* out) const
{
    CanyonPoints at;
    const CanyonLanes::Lattice& plan = lanes_.plan;
    const double room = lanes_.lift_amplitude * kNoise2Bound.value;
    bool known = plan.nx > 0;
    const double x1 = plan.x0 + static_cast<double>(plan.nx) - 2.0, y1 = plan.y0 + static_cast<double>(plan.ny) - 2.0;
    for (int i = 0; i < CanyonLanes::count; ++i) {
        const Vec3d q = p[i] - shape_.origin;
        at.x[i] = q.x / shape_.cell, at.y[i] = q.y / shape_.cell, at.z[i] = q.z / shape_.height;
        at.distance[i] = shape_.view ? (p[i] - shape_.view->eye).length() / shape_.cell : 0.0;
        known = known && at.z[i] - room >= lanes_.z_lo && at.z[i] + room <= lanes_.z_hi && at.x[i] - lanes_.reach >= plan.x0 &&
                at.x[i] + lanes_.reach <= x1 && at.y[i] - lanes_.reach >= plan.y0 && at.y[i] + lanes_.reach <= y1;
    }
    if (!known) {
        for (int i = 0; i < CanyonLanes::count; ++i) out[i] = value(p[i]);
        return;
    }
    canyon_noise(lanes_, at, out);
    for (int i = 0; i < CanyonLanes::count; ++i) out[i] = -shape_.cell * (out[i] + ramp(p[i].z, nullptr, nullptr));
}

LocalField CanyonWall::local(const Box3d& box) const
{
    const double w = shape_.cell;
    const CanyonProfile::Range t = profile_.over(box);
    const Box3d plan(Vec3d(box.min.x, box.min.y, 0.0), Vec3d(box.max.x, box.max.y, 0.0));
    // A little wider than T: a difference is taken at the middle.
    constexpr double step = 1e-6;
    const InverseBound b = warp_.inverse_bound(plan, {(t.t.lo - step) * w, (t.t.hi + step) * w});
    const Vec3d half = plan.size() * 0.5;
    const double radius = half.length(), span = 0.5 * (t.t.hi - t.t.lo) * w, image = length2(b.half_image.x, b.half_image.y);
    Vec2d g;
    const double n = noise(Vec2d(b.image.x, b.image.y), &g);
    // In metres: w n has the gradient g and the Hessian H / w.
    const Vec2d at(b.image.x - shape_.origin.x, b.image.y - shape_.origin.y), by(b.half_image.x, b.half_image.y);
    const NoiseDerivativeBound near = noise_bound(Imath::Box2d((at - by) * (1.0 / w), (at + by) * (1.0 / w)), shape_.seed);
    const double bend = near.hessian / w, steepest = std::min(near.slope, g.length() + bend * image);
    const double across = bend * b.all.x * b.all.x + steepest * b.all.xx;
    const double mixed = bend * b.all.x * b.all.h + steepest * b.all.xh, timed = bend * b.all.h * b.all.h + steepest * b.all.hh;
    // d(wF) / d(wT): a difference at the middle, off by no more than half the step times the second derivative; and how far it turns from there.
    const double by_most = steepest * b.all.h, middle = 0.5 * (t.t.lo + t.t.hi);
    const Vec2d centre_of_plan(plan.center().x, plan.center().y);
    const double change = (noise(carried(centre_of_plan, middle + step), nullptr) - n) / step;
    const double off = mixed * radius + timed * (span + 0.5 * step * w) + kDifference * (1.0 + (plan.center() - shape_.origin).length() / w);
    const Interval by_time = Interval::common({change - off, change + off}, {-by_most, by_most});
    // T's own derivatives, times w: by height, and what the distance adds to that.
    const Interval by_height = t.by_height.scaled(w);
    const double aside = t.by_distance * w, upright = by_height.magnitude() + aside, sideways = by_height.magnitude() * t.lift.slope + aside;
    const double by_distance = by_time.magnitude() * aside;

    LocalField known;
    const Vec3d centre = apply_transposed(b.jacobian, Vec3d(g.x, g.y, 0.0));
    const double turn = across * radius + mixed * span, most = std::min(steepest * b.all.x, centre.length() + turn);
    const Interval climb = by_time * by_height;
    double plain = 0.5 * across * radius * radius + mixed * radius * span;
    for (int k = 0; k < 2; ++k) {
        // The sign turns: negative in rock. The lift takes away from the height.
        const Interval flat{std::max(-centre[k] - turn, -most) - by_distance, std::min(-centre[k] + turn, most) + by_distance};
        known.gradient[static_cast<std::size_t>(k)] = flat + climb * t.lift.gradient[static_cast<std::size_t>(k)];
        plain += std::abs(centre[k]) * half[k];
    }
    double low = 0.0, high = 0.0, curve = 0.0;
    const double lower = ramp(box.max.z, &high, nullptr), upper = ramp(box.min.z, &low, nullptr);
    const double u = shape_.sediment_height - (box.min.z - shape_.origin.z) / shape_.height, v = u - (box.max.z - box.min.z) / shape_.height;
    if (u > 0.0 && v < kBlend) curve = w * shape_.sediment / (kBlend * shape_.height * shape_.height);
    known.gradient[2] = -climb + Interval{w * std::min(-low, -high) - by_distance, w * std::max(-low, -high) + by_distance};
    known.centre = -w * (n + ramp(0.5 * (box.min.z + box.max.z), nullptr, nullptr));
    const double spread = std::min(plain, most * radius) + by_time.magnitude() * span;
    const double rounding = 1e-12 * (w + std::abs(box.min.x) + std::abs(box.min.y));
    known.value = {-w * (n + upper) - spread - rounding, -w * (n + lower) + spread + rounding};
    // d2F = F_xx + 2 F_xT dT + F_TT dT^2 + F_T d2T, with |dT| <= c sideways + s upright.
    const double pull = by_time.magnitude();
    known.curvature = across + 2.0 * mixed * sideways + timed * sideways * sideways + pull * t.across * w;
    known.mixed = mixed * upright + timed * sideways * upright + pull * t.mixed * w;
    known.upright = timed * upright * upright + pull * t.upright * w + curve;
    return known;
}

}  // namespace hoodoo
