// How much slides from one pocket to its lower neighbours in one move: the heart of the stabilisation, a pure function of integers.
#pragma once

#include <cstdint>
#include <span>

namespace hoodoo
{

/// One lower neighbour of a pocket. Heights in units of the stack.
struct Target {
    std::int32_t head;       ///< how far the source's surface stands above it, >= 0
    std::int32_t room;       ///< what it can take
    double threshold;        ///< the head that repose can bear, >= 0
    std::int32_t share = 0;  ///< out: what it gets
};

/// Whether anything moves: the head is over the threshold, there is room, and a unit more on the other side would not just turn the step round.
inline bool slides(const Target& target)
{
    return target.room > 0 && target.head >= 2 && target.head > target.threshold;
}

/// Fills in the shares of targets that all slide; returns their sum, at least 1 and at most `thickness`, which is at least 1. Potential energy falls
/// (slide.cpp).
std::int32_t share_out(std::span<Target> targets, std::int32_t thickness);

}  // namespace hoodoo
