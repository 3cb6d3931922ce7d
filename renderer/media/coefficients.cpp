// Flights through an even medium, and the waters of the sea.
//
// Scattering alone is drawn; absorption is a weight, since sea water absorbs far more than it scatters. The channels scatter at different rates: the
// distance is drawn at the rate of a channel chosen at random and weighted by the mean of all three densities (the balance heuristic over channels),
//     collision at s:  w_c = b_c exp(-(a_c + b_c) s) / mean_k b_k exp(-b_k s),       through:  w_c = exp(-(a_c + b_c) s) / mean_k exp(-b_k s),
// so no channel's weight exceeds three and a grey medium's is exp(-a s).
// Waters: absorption of pure water by Pope1997, read at the wavelengths of the sRGB primaries, 611, 549 and 465 nm; scattering of clear and coastal
// ocean by Petzold1972 at 514 nm (0.037 and 0.219 /m, mean cosine 0.924), taken as grey; deep: water without particles, whose molecules scatter
// evenly fore and aft, 0.0019 /m at 550 nm and as wavelength^-4.32 (Morel1974). CHOICE: coastal water is pure water and what plankton and yellow
// matter take: (0.05, 0.02, 0.06) /m. Deviation: of the scattering of particles the share g^2 goes so nearly straight on that it counts as none
// (Joseph1976), b' = b (1 - g^2), g' = g / (1 + g): a fifth of the collisions, the same light through depth, sharper things in turbid water. A
// table's own coefficients are kept.
#include "renderer/media/coefficients.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hoodoo
{
namespace
{

struct Water {
    Vec3d absorption, scattering;  ///< 1/m, lin_rec709
    double asymmetry;
};

constexpr double kParticles = 0.924;  // mean cosine
constexpr double kPureRed = 0.265, kPureGreen = 0.055, kPureBlue = 0.0101;
const std::array<Water, 3> kWaters = {Water{Vec3d(kPureRed, kPureGreen, kPureBlue), Vec3d(0.037), kParticles},
                                      Water{Vec3d(kPureRed + 0.05, kPureGreen + 0.02, kPureBlue + 0.06), Vec3d(0.219), kParticles},
                                      Water{Vec3d(kPureRed, kPureGreen, kPureBlue), Vec3d(0.0012, 0.0019, 0.0039), 0.0}};

/// A colour of a saturated medium may leave the rendering space's gamut; this much light of each channel always passes.
constexpr double kLeastPassing = 1e-4;

double mean(const Vec3d& v)
{
    return (v.x + v.y + v.z) / 3.0;
}

Vec3d passing(const Vec3d& rate, double column)
{
    const auto one = [column](double r) { return r > 0.0 ? std::exp(-r * column) : 1.0; };
    return {one(rate.x), one(rate.y), one(rate.z)};
}

}  // namespace

Flight fly(const Coefficients& medium, double column, const Vec2d& u)
{
    const Vec3d &b = medium.scattering, all = medium.absorption + b;
    const int channel = std::min(static_cast<int>(u.x * 3.0), 2);
    const double free = b[channel] > 0.0 ? -std::log1p(-u.y) / b[channel] : kInfinity;
    if (free < column) {
        const double density = mean(b * passing(b, free));
        return {free, true, Vec3f(b * passing(all, free) / density)};
    }
    const double probability = mean(passing(b, column));
    // Beyond the range of numbers nothing passes in any channel.
    return {column, false, probability > 0.0 ? Vec3f(passing(all, column) / probability) : Vec3f(0.0f)};
}

Vec3f transmittance(const Coefficients& medium, double column)
{
    return Vec3f(passing(medium.absorption + medium.scattering, column));
}

const std::vector<std::string>& water_names()
{
    static const std::vector<std::string> names = {"clear", "coastal", "deep"};
    return names;
}

Vec3d converted_absorption(const ColorValue& absorption, const ColorConversion& to_rendering)
{
    const double rate = mean(absorption.rgb);
    if (!to_rendering || !(rate > 0.0)) return absorption.rgb;
    const Vec3f seen = to_rendering({passing(absorption.rgb, 1.0 / rate), absorption.space}), white = to_rendering({Vec3d(1.0), absorption.space});
    Vec3d result;
    for (int k = 0; k < 3; ++k) {
        const double share = std::clamp(static_cast<double>(seen[k]) / static_cast<double>(white[k]), kLeastPassing, 1.0);
        result[k] = -std::log(share) * rate;
    }
    return result;
}

Coefficients water_coefficients(const std::string& name, const ColorConversion& to_rendering)
{
    const auto& names = water_names();
    const Water& water = kWaters[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
    Coefficients out;
    out.absorption = converted_absorption({water.absorption, "lin_rec709"}, to_rendering);
    out.scattering = to_rendering ? Vec3d(to_rendering({water.scattering, "lin_rec709"})) : water.scattering;
    const double g = water.asymmetry;
    out.scattering *= 1.0 - g * g;
    out.asymmetry = g / (1.0 + g);
    return out;
}

}  // namespace hoodoo
