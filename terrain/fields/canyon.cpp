// A canyon from a noise and its own gradient: rock where F(x, y, z) = n(Psi_T(z)(x, y)) > 0 below the plateau, and a floor.
// Gamito2001, section 4.1. The height is constant along the flow v = grad n(x, y), so at each height the walls are the line n = 0 carried for the
// time T(z), an fBm. In metres, with cells of w metres, the flow of fields/flow.h takes the time w T. Public sign: the wall's value is -w F, negative
// in rock. Derivatives: dF/dz = -|grad n(x0)|^2 T' for the true flow; here that of the discrete one, by bounds of dPsi/dT and, for the normal, by
// differences in T (1e-6 of it is exact to 1e-9). Sediment: F + k ramp((zs - z)/h); the ramp is 0, then u^2 / (2 b), then u - b / 2, b = 0.05: the
// paper's linear slope with a rounded upper edge (a kink would leave the second derivative without bound). Floor: height floor_amplitude (1 + fBm of
// 3 octaves). Bounds of the wall: inverse_bound over the box's plan and T's range; upright parts by the chain rule, first order in T' and with T'' by
// octaves: |n1'| <= 1.3472, |n1''| <= 7.5, each octave's value and slope over a span from those at its middle. Level of detail: octave k fades as the
// pixel's width grows from 1/4 to 1/2 of its wavelength; a function of the point's distance alone, so that shadow rays and camera rays meet the same
// surface.
#include "terrain/fields/canyon.h"

#include "terrain/math/noise_hessian.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

constexpr double kBlend = 0.05;  ///< of the sediment's upper edge, a share of the height

double length2(double x, double y)
{
    return std::sqrt(x * x + y * y);
}

/// Nearest and farthest distance of a box's points from `p`.
Interval distances(const Box3d& box, const Vec3d& p)
{
    double near = 0.0, far = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double d = std::max({0.0, box.min[k] - p[k], p[k] - box.max[k]});
        const double e = std::max(std::abs(box.min[k] - p[k]), std::abs(box.max[k] - p[k]));
        near += d * d;
        far += e * e;
    }
    return {std::sqrt(near), std::sqrt(far)};
}

}  // namespace

// -- The profile -----------------------------------------------------------------------------------------------------------

/// Of octave k at a distance from the eye: 1 where a pixel is narrower than a quarter of its wavelength, 0 from a half on.
double CanyonProfile::weight(int octave, double distance, double* slope) const
{
    if (slope) *slope = 0.0;
    if (!shape_.view) return 1.0;
    const double wavelength = shape_.height / (shape_.frequency * std::exp2(octave));
    const double per_metre = shape_.view->spread / (0.25 * wavelength), u = std::clamp(distance * per_metre - 1.0, 0.0, 1.0);
    if (slope) *slope = -6.0 * u * (1.0 - u) * per_metre;
    return 1.0 - u * u * (3.0 - 2.0 * u);
}

CanyonProfile::Value CanyonProfile::at(const Vec3d& p) const
{
    const double z = (p.z - shape_.origin.z) / shape_.height;
    const double distance = shape_.view ? (p - shape_.view->eye).length() : 0.0;
    Value v;
    double a = shape_.amplitude, f = shape_.frequency;
    for (int k = 0; k < shape_.octaves; ++k, a *= 0.5, f *= 2.0) {
        double slope = 0.0;
        const double w = weight(k, distance, &slope);
        if (w == 0.0 && slope == 0.0) break;
        const Noise1 n = gradient_noise(f * z + 17.3 * k, shape_.profile_seed + static_cast<std::uint32_t>(k));
        v.t += w * a * n.value;
        v.by_height += w * a * f * n.slope / shape_.height;
        v.by_distance += slope * a * n.value;
    }
    return v;
}

