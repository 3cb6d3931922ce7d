// A bracket around a known near-root, grown until the signs differ, then shrunk by the Illinois rule: secant steps that cannot stall (Dowell1971).
// The first half-width is what the known |f| <= error means where the field changes by 1 in `scale`, or half of what is precise enough: then two
// values of the field do in most cases. It doubles up to 1e-3 of the scale.
// Rounding of the point itself, a few 2^-53 of its coordinates, is part of the stated error. Missing: tangent rays have no bracket; they keep their
// t.
#include "terrain/surfaces/refine.h"

#include <algorithm>

namespace hoodoo
{

Refined refine_crossing(const Field& field, const Ray& ray, double t, double value_error, double scale)
{
    return refine_crossing([&field](const Vec3d& p) { return field.value(p); }, ray, t, value_error, scale);
}

Refined refine_crossing(const std::function<double(const Vec3d&)>& field, const Ray& ray, double t, double value_error, double scale)
{
    const Vec3d p = ray.at(t);
    const double rounding =
        4 * 0x1p-52 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::abs(ray.origin.x) + std::abs(ray.origin.y) + std::abs(ray.origin.z) + t);
    const auto f = [&](double s) { return field(ray.at(s)); };
    const double most = std::max(1e-3 * scale, 4 * rounding);
    const double enough = std::max(rounding, 2e-7 * scale);  // far below what a picture or a later ray can see
    double half = std::max({value_error * scale, 0.5 * enough, 2 * rounding});
    half = std::min(half, most);
    double a = t - half, b = t + half, fa = f(a), fb = f(b);
    const auto crosses = [&] { return ray.crossing == Crossing::entering ? fa >= 0.0 && fb < 0.0 : (fa < 0.0) != (fb < 0.0); };
    while (!crosses() && half < most) {
        half = std::min(2.0 * half, most);
        a = t - half;
        b = t + half;
        fa = f(a);
        fb = f(b);
    }
    if (!crosses()) return {t, most + rounding};
    int side = 0;
    for (int step = 0; step < 100 && b - a > enough; ++step) {
        // The secant's point, kept off the ends; every third step halves, which bounds the number of steps.
        double m = step % 3 == 2 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
        m = std::clamp(m, a + 0.25 * rounding, b - 0.25 * rounding);
        const double fm = f(m);
        if ((fm < 0.0) == (fa < 0.0)) {
            a = m;
            fa = fm;
            if (side == -1) fb *= 0.5;
            side = -1;
        } else {
            b = m;
            fb = fm;
            if (side == 1) fa *= 0.5;
            side = 1;
        }
    }
    return {0.5 * (a + b), 0.5 * (b - a) + rounding};
}

Vec3d into_hemisphere(const Vec3d& shading, const Vec3d& geometric)
{
    const double c = shading.dot(geometric);
    if (c > 0.0) return shading;
    const Vec3d mirrored = shading - geometric * (2.0 * c);
    return mirrored.dot(geometric) > 0.0 ? mirrored.normalized() : geometric;
}

}  // namespace hoodoo
