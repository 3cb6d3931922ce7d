// Sunlight in clear air on a round planet: single scattering exactly along each line of sight, all further orders by iteration.
//
// Air, relative densities over the height h:  molecules exp(-h / 8436 m),  haze exp(-h / H),  ozone a tent from 10 over 25 to 40 km (Bruneton2017).
//   Molecules: cross section 24 pi^3 (n^2 - 1)^2 / (l^4 N^2 (n^2 + 2)^2) F (Bodhaine1999), n of standard air by Peck1972, King factor F = 1.049;
//     8436 m is the height that the column p / (m g) = 2.149e29 /m2 has at the density N = 2.546899e25 /m3. Phase 3 / (16 pi) (1 + c^2).
//   Haze: depth ~ l^-exponent (Angstrom1929), phase of Henyey1941.
//   Ozone: one Gaussian for the Chappuis band, 5.1e-25 m2 at 594 nm, width 55 nm: our fit, within 20% of Gorshelev2014 from 450 to 700 nm.
// Light: L(w) = integral of T (sigma_s phase T_sun + sigma_s M) + ground, T = exp(-depth). M is the mean radiance of light scattered at least once:
//     M_1 = mean over directions of singly scattered and once reflected light,   M_(n+1) = mean of the light that M_n scatters and the ground
//     reflects,
//   iterated on a grid over height and the sun's elevation; the tail is summed as a geometric series. So the second and later scatterings are taken
//   as isotropic (as in Hillaire2020, which also takes M as equal everywhere). Haze scatters forwards: of its scattering of light that has been
//   scattered before, the share g (the mean cosine) counts as no event and (1 - g) as isotropic, which keeps the mean cosine (Joseph1976). Without
//   this the energy is 15% low in thick haze; tests/laws measure it against random walks.
// Depths come from a table of columns, one number a component, in the coordinates of Bruneton2017.
// Missing: refraction, polarisation, clouds, the Earth's flattening, twilight colours below -6 degrees.

#include "renderer/light/atmosphere.h"

#include "terrain/math/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kRayleighHeight = 8436.0;
constexpr double kGround = Atmosphere::ground_radius, kTop = kGround + Atmosphere::thickness;

constexpr int kColumnRadii = 48, kColumnSines = 256, kColumnSteps = 40;
constexpr int kNodeHeights = 12, kNodeSuns = 9;
constexpr double kSunStep = 3.0 * kPi / 180.0;  // between suns of the grid: +-12 degrees cover all of the air that is in view
constexpr int kPolar = 10, kAzimuths = 5, kOrders = 5;
constexpr int kViewSteps = 40, kNodeSteps = 16;

double distance_to_top(double r, double sine)
{
    return -r * sine + std::sqrt(std::max(0.0, r * r * (sine * sine - 1.0) + kTop * kTop));
}

/// Infinite if the line misses the ground.
double distance_to_ground(double r, double sine)
{
    const double d = r * r * (sine * sine - 1.0) + kGround * kGround;
    return sine < 0.0 && d >= 0.0 ? std::max(0.0, -r * sine - std::sqrt(d)) : kInfinity;
}

double rayleigh_coefficient(double nanometres)
{
    constexpr double density = 2.546899e25, king = 1.049;
    const double l = nanometres * 1e-9, s2 = 1e6 / (nanometres * nanometres);  // 1/um^2
    const double n = 1.0 + 1e-8 * (8060.51 + 2480990.0 / (132.274 - s2) + 17455.7 / (39.32957 - s2));
    const double a = (n * n - 1.0) / (n * n + 2.0);
    return 24.0 * std::pow(kPi, 3) * a * a / (std::pow(l, 4) * density) * king;
}

double ozone_cross_section(double nanometres)
{
    const double t = (nanometres - 594.0) / 55.0;
    return 5.1e-25 * std::exp(-0.5 * t * t);
}

template <class Visit>
void for_each_band(Visit&& visit)
{
    for (int i = 0; i < kWavelengths; ++i) visit(i);
}

/// exp of each band for x in [-700, 0] (below: as -700), to 2e-14: x = k ln 2 + r, |r| <= ln 2 / 2, a Taylor polynomial in r. Without branches, so
/// that the compiler does several bands at once.
Spectrum exponential(const Spectrum& x)
{
    Spectrum y;
    for_each_band([&](int i) {
        const double a = std::max(-700.0, x[i]), shifted = a * 1.4426950408889634 + 0x1.8p52;  // the sum's low bits are the rounded k
        const double k = shifted - 0x1.8p52, r = (a - k * 0x1.62e42fee00000p-1) - k * 0x1.a39ef35793c76p-33;
        double p = 1.0 / 39916800.0;
        for (const double c :
             {1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0})
            p = p * r + c;
        y[i] = p * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
    });
    return y;
}

