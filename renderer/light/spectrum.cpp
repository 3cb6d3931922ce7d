// Sunlight as a black body (Planck) scaled to the solar constant, seen through the CIE 1931 observer in the closed form of Wyman2013.
//
//     E(l) = 1361 W/m2 pi B(l, 5778 K) / (sigma T^4),   B = 2 h c^2 / l^5 / (exp(h c / (l k T)) - 1)
//     x(l) = 1.056 g(599.8, 37.9, 31.0) + 0.362 g(442.0, 16.0, 26.7) - 0.065 g(501.1, 20.4, 26.2)   and so on, g: a Gaussian of two halves
// 1361 W/m2: Kopp2011. The matching functions are integrated over each band, so that twelve bands lose none of their narrow lobes.
// The matrix to ACEScg follows from the primaries and the white of Smpte2016 (AP1: .713 .293, .165 .830, .128 .044; D60: .32168 .33767).
// Missing: the Fraunhofer lines; chromatic adaptation (sunlight above the air, 5778 K, is slightly warmer than the white).

#include "renderer/light/spectrum.h"

#include <Imath/ImathMatrix.h>

#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kSolarConstant = 1361.0;   // W/m2
constexpr double kSunTemperature = 5778.0;  // K

double lobe(double x, double middle, double below, double above)
{
    const double t = (x - middle) / (x < middle ? below : above);
    return std::exp(-0.5 * t * t);
}

Vec3d matching_functions(double l)
{
    return Vec3d(1.056 * lobe(l, 599.8, 37.9, 31.0) + 0.362 * lobe(l, 442.0, 16.0, 26.7) - 0.065 * lobe(l, 501.1, 20.4, 26.2),
                 0.821 * lobe(l, 568.8, 46.9, 40.5) + 0.286 * lobe(l, 530.9, 16.3, 31.1),
                 1.217 * lobe(l, 437.0, 11.8, 36.0) + 0.681 * lobe(l, 459.0, 26.0, 13.8));
}

/// Column vectors: XYZ = matrix rgb.
Imath::M33d acescg_to_xyz()
{
    const auto xyz = [](double x, double y) { return Vec3d(x / y, 1.0, (1.0 - x - y) / y); };
    const Vec3d r = xyz(0.713, 0.293), g = xyz(0.165, 0.830), b = xyz(0.128, 0.044), white = xyz(0.32168, 0.33767);
    const Imath::M33d primaries(r.x, g.x, b.x, r.y, g.y, b.y, r.z, g.z, b.z);
    const Imath::M33d inverse = primaries.inverse();
    Vec3d scale;
    for (int k = 0; k < 3; ++k) scale[k] = inverse[k][0] * white.x + inverse[k][1] * white.y + inverse[k][2] * white.z;
    Imath::M33d m = primaries;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) m[i][k] *= scale[k];
    return m;
}

struct Conversion {
    std::array<Vec3d, kWavelengths> to_xyz{};  ///< of one unit per nm in a band
    Imath::M33d to_rgb, from_rgb;

    Conversion() : from_rgb(acescg_to_xyz())
    {
        to_rgb = from_rgb.inverse();
        constexpr int steps = 30;
        double sunlight = 0.0;
        for (int band = 0; band < kWavelengths; ++band) {
            for (int i = 0; i < steps; ++i)
                to_xyz[band] += matching_functions(wavelength(band) + kBandWidth * ((i + 0.5) / steps - 0.5)) * (kBandWidth / steps);
            sunlight += to_xyz[band].y * solar_irradiance(wavelength(band));
        }
        for (Vec3d& v : to_xyz) v *= kSolarConstant / sunlight;
    }
};

const Conversion& conversion()
{
    static const Conversion c;
    return c;
}

}  // namespace

double solar_irradiance(double nanometres)
{
    constexpr double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23, sigma = 5.670374419e-8;  // SI, exact or CODATA
    const double l = nanometres * 1e-9;
    const double planck = 2.0 * h * c * c / std::pow(l, 5) / std::expm1(h * c / (l * k * kSunTemperature));  // W/m2/sr/m
    return kSolarConstant * kPi * planck / (sigma * std::pow(kSunTemperature, 4)) * 1e-9;
}

Vec3d to_acescg(const Spectrum& per_nanometre)
{
    const Conversion& c = conversion();
    Vec3d xyz(0.0), rgb;
    for (int band = 0; band < kWavelengths; ++band) xyz += c.to_xyz[band] * per_nanometre[band];
    for (int k = 0; k < 3; ++k) rgb[k] = c.to_rgb[k][0] * xyz.x + c.to_rgb[k][1] * xyz.y + c.to_rgb[k][2] * xyz.z;
    return rgb;
}

double luminance(const Vec3d& acescg)
{
    const Imath::M33d& m = conversion().from_rgb;
    return m[1][0] * acescg.x + m[1][1] * acescg.y + m[1][2] * acescg.z;
}

}  // namespace hoodoo
