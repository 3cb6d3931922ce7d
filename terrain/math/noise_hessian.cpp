// Second derivatives of gradient noise, by the product rule at each corner of the cell.
// Perlin2002 for the noise. n = sum_c w_c l_c, w_c a product of fades (fade'' = 120 t^3 - 180 t^2 + 60 t), l_c = g_c.(p - c) linear, so that
// D2 n = sum_c D2 w_c l_c + grad w_c g_c^T + g_c grad w_c^T.
// Bounds, as in noise.cpp: D^k n (u^k) = sum_c g_c.(D^k w_c (p - c) + k D^(k-1) w_c u) <= sum_c |...|, a closed form in (p, u) whose maximum was
// found numerically (many starts, then descent) and rounded up. The third derivative jumps at the cell's sides; the bound holds on either side.
// Bounds over a box: in each cell n = A + B u(x) + C u(y) + D u(x) u(y), u the fade and A to D linear in the point, so that every derivative is a sum
// of products of which each factor has an exact range; forms are bounded by their parts of one and of three (two) turns in the angle.
#include "terrain/math/noise_hessian.h"

#include "terrain/math/interval.h"

#include <initializer_list>
#include <numbers>

namespace hoodoo
{

namespace
{

/// One axis: cell index, place in the cell, and weight, slope, curvature of the lower and the upper corner.
struct Axis {
    std::uint32_t index = 0;
    double rest = 0.0;
    double w[2] = {1.0, 0.0}, d[2] = {0.0, 0.0}, e[2] = {0.0, 0.0};
};

Axis axis_of(double x)
{
    Axis a;
    if (!(std::abs(x) < 0x1p51)) return a;
    const double low = std::floor(x), t = x - low;
    a.index = static_cast<std::uint32_t>(static_cast<std::int64_t>(low));
    a.rest = t;
    const double fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0), slope = 30.0 * t * t * (t - 1.0) * (t - 1.0);
    const double curve = 60.0 * t * (t * (2.0 * t - 3.0) + 1.0);
    a.w[0] = 1.0 - fade, a.w[1] = fade;
    a.d[0] = -slope, a.d[1] = slope;
    a.e[0] = -curve, a.e[1] = curve;
    return a;
}

}  // namespace

NoiseJet2 noise_jet(const Vec2d& p, std::uint32_t seed)
{
    const Axis x = axis_of(p.x), y = axis_of(p.y);
    NoiseJet2 n;
    for (std::uint32_t j = 0; j < 2; ++j) {
        for (std::uint32_t i = 0; i < 2; ++i) {
            const Vec2d g = lattice_gradient(x.index + i, y.index + j, seed);
            const double gx = g.x, gy = g.y, l = gx * (x.rest - i) + gy * (y.rest - j);
            const double w = x.w[i] * y.w[j], wx = x.d[i] * y.w[j], wy = x.w[i] * y.d[j];
            n.value += w * l;
            n.gradient += Vec2d(wx * l + w * gx, wy * l + w * gy);
            n.xx += x.e[i] * y.w[j] * l + 2.0 * wx * gx;
            n.xy += x.d[i] * y.d[j] * l + wx * gy + wy * gx;
            n.yy += x.w[i] * y.e[j] * l + 2.0 * wy * gy;
        }
    }
    return n;
}