/// Position in a row of `n` nodes -> lower node and share of the upper one.
struct Between {
    int node;
    double share;
    Between(double x, int n)
    {
        const double clamped = std::clamp(x, 0.0, static_cast<double>(n - 1));
        node = std::min(static_cast<int>(clamped), n - 2);
        share = clamped - node;
    }
};

}  // namespace

double Atmosphere::rayleigh_phase(double c)
{
    return 3.0 / (16.0 * kPi) * (1.0 + c * c);
}

double Atmosphere::aerosol_phase(double c, double g)
{
    const double d = 1.0 + g * g - 2.0 * g * c;
    return (1.0 - g * g) / (4.0 * kPi * d * std::sqrt(d));
}

AirColumns Atmosphere::density(const AtmosphereParameters& parameters, double height)
{
    return {std::exp(-height / kRayleighHeight), std::exp(-height / parameters.aerosol_height), std::max(0.0, 1.0 - std::abs(height - 25e3) / 15e3)};
}

Atmosphere::Atmosphere(const AtmosphereParameters& parameters, double sun_sine) : parameters_(parameters)
{
    sun_ = Vec3d(std::sqrt(std::max(0.0, 1.0 - sun_sine * sun_sine)), 0.0, sun_sine);
    for_each_band([&](int i) {
        const double l = wavelength(i);
        coefficients_.rayleigh[i] = rayleigh_coefficient(l);
        coefficients_.aerosol_extinction[i] = parameters.aerosol * std::pow(l / 550.0, -parameters.angstrom_exponent) / parameters.aerosol_height;
        coefficients_.aerosol_scattering[i] = coefficients_.aerosol_extinction[i] * parameters.aerosol_albedo;
        coefficients_.ozone[i] = ozone_cross_section(l) * parameters.ozone * 2.6867e20 / 15e3;  // a Dobson unit in molecules/m2; the tent's area in m
    });
    sun_elevation_ = std::asin(std::clamp(sun_sine, -1.0, 1.0));
    forward_ = std::max(0.0, parameters.aerosol_asymmetry);
    make_columns();
    make_multiple();
}

/// `forward`: the share of haze's scattering that counts as no event.
Spectrum Atmosphere::extinction(const AirColumns& c, double forward) const
{
    Spectrum depth;
    for_each_band([&](int i) {
        const double haze = coefficients_.aerosol_extinction[i] - forward * coefficients_.aerosol_scattering[i];
        depth[i] = coefficients_.rayleigh[i] * c.rayleigh + haze * c.aerosol + coefficients_.ozone[i] * c.ozone;
    });
    return depth;
}

void Atmosphere::make_columns()
{
    columns_.resize(kColumnRadii * kColumnSines);
    const double horizon = std::sqrt(kTop * kTop - kGround * kGround);
    parallel_items(kColumnRadii, [&](int a) {
        const double rho = horizon * a / (kColumnRadii - 1), r = std::sqrt(rho * rho + kGround * kGround);
        for (int b = 0; b < kColumnSines; ++b) {
            const double d = std::max(1.0, kTop - r + (rho + horizon - (kTop - r)) * b / (kColumnSines - 1));
            const double sine = std::clamp((kTop * kTop - r * r - d * d) / (2.0 * r * d), -1.0, 1.0);
            // From the lowest point of the line outwards, steps growing with the distance from it.
            const double lowest = std::clamp(-r * sine, 0.0, d);
            AirColumns sum;
            for (const double end : {0.0, d}) {
                for (int i = 0; i < kColumnSteps; ++i) {
                    const double u = (i + 0.5) / kColumnSteps, t = lowest + (end - lowest) * u * u;
                    const double step = std::abs(end - lowest) * 2.0 * u / kColumnSteps;
                    const AirColumns here = density(parameters_, std::sqrt(r * r + t * t + 2.0 * r * t * sine) - kGround);
                    sum.rayleigh += here.rayleigh * step, sum.aerosol += here.aerosol * step, sum.ozone += here.ozone * step;
                }
            }
            columns_[a * kColumnSines + b] = sum;
        }
    });
}

