// Haze: air that thins out with height, lit by the same sky and sun as everything else.
#pragma once

#include "renderer/media/coefficients.h"

namespace hoodoo
{

/// Full density at and below `base`, exp(-(z - base) / height) above it. Everywhere, without an edge.
class Haze
{
public:
    Haze(const Coefficients& medium, double base, double height) : medium_(medium), base_(base), height_(height) {}

    const Coefficients& medium() const { return medium_; }

    /// Integral of the density along the first `t` metres of a ray; `t` may be infinite, and so may the result.
    double column(const Vec3d& origin, const Vec3d& direction, double t) const;
    /// The t at which column() reaches `column`; infinite if it never does.
    double distance(const Vec3d& origin, const Vec3d& direction, double column) const;

private:
    double column_above(double height, double rise, double t) const;
    double distance_above(double height, double rise, double column) const;

    Coefficients medium_;
    double base_, height_;
};

/// [haze]: visibility, height, base, albedo, asymmetry, angstrom_exponent. Without `visibility` there is none.
const Schema& haze_schema();

/// Extinction at 550 nm, 1/m, at which a black thing against the horizon loses all but 2% of its contrast in `visibility` metres (Koschmieder1924).
double extinction_of_visibility(double visibility);

}  // namespace hoodoo
