// The canyon's profile T(z): how far its walls have moved at each height (Gamito2001, section 4.1).
// T is an fBm of the height. Bounds over a box: |n1'| <= 1.3472, |n1''| from the slopes of the lattice points about, each octave's value and slope
// over a span from those at its middle. Level of detail: octave k fades as the pixel's width grows from 1/4 to 1/2 of its wavelength; a function of
// the point's distance alone, so that shadow rays and camera rays meet the same surface. With a vertical deformation (section 5) T is taken at the
// height from which the point was lifted, z - s(x, y): T then changes sideways too, by T' |grad s|.
#include "terrain/fields/canyon.h"

#include "terrain/fields/detail.h"
#include "terrain/math/noise_hessian.h"

#include <algorithm>

namespace hoodoo
{

CanyonLift CanyonLift::at(const CanyonShape& shape, const Vec3d& p)
{
    if (shape.lift == 0.0) return {};
    const double w = shape.lift_wavelength * shape.cell, a = shape.lift * shape.height;
    const Noise2 n = gradient_noise(Vec2d(p.x - shape.origin.x, p.y - shape.origin.y) * (1.0 / w), lift_seed(shape));
    return {a * n.value, n.gradient * (a / w)};
}

CanyonLift::Bound CanyonLift::bound(const CanyonShape& shape)
{
    const double w = shape.lift_wavelength * shape.cell, a = shape.lift * shape.height;
    return {a * kNoise2Bound.value, a / w * kNoise2Derivatives.slope, a / (w * w) * kNoise2Derivatives.hessian};
}

CanyonLift::Range CanyonLift::over(const CanyonShape& shape, const Box3d& box)
{
    if (shape.lift == 0.0) return {};
    const Bound most = bound(shape);
    const CanyonLift middle = at(shape, box.center());
    const Vec3d half = box.size() * 0.5;
    const double radius = std::hypot(half.x, half.y), turn = most.curve * radius;
    const double reach = std::abs(middle.gradient.x) * half.x + std::abs(middle.gradient.y) * half.y + 0.5 * turn * radius;
    const double stray = std::min(reach, most.slope * radius) + 1e-12 * most.value;
    Range range;
    range.value = {std::max(middle.value - stray, -most.value), std::min(middle.value + stray, most.value)};
    for (int k = 0; k < 2; ++k)
        range.gradient[static_cast<std::size_t>(k)] = {std::max(middle.gradient[k] - turn, -most.slope),
                                                       std::min(middle.gradient[k] + turn, most.slope)};
    range.slope = std::min(middle.gradient.length() + turn, most.slope);
    return range;
}

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
    const CanyonLift lift = CanyonLift::at(shape_, p);
    const double z = (p.z - lift.value - shape_.origin.z) / shape_.height;
    const double distance = shape_.view ? (p - shape_.view->eye).length() : 0.0;
    Value v;
    v.lift_gradient = lift.gradient;
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
    Range r;
    r.lift = CanyonLift::over(shape_, box);
    const Interval lift = r.lift.value;
    const double z0 = (box.min.z - lift.hi - shape_.origin.z) / shape_.height, z1 = (box.max.z - lift.lo - shape_.origin.z) / shape_.height;
    const double middle = 0.5 * (z0 + z1), half = 0.5 * (z1 - z0);
    double aslant = 0.0;  // what the distance adds to a second derivative along any direction
    const Interval far = shape_.view ? distances(box, shape_.view->eye) : Interval{0.0, 0.0};
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
        // Along a direction T's height part changes by 1 + |grad s| times its slope at most.
        const double crossed = a * 2.0 * 1.5 * s * f / shape_.height * slope.magnitude() * (1.0 + r.lift.slope);
        aslant += crossed + a * (6.0 * s * s + 1.5 * s * s) * size;
    }
    if (shape_.lift != 0.0) {
        // T(z - s): T'' (s_u - c |grad s|)^2 along a direction, and T' |D2 s| c^2.
        r.mixed = r.upright * r.lift.slope;
        r.across = r.mixed * r.lift.slope + r.by_height.magnitude() * CanyonLift::bound(shape_).curve;
    }
    r.across += aslant, r.upright += aslant;
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
    flat.lift = 0.0;
    const CanyonProfile plain(flat);
    double most = 0.0;
    for (int k = 0; k < slices; ++k) {
        const double lo = static_cast<double>(k) / slices, hi = static_cast<double>(k + 1) / slices;
        most = std::max(
            most, plain.over(Box3d(shape_.origin + Vec3d(0, 0, lo * shape_.height), shape_.origin + Vec3d(0, 0, hi * shape_.height))).t.magnitude());
    }
    return std::min(most, this->most());
}

}  // namespace hoodoo