AirColumns Atmosphere::columns_to_space(double r, double sine) const
{
    const double horizon = std::sqrt(kTop * kTop - kGround * kGround), rho = std::sqrt(std::max(0.0, r * r - kGround * kGround));
    const double nearest = kTop - r, furthest = rho + horizon;
    const Between a(rho / horizon * (kColumnRadii - 1), kColumnRadii);
    const Between b((distance_to_top(r, sine) - nearest) / (furthest - nearest) * (kColumnSines - 1), kColumnSines);
    AirColumns sum;
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            const AirColumns& c = columns_[(a.node + i) * kColumnSines + b.node + j];
            const double w = (i ? a.share : 1.0 - a.share) * (j ? b.share : 1.0 - b.share);
            sum.rayleigh += w * c.rayleigh, sum.aerosol += w * c.aerosol, sum.ozone += w * c.ozone;
        }
    }
    return sum;
}

Spectrum Atmosphere::sun_at(double r, double sine) const
{
    Spectrum t{};
    if (std::isfinite(distance_to_ground(r, sine))) return t;
    const Spectrum depth = extinction(columns_to_space(r, sine), 0.0);
    for_each_band([&](int i) { t[i] = -depth[i]; });
    return exponential(t);
}

/// Adds up T * source(position, radius, densities, ground) along a line until space or the ground; `source` is what a metre of air sends towards the
/// origin (W/m2/sr/nm/m per unit of solar irradiance) or, with `ground`, what the ground sends.
template <class Source>
Spectrum Atmosphere::march(const Vec3d& origin, const Vec3d& w, int steps, Source&& source) const
{
    const double r0 = origin.length(), sine = origin.dot(w) / r0;
    const double ground = distance_to_ground(r0, sine), end = std::min(distance_to_top(r0, sine), ground);
    Spectrum sum{}, transmitted;
    transmitted.fill(1.0);
    for (int i = 0; i < steps; ++i) {
        const double u = (i + 0.5) / steps, step = end * 2.0 * u / steps;
        const Vec3d p = origin + w * (end * u * u);
        const double r = std::max(kGround, p.length());
        const AirColumns here = density(parameters_, r - kGround);
        const Spectrum depth = extinction(here, forward_), sent = source(p, r, here, false);
        Spectrum t;
        for_each_band([&](int k) { t[k] = -depth[k] * step; });
        t = exponential(t);
        for_each_band([&](int k) {
            // The source is even within a step, the extinction too: the integral over the step in closed form.
            sum[k] += transmitted[k] * sent[k] * (depth[k] * step > 1e-6 ? (1.0 - t[k]) / depth[k] : step);
            transmitted[k] *= t[k];
        });
    }
    if (std::isfinite(ground)) {
        const Vec3d p = origin + w * end;
        const Spectrum sent = source(p, kGround, AirColumns{}, true);
        for_each_band([&](int k) { sum[k] += transmitted[k] * sent[k]; });
    }
    return sum;
}

/// What singly scattered light is made of: per unit of solar irradiance, towards an observer in direction -w.
Spectrum Atmosphere::first_order(const Vec3d& p, double r, const Vec3d& w, const AirColumns& here, bool ground) const
{
    const double sine = p.dot(sun_) / p.length(), c = w.dot(sun_);
    Spectrum sent = sun_at(r, sine);
    if (ground) {
        for (double& x : sent) x *= parameters_.ground_albedo / kPi * std::max(0.0, sine);
        return sent;
    }
    const double molecules = here.rayleigh * rayleigh_phase(c), haze = here.aerosol * aerosol_phase(c, parameters_.aerosol_asymmetry);
    for_each_band([&](int i) { sent[i] *= coefficients_.rayleigh[i] * molecules + coefficients_.aerosol_scattering[i] * haze; });
    return sent;
}

/// What is scattered or reflected of light that has been scattered before.
Spectrum Atmosphere::next_order(const Field& field, const Vec3d& p, double r, const AirColumns& here, bool ground) const
{
    const double elevation = std::asin(std::clamp(p.dot(sun_) / p.length(), -1.0, 1.0)) - sun_elevation_;
    const Between s(elevation / kSunStep + (kNodeSuns - 1) / 2, kNodeSuns);
    const Between h(std::sqrt(std::max(0.0, r - kGround) / thickness) * (kNodeHeights - 1), kNodeHeights);
    Spectrum sum{};
    for (int j = 0; j < 2; ++j) {
        const double ws = j ? s.share : 1.0 - s.share;
        if (ground) {
            for_each_band([&](int k) { sum[k] += ws * field.ground[s.node + j][k] * parameters_.ground_albedo / kPi; });
            continue;
        }
        for (int i = 0; i < 2; ++i) {
            const Spectrum& m = field.mean[(h.node + i) * kNodeSuns + s.node + j];
            const double w = ws * (i ? h.share : 1.0 - h.share);
            for_each_band([&](int k) { sum[k] += w * m[k]; });
        }
    }
    if (!ground)
        for_each_band([&](int k) {
            sum[k] *= coefficients_.rayleigh[k] * here.rayleigh + (1.0 - forward_) * coefficients_.aerosol_scattering[k] * here.aerosol;
        });
    return sum;
}