NoiseJet3 noise_jet(const Vec3d& p, std::uint32_t seed)
{
    const Axis x = axis_of(p.x), y = axis_of(p.y), z = axis_of(p.z);
    const std::uint32_t layer[2] = {lattice_hash(z.index, 0x9E3779B9u, seed), lattice_hash(z.index + 1, 0x9E3779B9u, seed)};
    NoiseJet3 n;
    for (std::uint32_t c = 0; c < 8; ++c) {
        const std::uint32_t i = c & 1u, j = (c >> 1) & 1u, k = c >> 2;
        const std::uint32_t h = lattice_hash(x.index + i, y.index + j, layer[k]);
        const double sx = 2.0 * static_cast<int>(h & 1023u) - 1023.0, sy = 2.0 * static_cast<int>((h >> 10) & 1023u) - 1023.0,
                     sz = 2.0 * static_cast<int>((h >> 20) & 1023u) - 1023.0;
        const Vec3d g = Vec3d(sx, sy, sz) * (1.0 / std::sqrt(sx * sx + sy * sy + sz * sz));
        const double l = g.x * (x.rest - i) + g.y * (y.rest - j) + g.z * (z.rest - k);
        const double w = x.w[i] * y.w[j] * z.w[k], wx = x.d[i] * y.w[j] * z.w[k], wy = x.w[i] * y.d[j] * z.w[k], wz = x.w[i] * y.w[j] * z.d[k];
        n.value += w * l;
        n.gradient += Vec3d(wx, wy, wz) * l + g * w;
        n.xx += x.e[i] * y.w[j] * z.w[k] * l + 2.0 * wx * g.x;
        n.yy += x.w[i] * y.e[j] * z.w[k] * l + 2.0 * wy * g.y;
        n.zz += x.w[i] * y.w[j] * z.e[k] * l + 2.0 * wz * g.z;
        n.xy += x.d[i] * y.d[j] * z.w[k] * l + wx * g.y + wy * g.x;
        n.xz += x.d[i] * y.w[j] * z.d[k] * l + wx * g.z + wz * g.x;
        n.yz += x.w[i] * y.d[j] * z.d[k] * l + wy * g.z + wz * g.y;
    }
    return n;
}

namespace
{

/// Ranges of the fade and of its first three derivatives over a span of [0, 1].
struct FadeRange {
    Interval u, d, e, f;

    explicit FadeRange(const Interval& t)
    {
        const auto over = [&](const auto& value, std::initializer_list<double> turns) {
            Interval r = Interval::hull({value(t.lo), value(t.lo)}, {value(t.hi), value(t.hi)});
            for (const double turn : turns)
                if (t.contains(turn)) r = Interval::hull(r, {value(turn), value(turn)});
            return r;
        };
        u = over([](double x) { return x * x * x * (x * (6.0 * x - 15.0) + 10.0); }, {});
        d = over([](double x) { return 30.0 * x * x * (1.0 - x) * (1.0 - x); }, {0.5});
        e = over([](double x) { return 60.0 * x * (x * (2.0 * x - 3.0) + 1.0); }, {0.5 - std::numbers::sqrt3 / 6.0, 0.5 + std::numbers::sqrt3 / 6.0});
        f = over([](double x) { return 60.0 * (6.0 * x * (x - 1.0) + 1.0); }, {0.5});
    }
};

double norm(const Interval& a, const Interval& b)
{
    return std::sqrt(a.magnitude() * a.magnitude() + b.magnitude() * b.magnitude());
}

/// Over a box within one cell, given by its lower corner.
NoiseDerivativeBound bound_in_cell(std::int64_t column, std::int64_t row, const Interval& x, const Interval& y, std::uint32_t seed)
{
    const auto i = static_cast<std::uint32_t>(column), j = static_cast<std::uint32_t>(row);
    const Vec2d g00 = lattice_gradient(i, j, seed), g10 = lattice_gradient(i + 1, j, seed), g01 = lattice_gradient(i, j + 1, seed),
                g11 = lattice_gradient(i + 1, j + 1, seed);
    const auto linear = [&](const Vec2d& slope, double c) { return x.scaled(slope.x) + y.scaled(slope.y) + Interval{c, c}; };
    const Vec2d a = g00, b = g10 - g00, c = g01 - g00, d = g00 - g10 - g01 + g11;
    const Interval B = linear(b, -g10.x), C = linear(c, -g01.y), D = linear(d, g10.x + g01.y - g11.x - g11.y);
    const FadeRange u(x), w(y);
    const auto number = [](double v) { return Interval{v, v}; };
    // Derivatives by x of B u and D u w have the factors m = B + D w and its own slope; by y the same of C and D.
    const Interval along = B + D * w.u, across = C + D * u.u;
    const Interval along_x = number(b.x) + w.u.scaled(d.x), across_y = number(c.y) + u.u.scaled(d.y);
    const Interval nx = number(a.x) + u.u.scaled(b.x) + w.u.scaled(c.x) + (u.u * w.u).scaled(d.x) + along * u.d;
    const Interval ny = number(a.y) + u.u.scaled(b.y) + w.u.scaled(c.y) + (u.u * w.u).scaled(d.y) + across * w.d;
    const Interval uw = u.d * w.d;
    const Interval xx = (along_x * u.d).scaled(2.0) + along * u.e, yy = (across_y * w.d).scaled(2.0) + across * w.e;
    const Interval xy = u.d * (number(b.y) + w.u.scaled(d.y)) + w.d * (number(c.x) + u.u.scaled(d.x)) + D * uw;
    const Interval xxx = (along_x * u.e).scaled(3.0) + along * u.f, yyy = (across_y * w.e).scaled(3.0) + across * w.f;
    const Interval xxy = uw.scaled(2.0 * d.x) + u.e * (number(b.y) + w.u.scaled(d.y)) + D * (u.e * w.d);
    const Interval xyy = uw.scaled(2.0 * d.y) + w.e * (number(c.x) + u.u.scaled(d.x)) + D * (u.d * w.e);
    NoiseDerivativeBound bound{};
    bound.slope = norm(nx, ny);
    bound.hessian = 0.5 * (xx + yy).magnitude() + norm((xx + -yy).scaled(0.5), xy);
    bound.third = 0.75 * norm(xxx + xyy, xxy + yyy) + 0.25 * norm(xxx + -xyy.scaled(3.0), xxy.scaled(3.0) + -yyy);
    return bound;
}

}  // namespace

