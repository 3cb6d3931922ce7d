// Random numbers of a picture as a pure function of where they are used: (seed, frame, pixel, replicate, sample, set). No state, no order.
#pragma once

#include "terrain/math/hash.h"
#include "terrain/math/vec.h"

#include <array>
#include <cstdint>

namespace hoodoo
{

/// The Owen-scrambled Sobol' points of one pixel. A *set* is four dimensions stratified together; different sets are shuffled against each other.
/// Any number of samples may be taken: powers of two are stratified best, and every prefix of a power of two is a net of its own.
class Sampler
{
public:
    static constexpr unsigned set_size = 4;

    /// `pixel` in display coordinates, so that a crop sees the numbers of the full picture. `replicate`: an independent scrambling.
    Sampler(std::uint64_t seed, std::uint32_t frame, Vec2i pixel, std::uint32_t replicate)
        : key_(hash_combine(hash_cell(seed, pixel.x, pixel.y, frame), replicate))
    {
    }

    void start(std::uint32_t sample) { sample_ = sample; }

    /// Four numbers in [0, 1) for use number `set` of the current sample.
    std::array<double, set_size> get(std::uint32_t set) const;

private:
    std::uint64_t key_;
    std::uint32_t sample_ = 0;
};

/// Point `index` of dimension `dimension` (< 3667) of the Sobol' sequence as 32 fraction bits, unscrambled.
std::uint32_t sobol_bits(std::uint32_t index, unsigned dimension);

/// Scrambles 32 fraction bits so that each bit is flipped by a hash of the bits above it: Owen's nested uniform scrambling.
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed);

}  // namespace hoodoo
