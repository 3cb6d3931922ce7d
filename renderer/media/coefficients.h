// What an even medium does to light along a metre, and how far a ray gets in it.
#pragma once

#include "terrain/schema.h"

#include <functional>
#include <string>
#include <vector>

namespace hoodoo
{

/// In the rendering space, 1/m where the medium has its full density.
struct Coefficients {
    Vec3d absorption{0.0}, scattering{0.0};
    double asymmetry = 0.0;  ///< mean cosine of scattering
};

/// A random flight: up to a collision that scatters, or through.
struct Flight {
    double column = 0.0;  ///< metres of full density flown
    bool scattered = false;
    Vec3f weight{1.0f};  ///< of the path; its mean over flights is the transmittance plus what is scattered on the way
};

/// `column`: metres of full density that lie ahead, may be infinite. `u` in [0, 1)^2. Collisions that absorb are in the weight.
Flight fly(const Coefficients& medium, double column, const Vec2d& u);

/// exp(-(absorption + scattering) column); an infinite column of nothing lets all through.
Vec3f transmittance(const Coefficients& medium, double column);

/// A colour as written in the scene -> the rendering space.
using ColorConversion = std::function<Vec3f(const ColorValue&)>;

/// Names of the waters below: "clear", "coastal", "deep".
const std::vector<std::string>& water_names();

/// Water of that name. Precondition: one of water_names().
Coefficients water_coefficients(const std::string& name, const ColorConversion& to_rendering);

/// An absorption (1/m) in a colour space -> the rendering space, such that white light has the converted colour after the mean free path of the three
/// given channels: coefficients of colour spaces differ by no matrix, since channels mix in sums and absorption multiplies.
Vec3d converted_absorption(const ColorValue& absorption, const ColorConversion& to_rendering);

}  // namespace hoodoo