CanyonProfile::Range CanyonProfile::over(const Box3d& box) const
{
    const double z0 = (box.min.z - shape_.origin.z) / shape_.height, z1 = (box.max.z - shape_.origin.z) / shape_.height;
    const double middle = 0.5 * (z0 + z1), half = 0.5 * (z1 - z0);
    const Interval far = shape_.view ? distances(box, shape_.view->eye) : Interval{0.0, 0.0};
    Range r;
    double a = shape_.amplitude, f = shape_.frequency;
    for (int k = 0; k < shape_.octaves; ++k, a *= 0.5, f *= 2.0) {
        const Interval w{weight(k, far.hi, nullptr), weight(k, far.lo, nullptr)};
        if (w.hi == 0.0) break;
        const std::uint32_t seed = shape_.profile_seed + static_cast<std::uint32_t>(k);
        const double curve = noise_curve_bound(f * z0 + 17.3 * k, f * z1 + 17.3 * k, seed), reach = f * half, bend = curve * reach;
        const Noise1 n = gradient_noise(f * middle + 17.3 * k, seed);
        const Interval slope{std::max(n.slope - bend, -kNoise1Bound.slope), std::min(n.slope + bend, kNoise1Bound.slope)};
        const double rise = std::min(slope.magnitude(), std::abs(n.slope) + 0.5 * bend) * reach;
        const Interval value{std::max(n.value - rise, -kNoise1Bound.value), std::min(n.value + rise, kNoise1Bound.value)};
        const Interval t = Interval::hull(value.scaled(w.lo), value.scaled(w.hi)), d = Interval::hull(slope.scaled(w.lo), slope.scaled(w.hi));
        r.t = r.t + t.scaled(a);
        r.by_height = r.by_height + d.scaled(a * f / shape_.height);
        r.upright += w.hi * a * f * f * curve / (shape_.height * shape_.height);
        if (!shape_.view || w.lo == 1.0) continue;
        // |w'| <= 1.5 s, |w''| <= 6 s^2 with s the inverse of the fade's width, which begins at the distance 1 / s.
        const double s = shape_.view->spread * f * 4.0 / shape_.height;
        const double size = value.magnitude();
        r.by_distance += 1.5 * s * a * size;
        r.rest += a * (2.0 * 1.5 * s * f / shape_.height * slope.magnitude() + (6.0 * s * s + 1.5 * s * s) * size);
    }
    return r;
}

double CanyonProfile::most() const
{
    return shape_.amplitude * kNoise1Bound.value * (2.0 - std::exp2(1.0 - shape_.octaves));
}

double CanyonProfile::usual() const
{
    // 256 slices: of the first octaves less than a tenth of a wavelength each, and the weights of a distance may be any.
    constexpr int slices = 256;
    CanyonShape flat = shape_;
    flat.view.reset();
    const CanyonProfile plain(flat);
    double most = 0.0;
    for (int k = 0; k < slices; ++k) {
        const double lo = static_cast<double>(k) / slices, hi = static_cast<double>(k + 1) / slices;
        most = std::max(
            most, plain.over(Box3d(shape_.origin + Vec3d(0, 0, lo * shape_.height), shape_.origin + Vec3d(0, 0, hi * shape_.height))).t.magnitude());
    }
    return std::min(most, this->most());
}

