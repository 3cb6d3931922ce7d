// The clear sky against random walks through the same air, and against what is known of skies.
#include "renderer/light/light.h"
#include "tests/counts.h"
#include "tests/laws/photon_atmosphere.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

/// Irradiance of the sky on a horizontal plane at the observer, per nm.
Spectrum diffuse_irradiance(const Atmosphere& air)
{
    Spectrum sum{};
    constexpr int rows = 64, columns = 32;
    for (int i = 0; i < rows; ++i) {
        const double v = (i + 0.5) / rows, e = 0.5 * kPi * v * v, low = static_cast<double>(i) / rows, high = low + 1.0 / rows;
        const double solid_angle = (std::sin(0.5 * kPi * high * high) - std::sin(0.5 * kPi * low * low)) * 2.0 * kPi / columns;
        for (int j = 0; j < columns; ++j) {
            const double azimuth = kPi * (j + 0.5) / columns;
            const Spectrum l = air.radiance(Vec3d(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), std::sin(e)));
            for (int k = 0; k < kWavelengths; ++k) sum[static_cast<std::size_t>(k)] += l[static_cast<std::size_t>(k)] * std::sin(e) * solid_angle;
        }
    }
    return sum;
}

double degrees(double x)
{
    return x * kPi / 180.0;
}

TEST(Sky, energy_is_that_of_random_walks)
{
    // The sky's energy over all walked bands within 5%: each band's walks have a standard error of 1.5 to 4% here, so the sum over bands is tested
    // at 5% and each band at 5% plus four standard errors.
    const int walks = testing::count(10000, 400000);
    for (const double haze : {0.1, 0.4}) {
        AtmosphereParameters parameters;
        parameters.aerosol = haze;
        for (const double elevation : {60.0, 20.0, 3.0}) {
            const double sine = std::sin(degrees(elevation));
            const Atmosphere air(parameters, sine);
            const Spectrum mine = diffuse_irradiance(air);
            double sum = 0.0, walked_sum = 0.0;
            for (const std::size_t band : {0u, 3u, 6u, 9u}) {
                double error = 0.0;
                const double sun = solar_irradiance(wavelength(static_cast<int>(band)));
                const double walked = sun * testing::PhotonAtmosphere(parameters, sine, static_cast<int>(band)).diffuse_irradiance(walks, 7, error);
                EXPECT_NEAR(mine[band], walked, 0.05 * walked + 4.0 * sun * error)
                    << "haze " << haze << ", sun at " << elevation << ", band " << band;
                sum += mine[band], walked_sum += walked;
            }
            EXPECT_NEAR(sum, walked_sum, 0.05 * walked_sum) << "haze " << haze << ", sun at " << elevation;
        }
    }
}

TEST(Sky, a_missing_multiple_scattering_would_be_seen)
{
    // The mutant of the law: walks that end after their first scattering have lost more than 5%.
    AtmosphereParameters parameters;
    double error = 0.0;
    const double sine = std::sin(degrees(20.0));
    testing::PhotonAtmosphere walks(parameters, sine, 0);
    walks.max_events = 1;
    const double once = walks.diffuse_irradiance(20000, 7, error) * solar_irradiance(wavelength(0));
    EXPECT_LT(once, 0.9 * diffuse_irradiance(Atmosphere(parameters, sine))[0]);
}

TEST(Sky, the_diffuse_share_under_a_high_sun_is_that_of_clear_days)
{
    const double sine = std::sin(degrees(60.0));
    const Atmosphere air(AtmosphereParameters{}, sine);
    const double diffuse = luminance(to_acescg(diffuse_irradiance(air))), direct = luminance(to_acescg(air.sun_irradiance())) * sine;
    EXPECT_GT(diffuse / (diffuse + direct), 0.08);
    EXPECT_LT(diffuse / (diffuse + direct), 0.20);
}

TEST(Sky, under_a_low_sun_the_zenith_is_bluer_than_the_horizon_below_it)
{
    const Vec3d sun = compass_direction(degrees(5.0), 0.7);
    const SkyTable sky(AtmosphereParameters{}, sun, [](const Vec3d& c) { return Vec3f(c); });
    const Vec3f zenith = sky.radiance(Vec3d(0, 0, 1)), horizon = sky.radiance(compass_direction(degrees(0.5), 0.7));
    EXPECT_GT(zenith.z / zenith.x, 1.5 * horizon.z / horizon.x);
}

TEST(Sky, a_table_shows_what_the_air_does)
{
    const double elevation = degrees(30.0);
    const Atmosphere air(AtmosphereParameters{}, std::sin(elevation));
    const SkyTable sky(AtmosphereParameters{}, compass_direction(elevation, 0.0), [](const Vec3d& c) { return Vec3f(c); });
    for (const double e : {2.0, 25.0, 60.0, 85.0, -3.0, -40.0}) {
        for (const double azimuth : {5.0, 90.0, 170.0}) {
            const double c = std::cos(degrees(e)), s = std::sin(degrees(e));
            const Vec3d exact = to_acescg(air.radiance(Vec3d(c * std::cos(degrees(azimuth)), c * std::sin(degrees(azimuth)), s)));
            EXPECT_NEAR(sky.radiance(compass_direction(degrees(e), degrees(azimuth))).y, exact.y, 0.02 * exact.y) << e << " " << azimuth;
            EXPECT_EQ(sky.radiance(compass_direction(degrees(e), degrees(azimuth))), sky.radiance(compass_direction(degrees(e), degrees(-azimuth))))
                << "both sides alike";
        }
    }
}

TEST(Sky, optical_depths_are_those_of_the_literature)
{
    // Bodhaine1999: 0.0972 at 550 nm and sea level; our band lies at 545 nm and the depth goes nearly as wavelength^-4.08 there.
    const AirCoefficients c = Atmosphere(AtmosphereParameters{}, 0.5).coefficients();
    const double at_545 = c.rayleigh[5] * 8436.0;
    EXPECT_NEAR(at_545 * std::pow(545.0 / 550.0, 4.08), 0.0972, 0.001);
    EXPECT_NEAR(c.aerosol_extinction[5] * 1200.0 * std::pow(545.0 / 550.0, 1.3), 0.1, 1e-6);
}

TEST(Sky, sunlight_above_the_air_is_the_solar_constant_and_nearly_white)
{
    Spectrum s;
    for (int i = 0; i < kWavelengths; ++i) s[static_cast<std::size_t>(i)] = solar_irradiance(wavelength(i));
    const Vec3d rgb = to_acescg(s);
    EXPECT_NEAR(luminance(rgb), 1361.0, 1e-6);
    // A black body of 5778 K lies near D60: channels within 6% of each other.
    EXPECT_NEAR(rgb.x / rgb.y, 1.0, 0.06);
    EXPECT_NEAR(rgb.z / rgb.y, 1.0, 0.06);
    // Planck integrates to the solar constant.
    double sum = 0.0;
    for (double l = 50.5; l < 30000.0; l += 1.0) sum += solar_irradiance(l);
    EXPECT_NEAR(sum, 1361.0, 1.0);
}

}  // namespace
}  // namespace hoodoo
