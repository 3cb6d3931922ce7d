// The air: how molecules, haze and ozone scatter and absorb sunlight, wavelength by wavelength, on a round planet.
#pragma once

#include "renderer/light/spectrum.h"
#include "terrain/math/vec.h"

#include <vector>

namespace hoodoo
{

/// Defaults: clear country air at sea level.
struct AtmosphereParameters {
    double aerosol = 0.1;            ///< vertical optical depth of haze from sea level at 550 nm
    double angstrom_exponent = 1.3;  ///< haze depth ~ wavelength^-exponent
    double aerosol_albedo = 0.95;    ///< share of extinction that is scattering
    double aerosol_asymmetry = 0.7;  ///< mean cosine of haze's scattering (Henyey1941)
    double aerosol_height = 1200.0;  ///< scale height of haze, metres
    double ozone = 300.0;            ///< Dobson units
    double ground_albedo = 0.2;      ///< of the planet, every wavelength
    double altitude = 0.0;           ///< of the observer above sea level, metres
};

/// Coefficients at sea level times the density of a component (1 at its reference height): what one point of air does.
struct AirCoefficients {
    Spectrum rayleigh{}, aerosol_scattering{}, aerosol_extinction{}, ozone{};  ///< 1/m
};

/// Relative densities of molecules, haze, ozone at a height above sea level (metres); also their integrals along a path, metres.
struct AirColumns {
    double rayleigh = 0.0, aerosol = 0.0, ozone = 0.0;
};

/// Clear air over a round ground for one height of the sun. Immutable, thread-safe.
class Atmosphere
{
public:
    static constexpr double ground_radius = 6371e3;  ///< mean radius of the Earth, metres
    static constexpr double thickness = 80e3;        ///< above it less than 1e-4 of the air is left

    /// `sun_sine`: sine of the sun's elevation at the observer.
    Atmosphere(const AtmosphereParameters& parameters, double sun_sine);

    /// Radiance seen from the observer along the unit vector `w` in a frame with z up and the sun in the x-z plane (x > 0). W/m2/sr/nm.
    /// The sun's own disc is not part of it.
    Spectrum radiance(const Vec3d& w) const;

    /// Sunlight on a facing plane at the observer, W/m2/nm. Zero if the ground hides the sun.
    Spectrum sun_irradiance() const;

    const AirCoefficients& coefficients() const { return coefficients_; }
    static AirColumns density(const AtmosphereParameters& parameters, double height);
    static double rayleigh_phase(double cosine);                   ///< 1/sr
    static double aerosol_phase(double cosine, double asymmetry);  ///< 1/sr

private:
    /// Scattered light per unit of solar irradiance, over height and the sun's elevation.
    struct Field {
        std::vector<Spectrum> mean;    ///< over all directions, 1/sr
        std::vector<Spectrum> ground;  ///< irradiance of the ground
    };

    Spectrum extinction(const AirColumns& densities, double forward) const;  ///< 1/m; of columns: optical depth
    AirColumns columns_to_space(double radius, double sine) const;           ///< from the table
    Spectrum sun_at(double radius, double sine) const;                       ///< transmittance towards the sun, 0 in the planet's shadow
    Spectrum first_order(const Vec3d& p, double radius, const Vec3d& w, const AirColumns& here, bool ground) const;
    Spectrum next_order(const Field& field, const Vec3d& p, double radius, const AirColumns& here, bool ground) const;
    Field next_field(const Field* previous) const;
    void make_columns();
    void make_multiple();
    template <class Source>
    Spectrum march(const Vec3d& origin, const Vec3d& w, int steps, Source&& source) const;

    AtmosphereParameters parameters_;
    AirCoefficients coefficients_;
    Vec3d sun_;                   ///< in the frame of radiance()
    double sun_elevation_ = 0.0;  ///< radians
    double forward_ = 0.0;        ///< share of haze's scattering that leaves diffuse light its direction
    std::vector<AirColumns> columns_;
    Field scattered_;  ///< all orders from the first
};

}  // namespace hoodoo