// -- The walls ---------------------------------------------------------------------------------------------------------------

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
    Vec3d sum(across.x, across.y, by_t * t.by_height + shape_.cell * slope);
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
    lanes_.z_lo = -0.05, lanes_.z_hi = 1.05;
    const auto low = [&](double x, double o) { return std::floor((x - o) / w - lanes_.reach) - 1.0; };
    lanes_.x0 = low(domain.min.x, shape_.origin.x);
    lanes_.y0 = low(domain.min.y, shape_.origin.y);
    lanes_.nx = static_cast<std::int64_t>(std::ceil((domain.max.x - shape_.origin.x) / w + lanes_.reach) + 3.0 - lanes_.x0);
    lanes_.ny = static_cast<std::int64_t>(std::ceil((domain.max.y - shape_.origin.y) / w + lanes_.reach) + 3.0 - lanes_.y0);
    for (std::int64_t j = 0; j < lanes_.ny; ++j) {
        for (std::int64_t i = 0; i < lanes_.nx; ++i) {
            // At a lattice point the noise's gradient is that of its own plane.
            const Vec2d g = gradient_noise(Vec2d(lanes_.x0 + static_cast<double>(i), lanes_.y0 + static_cast<double>(j)), shape_.seed).gradient;
            lanes_.gradient_x.push_back(g.x);
            lanes_.gradient_y.push_back(g.y);
        }
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
    bool known = lanes_.nx > 0;
    const double x1 = lanes_.x0 + static_cast<double>(lanes_.nx) - 2.0, y1 = lanes_.y0 + static_cast<double>(lanes_.ny) - 2.0;
    for (int i = 0; i < CanyonLanes::count; ++i) {
        const Vec3d q = p[i] - shape_.origin;
        at.x[i] = q.x / shape_.cell, at.y[i] = q.y / shape_.cell, at.z[i] = q.z / shape_.height;
        at.distance[i] = shape_.view ? (p[i] - shape_.view->eye).length() / shape_.cell : 0.0;
        known = known && at.z[i] >= lanes_.z_lo && at.z[i] <= lanes_.z_hi && at.x[i] - lanes_.reach >= lanes_.x0 && at.x[i] + lanes_.reach <= x1 &&
                at.y[i] - lanes_.reach >= lanes_.y0 && at.y[i] + lanes_.reach <= y1;
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
    const InverseBound b = warp_.inverse_bound(plan, {t.t.lo * w, t.t.hi * w});
    const Vec3d half = plan.size() * 0.5;
    const double radius = half.length(), span = 0.5 * (t.t.hi - t.t.lo) * w, image = length2(b.half_image.x, b.half_image.y);
    Vec2d g;
    const double n = noise(Vec2d(b.image.x, b.image.y), &g);
    // In metres: w n has the gradient g and the Hessian H / w.
    const Vec2d at(b.image.x - shape_.origin.x, b.image.y - shape_.origin.y), by(b.half_image.x, b.half_image.y);
    const NoiseDerivativeBound near = noise_bound(Imath::Box2d((at - by) * (1.0 / w), (at + by) * (1.0 / w)), shape_.seed);
    const double bend = near.hessian / w, steepest = std::min(near.slope, g.length() + bend * image);
    const double across = bend * b.all.x * b.all.x + steepest * b.all.xx;
    const double by_time = steepest * b.all.h;  // |d(wF) / d(wT)|
    const double mixed = bend * b.all.x * b.all.h + steepest * b.all.xh, timed = bend * b.all.h * b.all.h + steepest * b.all.hh;
    const double slope_t = t.by_height.magnitude() * w;  // |d(wT) / dz|

    LocalField known;
    const Vec3d centre = apply_transposed(b.jacobian, Vec3d(g.x, g.y, 0.0));
    const double turn = across * radius + mixed * span, most = std::min(steepest * b.all.x, centre.length() + turn),
                 aside = by_time * t.by_distance * w;
    double plain = 0.5 * across * radius * radius + mixed * radius * span;
    for (int k = 0; k < 2; ++k) {
        // The sign turns: negative in rock.
        known.gradient[static_cast<std::size_t>(k)] = {std::max(-centre[k] - turn, -most) - aside, std::min(-centre[k] + turn, most) + aside};
        plain += std::abs(centre[k]) * half[k];
    }
    double low = 0.0, high = 0.0, curve = 0.0;
    const double lower = ramp(box.max.z, &high, nullptr), upper = ramp(box.min.z, &low, nullptr);
    const double u = shape_.sediment_height - (box.min.z - shape_.origin.z) / shape_.height, v = u - (box.max.z - box.min.z) / shape_.height;
    if (u > 0.0 && v < kBlend) curve = w * shape_.sediment / (kBlend * shape_.height * shape_.height);
    // By height: |dF/dT| T', where dF/dT of the true flow is never positive; of the discrete one, either.
    const double z = by_time * slope_t + aside;
    known.gradient[2] = {-z + w * std::min(-low, -high), z + w * std::max(-low, -high)};
    known.centre = -w * (n + ramp(0.5 * (box.min.z + box.max.z), nullptr, nullptr));
    const double spread = std::min(plain, most * radius) + by_time * span;
    const double rounding = 1e-12 * (w + std::abs(box.min.x) + std::abs(box.min.y));
    known.value = {-w * (n + upper) - spread - rounding, -w * (n + lower) + spread + rounding};
    known.curvature = across + 2.0 * mixed * t.by_distance * w + timed * t.by_distance * w * t.by_distance * w + by_time * t.rest * w;
    known.mixed = mixed * slope_t + timed * slope_t * t.by_distance * w + by_time * t.rest * w;
    known.upright = timed * slope_t * slope_t + by_time * (t.upright + t.rest) * w + curve + known.mixed * t.by_distance * w;
    return known;
}

// -- The whole -----------------------------------------------------------------------------------------------------------------

CanyonField::CanyonField(const CanyonShape& shape) : shape_(shape), wall_(shape) {}

namespace
{

const Fractal kFloor{3.0, 2.0, 0.5};

}  // namespace

double CanyonField::floor(const Vec3d& p) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    const Noise2 n = fbm(Vec2d(p.x - shape_.origin.x, p.y - shape_.origin.y) * (1.0 / w), shape_.seed + 101u, kFloor);
    return p.z - shape_.origin.z - a * (1.0 + n.value);
}

Vec3d CanyonField::floor_gradient(const Vec3d& p) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    const Noise2 n = fbm(Vec2d(p.x - shape_.origin.x, p.y - shape_.origin.y) * (1.0 / w), shape_.seed + 101u, kFloor);
    return {-a / w * n.gradient.x, -a / w * n.gradient.y, 1.0};
}

