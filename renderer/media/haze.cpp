// Haze whose density is 1 up to a base and falls off exponentially above it; columns and their inverse in closed form.
//
// With h = z - base >= 0 at the start, s the rise along the ray and H the scale height,
//     column(t) = e^(-h / H) t phi(s t / H),   phi(x) = (1 - e^-x) / x = -expm1(-x) / x,   phi(0) = 1,
// which loses no digits for level rays. The inverse is t = c lambda(s c / H), c = column e^(h / H), lambda(y) = -log1p(-y) / y; it does not exist for
// y >= 1: such a ray leaves the haze. A ray that crosses the base is two pieces. Below the base the density is 1: an exponential has no floor, and
// rays that pass the ground would drown in it.
#include "renderer/media/haze.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

double extinction_of_visibility(double visibility)
{
    return -std::log(0.02) / visibility;
}

/// From `height` >= 0 metres above the base, upwards or not below the base.
double Haze::column_above(double height, double rise, double t) const
{
    const double x = rise * t / height_, here = std::exp(-height / height_);
    if (std::isinf(t)) return rise > 0.0 ? here * height_ / rise : kInfinity;
    return here * t * (x == 0.0 ? 1.0 : -std::expm1(-x) / x);
}

double Haze::distance_above(double height, double rise, double column) const
{
    const double c = column * std::exp(height / height_), y = rise * c / height_;
    if (!(y < 1.0)) return kInfinity;
    return c * (y == 0.0 ? 1.0 : -std::log1p(-y) / y);
}

double Haze::column(const Vec3d& origin, const Vec3d& direction, double t) const
{
    const double height = origin.z - base_, rise = direction.z;
    const double crossing = rise != 0.0 ? -height / rise : kInfinity;  // where the ray is at the base
    if (height >= 0.0) {
        if (!(rise < 0.0) || t <= crossing) return column_above(height, rise, t);
        return column_above(height, rise, crossing) + (t - crossing);
    }
    if (!(rise > 0.0) || t <= crossing) return t;
    return crossing + column_above(0.0, rise, t - crossing);
}

double Haze::distance(const Vec3d& origin, const Vec3d& direction, double column) const
{
    const double height = origin.z - base_, rise = direction.z;
    const double crossing = rise != 0.0 ? -height / rise : kInfinity;
    if (height >= 0.0) {
        if (!(rise < 0.0)) return distance_above(height, rise, column);
        const double above = column_above(height, rise, crossing);
        return column <= above ? std::min(distance_above(height, rise, column), crossing) : crossing + (column - above);
    }
    if (!(rise > 0.0) || column <= crossing) return column;
    return crossing + distance_above(0.0, rise, column - crossing);
}

const Schema& haze_schema()
{
    using T = ParameterType;
    static const Schema schema{
        "haze",
        "Haze between the things of the scene, thinner with height. It is a part of the aerosol of a clear sky, which is made clearer by as much.",
        {
            {.name = "visibility",
             .type = T::length,
             .doc = "How far a dark thing can be seen at the base: 2% of its contrast is left. Without it there is no haze.",
             .unit = "m",
             .minimum = 0.0,
             .above_minimum = true},
            {.name = "height",
             .type = T::length,
             .doc = "Over this height the haze thins to 37%.",
             .fallback = 1200.0,
             .unit = "m",
             .minimum = 0.0,
             .above_minimum = true},
            {.name = "base", .type = T::length, .doc = "Height of full density; as dense everywhere below.", .fallback = 0.0, .unit = "m"},
            {.name = "albedo",
             .type = T::color,
             .doc = "Share of what haze takes that it scatters.",
             .fallback = ColorValue{Vec3d(0.95), "acescg"},
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "asymmetry",
             .type = T::number,
             .doc = "Mean cosine of its scattering: towards 1 the air shines around the sun.",
             .fallback = 0.7,
             .minimum = -0.99,
             .maximum = 0.99},
            {.name = "angstrom_exponent",
             .type = T::number,
             .doc = "Extinction goes as wavelength to its negative: 1.3 dust and smoke, which turn distance blue; 0 fog, white.",
             .fallback = 1.3,
             .minimum = 0.0,
             .maximum = 4.0},
        }};
    return schema;
}

}  // namespace hoodoo
