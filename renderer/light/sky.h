// A clear sky as seen from one place at one position of the sun: a table of radiance, sampled by importance.
#pragma once

#include "renderer/light/atmosphere.h"
#include "terrain/math/vec.h"

#include <functional>
#include <memory>
#include <vector>

namespace hoodoo
{

/// Radiance of the sky and, below the horizon, of the sunlit ground of the planet. Immutable, thread-safe.
class SkyTable
{
public:
    using ToRendering = std::function<Vec3f(const Vec3d& acescg)>;

    /// `sun`: unit vector towards the sun. Takes a fraction of a second of one core; runs on the current TBB arena.
    SkyTable(const AtmosphereParameters& parameters, const Vec3d& sun, const ToRendering& to_rendering);

    /// W/m2/sr a channel, bilinear between directions, not across the horizon. `w` unit.
    Vec3f radiance(const Vec3d& w) const;

    /// Directions above the horizon, by the table's luminance. Density per steradian, 0 below the horizon.
    Vec3d sample(const Vec2d& u) const;
    double pdf(const Vec3d& w) const;

    /// Of the sunlight that arrives, on a plane facing the sun, W/m2 a channel in the rendering space.
    const Vec3f& sun_irradiance() const { return sun_irradiance_; }

private:
    static constexpr int kColumns = 64, kUpper = 64, kLower = 16;  ///< columns: azimuths from 0 to pi off the sun; rows: sines, dense at the horizon

    void tabulate(const AtmosphereParameters& parameters, const ToRendering& to_rendering);
    void make_distribution();
    int cell(const Vec3d& w) const;

    Vec3d sun_;
    Vec3d east_, north_;                ///< horizontal frame: north_ towards the sun's azimuth
    std::vector<Vec3f> upper_, lower_;  ///< row by row from the horizon
    std::vector<double> cumulative_;    ///< over the cells of the upper rows
    Vec3f sun_irradiance_{0.0f};
};

}  // namespace hoodoo
