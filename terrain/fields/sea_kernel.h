// The breaking sea at eight points at once: swell, waves and white water, in SIMD lanes.
#pragma once

#include "terrain/fields/breaker.h"
#include "terrain/fields/swell.h"

#include <span>

namespace hoodoo
{

/// What the lanes need of a sea; the spans must outlive it.
struct SeaLanes {
    static constexpr int count = 8;

    std::span<const Breaker> breakers;
    std::span<const Swell> trains;
    SwellFade fade;
    double highest = 0.0;  ///< no swell is higher or lower
    double level = 0.0;
};

struct SeaPoints {
    alignas(64) double x[SeaLanes::count], y[SeaLanes::count], z[SeaLanes::count];
};

/// F of each point at the time t (BreakingSea::value up to rounding), the same bits on every instruction set. Finite points only.
void sea_values(const SeaLanes& sea, const SeaPoints& points, double t, double* values);

}  // namespace hoodoo
