// The oracle of the clear sky: random walks through the same air, one wavelength at a time, with nothing tabulated and every order of scattering.
#pragma once

#include "renderer/light/atmosphere.h"

#include <cmath>
#include <random>

namespace hoodoo::testing
{

/// Backward walks from the observer. Free paths by null collisions (Woodcock1965), transmittance to the sun by ratio tracking: both unbiased.
class PhotonAtmosphere
{
public:
    PhotonAtmosphere(const AtmosphereParameters& parameters, double sun_sine, int band)
        : parameters_(parameters), sun_(std::sqrt(1.0 - sun_sine * sun_sine), 0.0, sun_sine)
    {
        const Atmosphere air(parameters, sun_sine);  // for its coefficients only
        rayleigh_ = air.coefficients().rayleigh[band];
        scattering_ = air.coefficients().aerosol_scattering[band];
        extinction_ = air.coefficients().aerosol_extinction[band];
        ozone_ = air.coefficients().ozone[band];
        majorant_ = rayleigh_ + extinction_ + ozone_;
    }

    /// Irradiance of the sky on a horizontal plane over that of the sun above the air; standard error in `error`.
    double diffuse_irradiance(int walks, std::uint64_t seed, double& error)
    {
        random_.seed(seed);
        double sum = 0.0, square = 0.0;
        for (int i = 0; i < walks; ++i) {
            const double x = pi * walk(cosine_direction(Vec3d(0, 0, 1)));  // cosine over density is pi
            sum += x, square += x * x;
        }
        const double mean = sum / walks;
        error = std::sqrt(std::max(0.0, square / walks - mean * mean) / walks);
        return mean;
    }

    int max_events = 1000;  ///< collisions a walk

private:
    static constexpr double pi = 3.14159265358979323846;
    double uniform() { return std::uniform_real_distribution<double>()(random_); }

    Vec3d around(const Vec3d& n, double cosine)
    {
        Vec3d t, b;
        orthonormal_frame(n, t, b);
        const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), angle = 2.0 * pi * uniform();
        return (t * (sine * std::cos(angle)) + b * (sine * std::sin(angle)) + n * cosine).normalized();
    }
    Vec3d cosine_direction(const Vec3d& n) { return around(n, std::sqrt(uniform())); }

    /// Distances to the ground and to space; infinite ground if it is missed.
    static void limits(const Vec3d& p, const Vec3d& w, double& ground, double& space)
    {
        const double b = p.dot(w), r2 = p.dot(p), top = Atmosphere::ground_radius + Atmosphere::thickness;
        space = -b + std::sqrt(std::max(0.0, b * b - r2 + top * top));
        const double d = b * b - r2 + Atmosphere::ground_radius * Atmosphere::ground_radius;
        ground = b < 0.0 && d > 0.0 ? std::max(0.0, -b - std::sqrt(d)) : kInfinity;
    }
    AirColumns density(const Vec3d& p) const { return Atmosphere::density(parameters_, std::max(0.0, p.length() - Atmosphere::ground_radius)); }

    double transmittance(const Vec3d& p, const Vec3d& w)
    {
        double ground, space, t = 0.0, left = 1.0;
        limits(p, w, ground, space);
        if (std::isfinite(ground)) return 0.0;
        while (true) {
            t -= std::log(1.0 - uniform()) / majorant_;
            if (t >= space) return left;
            const AirColumns d = density(p + w * t);
            left *= 1.0 - (rayleigh_ * d.rayleigh + extinction_ * d.aerosol + ozone_ * d.ozone) / majorant_;
        }
    }

    /// Radiance along `w`, of one random walk.
    double walk(Vec3d w)
    {
        Vec3d p(0.0, 0.0, Atmosphere::ground_radius + 1.0);
        double sum = 0.0, weight = 1.0;
        for (int event = 0; event < max_events; ++event) {
            double ground, space, t = 0.0;
            limits(p, w, ground, space);
            AirColumns d;
            while (true) {
                t -= std::log(1.0 - uniform()) / majorant_;
                if (t >= std::min(ground, space)) break;
                d = density(p + w * t);
                if (uniform() * majorant_ < rayleigh_ * d.rayleigh + extinction_ * d.aerosol + ozone_ * d.ozone) break;
            }
            if (t >= space && space < ground) return sum;
            if (t >= ground) {
                p = (p + w * ground).normalized() * (Atmosphere::ground_radius + 0.01);
                const Vec3d up = p.normalized();
                weight *= parameters_.ground_albedo;
                sum += weight * std::max(0.0, up.dot(sun_)) / pi * transmittance(p, sun_);
                w = cosine_direction(up);
                continue;
            }
            p += w * t;
            const double molecules = rayleigh_ * d.rayleigh, haze = scattering_ * d.aerosol;
            weight *= (molecules + haze) / (molecules + extinction_ * d.aerosol + ozone_ * d.ozone);
            const bool by_haze = uniform() * (molecules + haze) < haze;
            const double c = w.dot(sun_);
            sum += weight * (by_haze ? Atmosphere::aerosol_phase(c, parameters_.aerosol_asymmetry) : Atmosphere::rayleigh_phase(c)) *
                   transmittance(p, sun_);
            w = around(w, by_haze ? haze_cosine() : molecule_cosine());
        }
        return sum;
    }

    double haze_cosine()
    {
        const double g = parameters_.aerosol_asymmetry, s = (1.0 - g * g) / (1.0 + g - 2.0 * g * uniform());
        return (1.0 + g * g - s * s) / (2.0 * g);
    }
    double molecule_cosine()
    {
        while (true) {
            const double c = 2.0 * uniform() - 1.0;
            if (2.0 * uniform() < 1.0 + c * c) return c;
        }
    }

    AtmosphereParameters parameters_;
    Vec3d sun_;
    double rayleigh_, scattering_, extinction_, ozone_, majorant_;
    std::mt19937_64 random_;
};

}  // namespace hoodoo::testing
