// Two oracles in 80-bit numbers that know nothing of walks, orders or blocks: planes of all triangles, and signs at all bends.
#include "tests/support/grid_oracle.h"

#include "tests/support/numbers.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo::testing
{
namespace
{

using Real = long double;

struct GridRayExact {
    Real u, v, z, du, dv, dz;
    GridRayExact(const GridFrame& f, const Ray& ray)
        : u((static_cast<Real>(ray.origin.x) - f.origin.x) / f.cell.x),
          v((static_cast<Real>(ray.origin.y) - f.origin.y) / f.cell.y),
          z(static_cast<Real>(ray.origin.z) - f.origin.z),
          du(static_cast<Real>(ray.direction.x) / f.cell.x),
          dv(static_cast<Real>(ray.direction.y) / f.cell.y),
          dz(ray.direction.z)
    {
    }
};

/// Metres above the grid's origin; the caller keeps to the domain.
Real ground(const HeightGrid& grid, Real u, Real v)
{
    const int i = std::clamp(static_cast<int>(std::floor(u)), 0, grid.columns() - 2),
              j = std::clamp(static_cast<int>(std::floor(v)), 0, grid.rows() - 2);
    const Real a = u - i, b = v - j;
    const Real h10 = grid.sample(i + 1, j), h01 = grid.sample(i, j + 1);
    const Real h = a + b <= 1.0L ? grid.sample(i, j) * (1.0L - a - b) + h10 * a + h01 * b
                                 : grid.sample(i + 1, j + 1) * (a + b - 1.0L) + h01 * (1.0L - a) + h10 * (1.0L - b);
    return h * grid.frame().scale;
}

/// The rounding that double precision may have put into a height over the grid. Its own derivation, generous: 2^-44 of the largest numbers.
Real height_tolerance(const HeightGrid& grid, const GridRayExact& r)
{
    Real lo = grid.sample(0, 0), hi = lo;
    for (int j = 0; j < grid.rows(); ++j)
        for (int i = 0; i < grid.columns(); ++i) lo = std::min<Real>(lo, grid.sample(i, j)), hi = std::max<Real>(hi, grid.sample(i, j));
    const Real far = std::abs(r.u) + std::abs(r.v) + grid.columns() + grid.rows();
    const Vec3d& o = grid.frame().origin;
    // World coordinates are rounded before they come to the grid: half a unit in the last place each.
    const Real world = std::abs(o.x) / grid.frame().cell.x + std::abs(o.y) / grid.frame().cell.y;
    return 0x1p-44L * (std::abs(r.z) + std::max(std::abs(lo), std::abs(hi)) * grid.frame().scale + (far + world) * (hi - lo) * grid.frame().scale +
                       std::abs(o.z));
}

bool wanted(const Ray& ray, bool enters)
{
    return enters || ray.crossing == Crossing::any;
}

Verdict passes_no_triangle(const HeightGrid& grid, const Ray& ray, const GridRayExact& r, double t, Real tolerance)
{
    constexpr Real inside = 1e-9L;
    const Real scale = grid.frame().scale;
    for (int j = 0; j + 1 < grid.rows(); ++j) {
        for (int i = 0; i + 1 < grid.columns(); ++i) {
            for (const bool upper : {false, true}) {
                const Real h10 = grid.sample(i + 1, j), h01 = grid.sample(i, j + 1), c = grid.sample(i + upper, j + upper);
                const Real gu = (upper ? c - h01 : h10 - c) * scale, gv = (upper ? c - h10 : h01 - c) * scale;
                const Real closing = r.dz - gu * r.du - gv * r.dv;
                if (std::abs(closing) < 1e-7L || !wanted(ray, closing < 0.0L)) continue;
                const Real s = (c * scale + gu * (r.u - i - upper) + gv * (r.v - j - upper) - r.z) / closing;
                const Real slack = tolerance / std::abs(closing) + 1e-12L * std::abs(s);
                if (!(s > ray.t_min + slack && s < ray.t_max - slack && s < t - slack)) continue;
                const Real u = r.u + r.du * s - i, v = r.v + r.dv * s - j;
                const Real third = upper ? u + v - 1.0L : 1.0L - u - v, a = upper ? 1.0L - u : u, b = upper ? 1.0L - v : v;
                if (std::min({a, b, third}) > inside)
                    return {fmt::format("triangle ({}, {}, {}) is met at {:.17g}, before {:.17g}", i, j, upper, static_cast<double>(s), t)};
            }
        }
    }
    return {};
}

Verdict keeps_its_side(const HeightGrid& grid, const Ray& ray, const GridRayExact& r, double t, Real tolerance)
{
    std::vector<Real> places{static_cast<Real>(ray.t_min)};
    if (std::isfinite(ray.t_max)) places.push_back(ray.t_max);
    const auto add = [&](Real start, Real speed, int lines) {
        if (speed == 0.0L) return;
        for (int k = 0; k <= lines; ++k) places.push_back((k - start) / speed);
    };
    add(r.u, r.du, grid.columns() - 1);
    add(r.v, r.dv, grid.rows() - 1);
    add(r.u + r.v, r.du + r.dv, grid.columns() + grid.rows() - 2);
    // A ray that hardly moves sideways leaves through the top or the bottom of all heights.
    if (r.dz != 0.0L) {
        const Interval heights = grid.range(grid.domain());
        for (const Real z : {heights.lo - 1.0L, heights.hi + 1.0L}) places.push_back((z - grid.frame().origin.z - r.z) / r.dz);
    }
    std::sort(places.begin(), places.end());
    int side = 0;
    Real side_at = 0.0L;
    for (const Real s : places) {
        if (s < ray.t_min || s > ray.t_max) continue;
        const Real u = r.u + r.du * s, v = r.v + r.dv * s;
        if (u < 0.0L || v < 0.0L || u > grid.columns() - 1 || v > grid.rows() - 1) continue;
        const Real f = r.z + r.dz * s - ground(grid, u, v);
        if (std::abs(f) <= tolerance) continue;
        const int now = f < 0.0L ? -1 : 1;
        if (side != 0 && now != side && wanted(ray, now < 0)) {
            if (!(t <= s))
                return {fmt::format("the ray changes its side between {:.17g} and {:.17g}, the hit is at {:.17g}", static_cast<double>(side_at),
                                    static_cast<double>(s), t)};
            return {};
        }
        side = now;
        side_at = s;
    }
    return {};
}

}  // namespace

Verdict is_nearest_on_grid(const HeightGrid& grid, const Ray& ray, double t)
{
    const GridRayExact r(grid.frame(), ray);
    const Real tolerance = height_tolerance(grid, r);
    if (std::isfinite(t)) {
        const Real u = r.u + r.du * t, v = r.v + r.dv * t, edge = 1e-9L * (1.0L + std::abs(r.u) + std::abs(r.v));
        if (u < -edge || v < -edge || u > grid.columns() - 1 + edge || v > grid.rows() - 1 + edge) return {"a hit beside the grid"};
        const Real f = r.z + r.dz * t - ground(grid, u, v);
        // The hit's own t is rounded too.
        const Real steep = 1.0L + std::abs(r.du) * grid.slope_bound(grid.domain()) * grid.frame().cell.x +
                           std::abs(r.dv) * grid.slope_bound(grid.domain()) * grid.frame().cell.y;
        if (std::abs(f) > tolerance + 0x1p-50L * t * steep)
            return {fmt::format("the hit at {:.17g} is {:.9g} m off the ground", t, static_cast<double>(f))};
        if (!(t > ray.t_min && t < ray.t_max)) return {"a hit outside of the ray's interval"};
    }
    const Verdict triangles = passes_no_triangle(grid, ray, r, t, tolerance);
    return triangles.holds() ? keeps_its_side(grid, ray, r, t, tolerance) : triangles;
}

HeightGrid rugged_grid(SampleType type, int columns, int rows, const Vec3d& origin)
{
    const double top = type == SampleType::u8 ? 255.0 : type == SampleType::u16 ? 65535.0 : type == SampleType::i16 ? 30000.0 : 1.0;
    HeightGrid grid({origin, {0.5, 0.4}, 8.0 / top}, columns, rows, type);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            double share = 0.3 + 0.15 * std::sin(0.4 * i) * std::cos(0.33 * j) + 0.1 * unit_real(hash_cell(6, i, j));
            if (i > columns / 2 && j > rows / 2) share = 0.75;            // a plateau with walls
            if (i < columns / 4 && j > rows / 2) share = 0.01 * (i + j);  // an even slope
            if (i % 7 == 3 && j % 5 == 2) share += 0.3;                   // spikes
            grid.set(i, j, type == SampleType::f32 ? share * top : std::floor(share * top) - (type == SampleType::i16 ? 15000.0 : 0.0));
        }
    }
    grid.summarise();
    return grid;
}

