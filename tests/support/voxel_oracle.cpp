// Independent of the product: monomial cubics from four values, closed-form extremes, signs at pieces' ends and extremes.
#include "tests/support/voxel_oracle.h"

#include "tests/support/numbers.h"

#include <algorithm>
#include <cmath>

namespace hoodoo::testing
{

long double DenseVoxels::value(long double x, long double y, long double z) const
{
    const long double u = (x - first.x) / cell, v = (y - first.y) / cell, w = (z - first.z) / cell;
    const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v)), k = static_cast<int>(std::floor(w));
    long double sum = 0.0L;
    for (int n = 0; n < 8; ++n) {
        const int a = n & 1, b = (n >> 1) & 1, c = n >> 2;
        sum += static_cast<long double>(at(i + a, j + b, k + c)) * (a ? u - i : 1 - (u - i)) * (b ? v - j : 1 - (v - j)) * (c ? w - k : 1 - (w - k));
    }
    return sum;
}

VoxelGrid DenseVoxels::grid() const
{
    VoxelGrid grid(size, cell, first, air);
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < size[1]; ++j)
            for (int k = 0; k < size[2]; ++k) grid.set({i + 1, j + 1, k + 1}, at(i, j, k));
    return grid;
}

std::optional<double> certain_crossing(const DenseVoxels& voxels, const Ray& ray, double t_end, double margin)
{
    const auto f = [&](long double t) {
        return voxels.value(ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y, ray.origin.z + t * ray.direction.z);
    };
    // Every plane of samples that the ray crosses, the rim of air included.
    std::vector<long double> cuts{ray.t_min};
    long double last = t_end;
    for (int k = 0; k < 3; ++k) {
        const long double d = ray.direction[k], o = ray.origin[k];
        const int n = voxels.size[static_cast<std::size_t>(k)];
        if (d == 0.0L) continue;
        for (int plane = -1; plane <= n; ++plane) {
            const long double t = (voxels.first[k] + voxels.cell * static_cast<long double>(plane) - o) / d;
            if (t > ray.t_min && t < t_end) cuts.push_back(t);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    if (!std::isfinite(t_end)) last = cuts.back() + voxels.cell;
    cuts.push_back(last);

    int side = 0;  // of the last certain value
    long double at = 0.0L;
    const auto see = [&](long double t) {
        const long double value = f(t);
        if (std::abs(value) <= margin) return false;
        const int now = value < 0.0L ? -1 : 1;
        const bool changed = side != 0 && now != side && (now < 0 || ray.crossing == Crossing::any);
        if (!changed) at = t;
        side = now;
        return changed;
    };
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
        const long double a = cuts[c], h = cuts[c + 1] - a;
        if (h <= 0.0L) continue;
        // The cubic through values at 1/5, 2/5, 3/5, 4/5 of the piece, by divided differences; its derivative's roots.
        const long double s1 = a + h / 5, s2 = a + 2 * h / 5, s3 = a + 3 * h / 5, s4 = a + 4 * h / 5;
        const long double f1 = f(s1), f2 = f(s2), f3 = f(s3), f4 = f(s4), e = h / 5;
        const long double d1 = (f2 - f1) / e, d2 = (f3 - f2) / e, d3 = (f4 - f3) / e, dd1 = (d2 - d1) / (2 * e), dd2 = (d3 - d2) / (2 * e);
        const long double ddd = (dd2 - dd1) / (3 * e);
        // p'(s) with s from s1: d1 + dd1 (2 s - e) + ddd (3 s^2 - 6 e s + 2 e^2).
        const long double qa = 3 * ddd, qb = 2 * dd1 - 6 * e * ddd, qc = d1 - dd1 * e + 2 * e * e * ddd;
        std::vector<long double> places{a, a + h};
        const long double disc = qb * qb - 4 * qa * qc;
        if (disc >= 0.0L) {
            const long double q = -0.5L * (qb + std::copysign(std::sqrt(disc), qb));
            for (const long double root : {qa != 0.0L ? q / qa : -1.0L, q != 0.0L ? qc / q : -1.0L})
                if (s1 + root > a && s1 + root < a + h) places.push_back(s1 + root);
        }
        for (int n = 1; n < 8; ++n) places.push_back(a + h * n / 8);
        std::sort(places.begin(), places.end());
        for (const long double t : places)
            if (see(t)) return static_cast<double>(at);
    }
    return std::nullopt;
}

DenseVoxels hard_voxels(int kind, std::uint64_t seed, const Index3& size)
{
    DenseVoxels v{size, 0.37, Vec3d(1.25, -2.5, 0.75), 0.5f, {}};
    Numbers random(seed, 77);
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < size[1]; ++j)
            for (int k = 0; k < size[2]; ++k) {
                const double x = i * 0.55, y = j * 0.5, z = k * 0.6;
                const double smooth = std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x) + 0.2;
                double f = 0.25 * smooth;
                if (kind == 1) f = random() - 0.5;
                if (kind == 2) f = random() < 0.5 + 0.3 * smooth ? 0.5 : -0.5;
                if (kind == 3) f = random() < 0.4 ? 0.0 : 0.25 * smooth;
                v.values.push_back(static_cast<float>(f));
            }
    return v;
}

}  // namespace hoodoo::testing
