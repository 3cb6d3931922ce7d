// Octaves of solid noise that run over the water as waves of their length do, each in a direction of its own about the wind's.
// Gamito2001, section 4.2.3: "bump mapped with a three-dimensional procedural texture to simulate the small-scale ripples". Octave k has the
// wavelength L / 2.1^k and the height a_k lambda_k n(q / lambda_k), q moving with sqrt(g lambda / 2 pi), the speed of deep water's waves, and slowly
// through the noise, so that crests come and go. With E|grad n|^2 = 0.745 in space (measured over 1e6 points) two thirds of it lie in a plane: a
// slope of variance s^2 needs a^2 = 3 s^2 / (2 * 0.745). Octaves share the variance alike (CHOICE). How much there is: 0.003 + 0.00512 W for a wind
// of W metres a second (Cox1954). Deviation: the lost variance is that of the mean square slope in one direction, half the sum of both.
#include "terrain/fields/ripples.h"

#include "terrain/math/hash.h"
#include "terrain/math/noise.h"
#include "terrain/math/smoothstep.h"

namespace hoodoo
{

namespace
{

constexpr int kOctaves = 6;
constexpr double kShorter = 2.1;          ///< no two octaves share their lattice points
constexpr double kSlopePower = 0.745;     ///< E|grad n|^2
constexpr double kSpeedOfMetre = 1.2494;  ///< sqrt(g / (2 pi)), metres a second at a wavelength of one metre
constexpr double kThrough = 0.25;         ///< share of that speed at which the relief moves through the noise

double kept_of(double wavelength, double footprint)
{
    return footprint > 0.0 ? smoothstep(0.5 * wavelength / footprint - 1.0) : 1.0;
}

}  // namespace

RippleSlope ripple_slope(const RippleShape& shape, const Vec3d& p, double t, double footprint)
{
    RippleSlope out;
    if (!(shape.slope > 0.0)) return out;
    const double variance = shape.slope * shape.slope / kOctaves, steepness = std::sqrt(1.5 * variance / kSlopePower);
    double wavelength = shape.wavelength;
    for (int k = 0; k < kOctaves; ++k, wavelength /= kShorter) {
        const double kept = kept_of(wavelength, footprint);
        out.lost_variance += 0.5 * (1.0 - kept * kept) * variance;
        if (kept == 0.0) continue;
        // Up to a radian to either side of the wind.
        const std::uint64_t bits = hash_combine(shape.seed, static_cast<std::uint64_t>(k));
        const double turn = 2.0 * unit_real(bits) - 1.0, c = std::cos(turn), s = std::sin(turn);
        const double run = kSpeedOfMetre * std::sqrt(wavelength) * t;
        const Vec3d moved(c * shape.wind.x - s * shape.wind.y, s * shape.wind.x + c * shape.wind.y, -kThrough);
        const Vec3d shift(unit_real(mix64(bits)), unit_real(mix64(bits + 1)), unit_real(mix64(bits + 2)));
        const Noise3 n = gradient_noise((p - moved * run) / wavelength + shift * 64.0, static_cast<std::uint32_t>(bits >> 32));
        out.gradient += n.gradient * (steepness * kept);
    }
    return out;
}

}  // namespace hoodoo
