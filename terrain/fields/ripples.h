// Ripples of water: a procedural relief in three dimensions, looked up where the water was before it moved, so that it follows the water.
#pragma once

#include "terrain/math/vec.h"

#include <cstdint>

namespace hoodoo
{

struct RippleShape {
    double slope = 0.08;      ///< root mean square of the slopes of all octaves
    double wavelength = 1.2;  ///< of the longest, metres
    Vec2d wind{1.0, 0.0};     ///< unit: where most of them run
    std::uint32_t seed = 0;
};

/// What of the relief a footprint shows.
struct RippleSlope {
    Vec3d gradient{0.0};         ///< of the height, by the looked-up point, per metre
    double lost_variance = 0.0;  ///< of the slopes (one direction) that it does not show
};

/// `p` in metres, `t` in seconds. An octave is shown in full down to 4 footprints a wavelength and not at all from 2 on.
RippleSlope ripple_slope(const RippleShape& shape, const Vec3d& p, double t, double footprint);

}  // namespace hoodoo
