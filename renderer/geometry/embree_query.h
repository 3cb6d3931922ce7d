// What travels with one ray through Embree to our callbacks. Only for the files that include Embree.
#pragma once

#include "renderer/geometry/tracer.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

namespace hoodoo
{

/// One query. The callbacks work on the caller's ray in double precision, not on Embree's copy.
struct Query {
    RTCIntersectContext embree;  // must come first: Embree hands back a pointer to it
    const Ray* ray = nullptr;
    double shift = 0.0;  ///< Embree's ray starts this far along the caller's ray
    Hit hit;
    std::uint32_t object = 0;
    std::uint32_t instance = kNoInstance;
    Vec2d barycentric{0.0};  ///< of a hit on an instance
};

// Outwards by one unit in the last place at least, without a call; the smallest normal number stands in for zero's neighbours.
inline float round_up(double x)
{
    const auto f = static_cast<float>(x);
    return f + std::abs(f) * 0x1p-23f + std::numeric_limits<float>::min();
}
inline float round_down(double x)
{
    const auto f = static_cast<float>(x);
    return f - std::abs(f) * 0x1p-23f - std::numeric_limits<float>::min();
}

/// Throws Error (memory, internal) if Embree has something to report.
void check_embree(RTCDevice device);

}  // namespace hoodoo
