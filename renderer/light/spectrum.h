// Light by wavelength: twelve bands, sunlight above the air, and the way from a spectrum to three channels.
#pragma once

#include "terrain/math/vec.h"

#include <array>

namespace hoodoo
{

constexpr int kWavelengths = 12;
constexpr double kFirstWavelength = 380.0, kBandWidth = 30.0;  ///< nm: bands from 380 to 740

/// One value a band, at the band's middle.
using Spectrum = std::array<double, kWavelengths>;

constexpr double wavelength(int band)
{
    return kFirstWavelength + (band + 0.5) * kBandWidth;
}  ///< nm

/// Sunlight above the air on a facing plane, W/m2/nm: a black body of 5778 K that brings 1361 W/m2 in all.
double solar_irradiance(double nanometres);

/// A spectrum (per nm) in ACEScg, D60. Scaled so that the luminance of sunlight above the air is its whole irradiance, 1361 W/m2: radiometric in the
/// mean of the channels, at the price that light outside the visible is assumed to follow the visible.
Vec3d to_acescg(const Spectrum& per_nanometre);

/// Luminance (CIE Y) of a colour in ACEScg.
double luminance(const Vec3d& acescg);

}  // namespace hoodoo