/// Mean radiance and ground irradiance of the light that `previous` (nullptr: the sun) sends.
Atmosphere::Field Atmosphere::next_field(const Field* previous) const
{
    Field field;
    field.mean.resize(kNodeHeights * kNodeSuns);
    field.ground.resize(kNodeSuns);
    parallel_items(kNodeHeights * kNodeSuns, [&](int node) {
        const double x = static_cast<double>(node / kNodeSuns) / (kNodeHeights - 1);
        // The node lies above the place where the sun stands kSunStep, 2 kSunStep ... higher or lower: turn the place, not the sun.
        const double turn = (node % kNodeSuns - (kNodeSuns - 1) / 2) * kSunStep;
        const Vec3d vertical(std::sin(turn), 0.0, std::cos(turn)), ahead(std::cos(turn), 0.0, -std::sin(turn)), side(0.0, 1.0, 0.0);
        const Vec3d origin = vertical * (kGround + thickness * x * x);
        Spectrum mean{}, irradiance{};
        for (int a = 0; a < 2 * kPolar; ++a) {
            const bool upper = a < kPolar;
            const double v = (a % kPolar + 0.5) / kPolar, low = static_cast<double>(a % kPolar) / kPolar, high = low + 1.0 / kPolar;
            const double sine = (upper ? 1.0 : -1.0) * std::sin(0.5 * kPi * v * v);
            const double share = (std::sin(0.5 * kPi * high * high) - std::sin(0.5 * kPi * low * low)) / (2.0 * kAzimuths);
            for (int b = 0; b < kAzimuths; ++b) {
                const double azimuth = kPi * (b + 0.5) / kAzimuths, cosine = std::sqrt(1.0 - sine * sine);
                const Vec3d w = ahead * (cosine * std::cos(azimuth)) + side * (cosine * std::sin(azimuth)) + vertical * sine;
                const Spectrum seen = march(origin, w, kNodeSteps, [&](const Vec3d& p, double r, const AirColumns& here, bool ground) {
                    return previous ? next_order(*previous, p, r, here, ground) : first_order(p, r, w, here, ground);
                });
                for_each_band([&](int k) {
                    mean[k] += share * seen[k];
                    if (upper) irradiance[k] += 4.0 * kPi * share * sine * seen[k];
                });
            }
        }
        field.mean[node] = mean;
        if (node < kNodeSuns) field.ground[node] = irradiance;
    });
    return field;
}

void Atmosphere::make_multiple()
{
    Field last = next_field(nullptr);
    scattered_ = last;
    const auto add = [](std::vector<Spectrum>& to, const std::vector<Spectrum>& before, const std::vector<Spectrum>& now, bool tail) {
        for (std::size_t n = 0; n < to.size(); ++n) {
            for_each_band([&](int k) {
                const double ratio = before[n][k] > 0.0 ? std::min(0.9, now[n][k] / before[n][k]) : 0.0;
                to[n][k] += tail ? now[n][k] / (1.0 - ratio) : now[n][k];
            });
        }
    };
    for (int order = 2; order <= kOrders; ++order) {
        Field next = next_field(&last);
        add(scattered_.mean, last.mean, next.mean, order == kOrders);
        add(scattered_.ground, last.ground, next.ground, order == kOrders);
        last = std::move(next);
    }
}

Spectrum Atmosphere::radiance(const Vec3d& w) const
{
    const Vec3d origin(0.0, 0.0, kGround + std::max(1.0, parameters_.altitude));
    Spectrum seen = march(origin, w, kViewSteps, [&](const Vec3d& p, double r, const AirColumns& here, bool ground) {
        Spectrum sent = first_order(p, r, w, here, ground);
        const Spectrum more = next_order(scattered_, p, r, here, ground);
        for_each_band([&](int k) { sent[k] += more[k]; });
        return sent;
    });
    for_each_band([&](int k) { seen[k] *= solar_irradiance(wavelength(k)); });
    return seen;
}

Spectrum Atmosphere::sun_irradiance() const
{
    Spectrum e = sun_at(kGround + std::max(1.0, parameters_.altitude), sun_.z);
    for_each_band([&](int k) { e[k] *= solar_irradiance(wavelength(k)); });
    return e;
}

}  // namespace hoodoo
