// As many random numbers as a walk through a medium needs, from one seed: tracking takes an unknown number of them.
#pragma once

#include "terrain/math/hash.h"

namespace hoodoo
{

/// Not for sharing: each path has its own, seeded by the path's place in the picture, so that threads never show.
class NumberStream
{
public:
    explicit NumberStream(std::uint64_t seed) : state_(mix64(seed)) {}
    double operator()() { return unit_real(state_ = mix64(state_)); }  ///< in [0, 1)

private:
    std::uint64_t state_;
};

}  // namespace hoodoo