NoiseDerivativeBound noise_bound(const Imath::Box2d& box, std::uint32_t seed)
{
    // Beyond a few cells their own gradients say no more than that they are unit vectors.
    if (!(box.max.x - box.min.x <= 2.0 && box.max.y - box.min.y <= 2.0 && std::abs(box.min.x) < 0x1p51 && std::abs(box.min.y) < 0x1p51))
        return kNoise2Derivatives;
    const auto cell = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    NoiseDerivativeBound most{};
    for (std::int64_t j = cell(box.min.y); j <= cell(box.max.y); ++j) {
        for (std::int64_t i = cell(box.min.x); i <= cell(box.max.x); ++i) {
            const auto part = [](double lo, double hi, std::int64_t k) {
                return Interval{std::max(lo - static_cast<double>(k), 0.0), std::min(hi - static_cast<double>(k), 1.0)};
            };
            const NoiseDerivativeBound here = bound_in_cell(i, j, part(box.min.x, box.max.x, i), part(box.min.y, box.max.y, j), seed);
            most.slope = std::max(most.slope, here.slope);
            most.hessian = std::max(most.hessian, here.hessian);
            most.third = std::max(most.third, here.third);
        }
    }
    constexpr double rounding = 1.0 + 1e-12;
    return {std::min(most.slope * rounding + 1e-12, kNoise2Derivatives.slope), std::min(most.hessian * rounding + 1e-11, kNoise2Derivatives.hessian),
            std::min(most.third * rounding + 1e-10, kNoise2Derivatives.third)};
}

double noise_curve_bound(double lo, double hi, std::uint32_t seed)
{
    if (!(hi - lo <= 1.0 && std::abs(lo) < 0x1p51)) return kNoise1Curve;
    double most = 0.0;
    for (double low = std::floor(lo); low <= hi; low += 1.0) {
        const Interval t{std::max(lo - low, 0.0), std::min(hi - low, 1.0)};
        const FadeRange u(t);
        // n = g0 t + u (g1 (t - 1) - g0 t), the slopes g being the noise's own at lattice points.
        const double g0 = gradient_noise(low, seed).slope, g1 = gradient_noise(low + 1.0, seed).slope;
        const Interval between = t.scaled(g1 - g0) + Interval{-g1, -g1};
        most = std::max(most, (u.d.scaled(2.0 * (g1 - g0)) + u.e * between).magnitude());
    }
    return std::min(most * (1.0 + 1e-12) + 1e-12, kNoise1Curve);
}

}  // namespace hoodoo