Ray grid_ray(const HeightGrid& grid, std::uint64_t seed, std::uint64_t n)
{
    Numbers random(seed, n);
    const GridFrame& f = grid.frame();
    const auto node = [&](int i, int j) { return Vec3d(f.origin.x + i * f.cell.x, f.origin.y + j * f.cell.y, grid.node_height(i, j)); };
    const int i = static_cast<int>(random() * (grid.columns() - 1)), j = static_cast<int>(random() * (grid.rows() - 1));
    const Vec3d a = node(i, j), b = node(i + 1, j), c = node(i, j + 1);
    const double wu = random(), wv = random() * (1.0 - wu);
    const Vec3d on = a + (b - a) * wu + (c - a) * wv, normal = (b - a).cross(c - a).normalized();
    const double size = 5.0 * (f.cell.x + f.cell.y);
    Ray ray;
    ray.direction = random.direction();
    ray.origin = on - ray.direction * (size * random() * 4.0);
    switch (n % 10) {
        case 0:
        case 1: {
            // |n . d| < 0.02, through a point of the triangle or a hair beside it.
            Vec3d u, v;
            orthonormal_frame(normal, u, v);
            const double angle = random.between(0.0, 6.283185307179586);
            ray.direction = (u * std::cos(angle) + v * std::sin(angle) + normal * random.between(-0.02, 0.02)).normalized();
            ray.origin = on + normal * random.between(-1e-3, 1e-3) - ray.direction * size * random();
            break;
        }
        case 2:
            ray.origin = on + normal * std::pow(10.0, random.between(-12.0, -1.0)) * (random() < 0.5 ? -1.0 : 1.0);
            break;
        case 3: {
            const int axis = static_cast<int>(random() * 3.0);
            ray.direction = Vec3d(0.0);
            ray.direction[axis] = random() < 0.5 ? -1.0 : 1.0;
            if (random() < 0.5)
                ray.origin = a - ray.direction * size;  // in a line of the lattice
            else
                ray.origin = on - ray.direction * size;
            break;
        }
        case 4: {
            // Through a node, or along an edge: every number of the lattice is met exactly or nearly.
            const Vec3d to = random() < 0.5 ? b : c;
            ray.direction = random() < 0.5 ? (to - a).normalized() : random.direction();
            ray.origin = (random() < 0.5 ? a : to) - ray.direction * size * random();
            break;
        }
        default:
            break;
    }
    if (random() < 0.5) ray.crossing = Crossing::entering;
    if (random() < 0.2) ray.t_max = size * random() * 4.0;
    return ray;
}

}  // namespace hoodoo::testing