LocalField CanyonField::floor_local(const Box3d& box) const
{
    const double w = shape_.floor_wavelength * shape_.cell, a = shape_.floor_amplitude * shape_.height;
    // Three octaves: slopes add (2 x 0.5)^k, second derivatives (4 x 0.5)^k.
    const double slope = a / w * 3.0 * kNoise2Derivatives.slope, curve = a / (w * w) * 7.0 * kNoise2Derivatives.hessian;
    const Vec3d half = box.size() * 0.5, g = floor_gradient(box.center());
    const double radius = length2(half.x, half.y), turn = curve * radius, f = floor(box.center());
    LocalField known;
    for (int k = 0; k < 2; ++k) known.gradient[static_cast<std::size_t>(k)] = {std::max(g[k] - turn, -slope), std::min(g[k] + turn, slope)};
    known.gradient[2] = {1.0, 1.0};
    const double linear = std::abs(g.x) * half.x + std::abs(g.y) * half.y + 0.5 * curve * radius * radius;
    const double reach = std::min({linear, slope * radius, a * 1.75 * kNoise2Bound.value * 2.0}) + half.z + 1e-12 * shape_.cell;
    known.centre = f;
    known.value = {f - reach, f + reach};
    known.curvature = curve;
    known.mixed = known.upright = 0.0;
    return known;
}

LocalField CanyonField::plateau_local(const Box3d& box) const
{
    LocalField known;
    known.value = {plateau(box.min), plateau(box.max)};
    known.centre = plateau(box.center());
    known.gradient = {Interval{0.0, 0.0}, Interval{0.0, 0.0}, Interval{1.0, 1.0}};
    known.curvature = known.mixed = known.upright = 0.0;
    return known;
}

double CanyonField::value(const Vec3d& p) const
{
    const double top = plateau(p), ground = floor(p);
    // The walls need not be asked where the answer cannot depend on them.
    if (top >= ground) return ground;
    return std::min(ground, std::max(top, wall_.value(p)));
}

Vec3d CanyonField::gradient(const Vec3d& p) const
{
    const double top = plateau(p), ground = floor(p);
    if (top >= ground) return floor_gradient(p);
    const double wall = wall_.value(p);
    if (ground <= std::max(top, wall)) return floor_gradient(p);
    return top >= wall ? Vec3d(0.0, 0.0, 1.0) : wall_.gradient(p);
}

namespace
{

/// Of the parts that can be the value somewhere in the box.
struct Parts {
    LocalField wall, top, ground;
    bool has_wall, has_top, has_ground;
    Interval value;
};

Parts parts_of(const CanyonField& field, const Box3d& box)
{
    Parts p{field.wall().local(box), field.plateau_local(box), field.floor_local(box), true, true, true, {}};
    const Interval rock{std::max(p.wall.value.lo, p.top.value.lo), std::max(p.wall.value.hi, p.top.value.hi)};
    p.value = {std::min(rock.lo, p.ground.value.lo), std::min(rock.hi, p.ground.value.hi)};
    p.has_ground = p.ground.value.lo <= rock.hi;
    const bool has_rock = rock.lo <= p.ground.value.hi;
    p.has_wall = has_rock && p.wall.value.hi >= p.top.value.lo;
    p.has_top = has_rock && p.top.value.hi >= p.wall.value.lo;
    return p;
}

}  // namespace

double CanyonField::slope_bound(const Segment& segment) const
{
    const Vec3d along = segment.b - segment.a;
    const double length = along.length();
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const Parts p = parts_of(*this, box);
    double most = 0.0;
    for (const auto& [used, part] : {std::pair{p.has_wall, &p.wall}, std::pair{p.has_top, &p.top}, std::pair{p.has_ground, &p.ground}})
        if (used) most = std::max(most, length > 0.0 ? part->slope_along(along / length) : part->slope());
    return most * (1.0 + 1e-12);
}

Interval CanyonField::range(const Box3d& box) const
{
    return parts_of(*this, box).value;
}

Box3d CanyonField::bounds() const
{
    const Vec3d& o = shape_.origin;
    return {Vec3d(-kInfinity), Vec3d(kInfinity, kInfinity, o.z + shape_.height * std::max(1.0, shape_.floor_amplitude * 2.3))};
}

std::array<Interval, 3> CanyonField::gradient_range(const Box3d& box) const
{
    const Parts p = parts_of(*this, box);
    std::array<Interval, 3> hull{Interval{kInfinity, -kInfinity}, Interval{kInfinity, -kInfinity}, Interval{kInfinity, -kInfinity}};
    for (const auto& [used, part] : {std::pair{p.has_wall, &p.wall}, std::pair{p.has_top, &p.top}, std::pair{p.has_ground, &p.ground}})
        if (used)
            for (std::size_t k = 0; k < 3; ++k) hull[k] = Interval::hull(hull[k], part->gradient[k]);
    return hull;
}

}  // namespace hoodoo
