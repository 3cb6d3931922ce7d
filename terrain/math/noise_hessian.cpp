// Second derivatives of gradient noise, by the product rule at each corner of the cell.
// Perlin2002 for the noise. n = sum_c w_c l_c, w_c a product of fades (fade'' = 120 t^3 - 180 t^2 + 60 t), l_c = g_c.(p - c) linear, so that
// D2 n = sum_c D2 w_c l_c + grad w_c g_c^T + g_c grad w_c^T.
// Bounds, as in noise.cpp: D^k n (u^k) = sum_c g_c.(D^k w_c (p - c) + k D^(k-1) w_c u) <= sum_c |...|, a closed form in (p, u) whose maximum was
// found numerically (many starts, then descent) and rounded up. The third derivative jumps at the cell's sides; the bound holds on either side.
#include "terrain/math/noise_hessian.h"

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

}  // namespace hoodoo
