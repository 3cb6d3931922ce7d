// Gradient noise: at each lattice point a random plane through zero, blended by the quintic fade; and sums of octaves of it.
// Perlin2002. n(p) = sum_c w_c(p) g_c.(p - c), w_c = product over the axes of fade or 1 - fade, fade(t) = 6t^5 - 15t^4 + 10t^3.
// 1-D and 2-D use the hash and gradients that the golden values fix (2-D: unit vector at the angle 2 pi hash / 2^32).
// Bounds. Value: |n| <= sum w |p - c| <= sqrt(sum w |p - c|^2) (Jensen), and each axis adds x^2 + fade(x)(1 - 2x) <= 1/4: sqrt(D)/2. (1-D: slopes up
// to 1.) Slope: u.grad n = sum_c g_c.(w_c u + (p - c) grad w_c.u) <= sum_c |w_c u + (p - c) grad w_c.u|, a closed form in (p, u) whose maximum was
// found numerically and rounded up; it is attained by some choice of gradients, so no smaller bound holds for all seeds. Deviation: 3-D gradients are
// the normalised points of a random cube, which favours its corners; no trigonometry, the same bits everywhere. Missing: second derivatives.
#include "terrain/math/noise.h"

#include <algorithm>
#include <numbers>

namespace hoodoo
{

namespace
{

constexpr int kMaxOctaves = 24;

double fade(double t)
{
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}
double fade_slope(double t)
{
    return 30.0 * t * t * (t - 1.0) * (t - 1.0);
}

/// A coordinate split into its lattice cell and the rest. From 2^51 on every double is a lattice point or close to one: the noise is 0 there.
struct Cell {
    std::uint32_t index = 0;
    double rest = 0.0, fade = 0.0, slope = 0.0;
};

Cell cell_of(double x)
{
    if (!(std::abs(x) < 0x1p51)) return {};
    const double low = std::floor(x);
    const double rest = x - low;
    return {static_cast<std::uint32_t>(static_cast<std::int64_t>(low)), rest, fade(rest), fade_slope(rest)};
}

double slope_at(std::uint32_t ix, std::uint32_t seed)
{
    return lattice_hash(ix, 0, seed) * 0x1p-31 - 1.0;
}

double mix(double a, double b, double t)
{
    return a + t * (b - a);
}

/// What one octave adds, faded if it is the last and a fraction.
template <class Octave>
void for_octaves(const Fractal& fractal, Octave&& octave)
{
    double frequency = 1.0, amplitude = 1.0;
    const double octaves = std::min(fractal.octaves, static_cast<double>(kMaxOctaves));
    for (int k = 0; k < octaves; ++k) {
        octave(k, frequency, amplitude * std::min(1.0, octaves - k));
        frequency *= fractal.lacunarity;
        amplitude *= fractal.gain;
    }
}

/// Octaves are turned against each other by exact rotations (the 3-4-5 triangle; a turn of 60 degrees about the space diagonal's neighbour),
/// and shifted, so that their lattices nowhere coincide.
Vec2d turned(const Vec2d& p)
{
    return {0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y};
}
Vec2d turned_back(const Vec2d& p)
{
    return {0.8 * p.x + 0.6 * p.y, -0.6 * p.x + 0.8 * p.y};
}
Vec3d turned(const Vec3d& p)
{
    return Vec3d(2 * p.x - p.y + 2 * p.z, 2 * p.x + 2 * p.y - p.z, -p.x + 2 * p.y + 2 * p.z) * (1.0 / 3.0);
}
Vec3d turned_back(const Vec3d& p)
{
    return Vec3d(2 * p.x + 2 * p.y - p.z, -p.x + 2 * p.y + 2 * p.z, 2 * p.x - p.y + 2 * p.z) * (1.0 / 3.0);
}
Vec2d shift(const Vec2d&, int k)
{
    return {17.3 * k, 31.7 * k};
}
Vec3d shift(const Vec3d&, int k)
{
    return {17.3 * k, 31.7 * k, 23.9 * k};
}

template <class Result, class Point, class Shape>
Result sum(const Point& p, std::uint32_t seed, const Fractal& fractal, Shape&& shape)
{
    Result total;
    Point q = p;
    int turns = 0;
    for_octaves(fractal, [&](int k, double frequency, double amplitude) {
        for (; turns < k; ++turns) q = turned(q);
        Result n = shape(gradient_noise(q * frequency + shift(p, k), seed + static_cast<std::uint32_t>(k)));
        for (int back = 0; back < k; ++back) n.gradient = turned_back(n.gradient);
        total.value += amplitude * n.value;
        total.gradient += n.gradient * (amplitude * frequency);
    });
    return total;
}

/// (1 - |n|/N)^2 and its derivative.
template <class Noise>
Noise crest(const Noise& n, double bound)
{
    const double r = 1.0 - std::abs(n.value) / bound;
    return {r * r, n.gradient * (-2.0 * r * std::copysign(1.0, n.value) / bound)};
}

}  // namespace

// The nearest quarter turn is exact; what is left, at most pi / 4, goes by Taylor's series up to
// terms below 1e-16: quicker than a library's functions, which may also differ from one to the next.
Vec2d lattice_gradient(std::uint32_t ix, std::uint32_t iy, std::uint32_t seed)
{
    const std::uint32_t hash = lattice_hash(ix, iy, seed), quarter = (hash + (1u << 29)) >> 30;
    const double x = static_cast<std::int32_t>(hash - (quarter << 30)) * (2.0 * std::numbers::pi * 0x1p-32), y = x * x;
    constexpr double f[8] = {-1.0 / 6,        1.0 / 120,        -1.0 / 5040,         1.0 / 362880,
                             -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368e3, 1.0 / 355687428096e3};
    constexpr double e[8] = {-1.0 / 2, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888e3};
    double s = f[7], c = e[7];
    for (int k = 6; k >= 0; --k) s = s * y + f[k], c = c * y + e[k];
    s = x + x * (y * s);
    c = 1.0 + y * c;
    const double u = quarter & 1u ? -s : c, v = quarter & 1u ? c : s;
    return quarter & 2u ? Vec2d(-u, -v) : Vec2d(u, v);
}

Noise1 gradient_noise(double x, std::uint32_t seed)
{
    const Cell c = cell_of(x);
    const double g0 = slope_at(c.index, seed), g1 = slope_at(c.index + 1, seed);
    const double a = g0 * c.rest, b = g1 * (c.rest - 1.0);
    return {mix(a, b, c.fade), mix(g0, g1, c.fade) + c.slope * (b - a)};
}

Noise2 gradient_noise(const Vec2d& p, std::uint32_t seed)
{
    const Cell x = cell_of(p.x), y = cell_of(p.y);
    double v[2][2];
    Vec2d g[2][2];
    for (std::uint32_t j = 0; j < 2; ++j) {
        for (std::uint32_t i = 0; i < 2; ++i) {
            g[j][i] = lattice_gradient(x.index + i, y.index + j, seed);
            v[j][i] = g[j][i].x * (x.rest - i) + g[j][i].y * (y.rest - j);
        }
    }
    const double v0 = mix(v[0][0], v[0][1], x.fade), v1 = mix(v[1][0], v[1][1], x.fade);
    const Vec2d g0 = g[0][0] + (g[0][1] - g[0][0]) * x.fade, g1 = g[1][0] + (g[1][1] - g[1][0]) * x.fade;
    return {mix(v0, v1, y.fade), g0 + (g1 - g0) * y.fade + Vec2d(x.slope * mix(v[0][1] - v[0][0], v[1][1] - v[1][0], y.fade), y.slope * (v1 - v0))};
}

Noise3 gradient_noise(const Vec3d& p, std::uint32_t seed)
{
    const Cell x = cell_of(p.x), y = cell_of(p.y), z = cell_of(p.z);
    // The eight corners side by side, corner c at bit 0 along x, bit 1 along y, bit 2 along z: loops without branches that the compiler vectorises.
    const std::uint32_t layer[2] = {lattice_hash(z.index, 0x9E3779B9u, seed), lattice_hash(z.index + 1, 0x9E3779B9u, seed)};
    std::uint32_t h[8];
    for (std::uint32_t c = 0; c < 8; ++c) h[c] = lattice_hash(x.index + (c & 1u), y.index + ((c >> 1) & 1u), layer[c >> 2]);
    double gx[8], gy[8], gz[8], v[8], w[8], a[8], b[8], d[8];
    for (int c = 0; c < 8; ++c) {
        // Odd numbers: never the zero vector.
        const double sx = 2.0 * static_cast<int>(h[c] & 1023u) - 1023.0, sy = 2.0 * static_cast<int>((h[c] >> 10) & 1023u) - 1023.0,
                     sz = 2.0 * static_cast<int>((h[c] >> 20) & 1023u) - 1023.0;
        const double scale = 1.0 / std::sqrt(sx * sx + sy * sy + sz * sz);
        gx[c] = sx * scale;
        gy[c] = sy * scale;
        gz[c] = sz * scale;
    }
    const double fx[2] = {1.0 - x.fade, x.fade}, fy[2] = {1.0 - y.fade, y.fade}, fz[2] = {1.0 - z.fade, z.fade};
    const double kx[2] = {-x.slope, x.slope}, ky[2] = {-y.slope, y.slope}, kz[2] = {-z.slope, z.slope};
    for (int c = 0; c < 8; ++c) {
        const int i = c & 1, j = (c >> 1) & 1, k = c >> 2;
        v[c] = gx[c] * (x.rest - i) + gy[c] * (y.rest - j) + gz[c] * (z.rest - k);
        w[c] = fx[i] * fy[j] * fz[k];
        a[c] = kx[i] * fy[j] * fz[k];
        b[c] = fx[i] * ky[j] * fz[k];
        d[c] = fx[i] * fy[j] * kz[k];
    }
    Noise3 n;
    for (int c = 0; c < 8; ++c) {
        n.value += w[c] * v[c];
        n.gradient += Vec3d(gx[c] * w[c] + a[c] * v[c], gy[c] * w[c] + b[c] * v[c], gz[c] * w[c] + d[c] * v[c]);
    }
    return n;
}

Noise2 fbm(const Vec2d& p, std::uint32_t seed, const Fractal& fractal)
{
    return sum<Noise2>(p, seed, fractal, [](const Noise2& n) { return n; });
}

Noise3 fbm(const Vec3d& p, std::uint32_t seed, const Fractal& fractal)
{
    return sum<Noise3>(p, seed, fractal, [](const Noise3& n) { return n; });
}

Noise2 fbm_octave(const Vec2d& p, std::uint32_t seed, const Fractal& fractal, int octave)
{
    Noise2 n;
    Vec2d q = p;
    for (int turns = 0; turns < octave; ++turns) q = turned(q);
    for_octaves(fractal, [&](int k, double frequency, double amplitude) {
        if (k != octave) return;
        n = gradient_noise(q * frequency + shift(p, k), seed + static_cast<std::uint32_t>(k));
        for (int back = 0; back < k; ++back) n.gradient = turned_back(n.gradient);
        n = {amplitude * n.value, n.gradient * (amplitude * frequency)};
    });
    return n;
}

Noise2 ridged(const Vec2d& p, std::uint32_t seed, const Fractal& fractal)
{
    return sum<Noise2>(p, seed, fractal, [](const Noise2& n) { return crest(n, kNoise2Bound.value); });
}

Noise3 ridged(const Vec3d& p, std::uint32_t seed, const Fractal& fractal)
{
    return sum<Noise3>(p, seed, fractal, [](const Noise3& n) { return crest(n, kNoise3Bound.value); });
}

NoiseBound fbm_bound(const NoiseBound& octave, const Fractal& fractal)
{
    NoiseBound bound{0.0, 0.0};
    for_octaves(fractal, [&](int, double frequency, double amplitude) {
        bound.value += octave.value * amplitude;
        bound.slope += octave.slope * amplitude * frequency;
    });
    return bound;
}

NoiseBound ridged_bound(const NoiseBound& octave, const Fractal& fractal)
{
    // r in [0, 1], so the value is at most 1 and |d(r^2)| = 2 r |dn| / N <= 2 G / N.
    return fbm_bound({1.0, 2.0 * octave.slope / octave.value}, fractal);
}

}  // namespace hoodoo
