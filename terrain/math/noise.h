// Gradient noise and sums of it: value, exact derivative, proved bounds. Terrains and looks share it, so that a stain can follow a ridge.
#pragma once

#include "terrain/math/vec.h"

#include <cstdint>

namespace hoodoo
{

/// A lattice point's random bits (maths of the golden values: three odd multipliers, then the lowbias32 mixing of Ellis2018).
constexpr std::uint32_t lattice_hash(std::uint32_t ix, std::uint32_t iy, std::uint32_t seed)
{
    std::uint32_t h = (ix * 0x8DA6B343u) ^ (iy * 0xD8163841u) ^ (seed * 0xCB1AB31Fu);
    h = (h ^ (h >> 16)) * 0x7FEB352Du;
    h = (h ^ (h >> 15)) * 0x846CA68Bu;
    return h ^ (h >> 16);
}

/// A noise and its derivative in the coordinates it was asked for. Zero at lattice points, period none, C2.
struct Noise1 {
    double value = 0.0, slope = 0.0;
};
struct Noise2 {
    double value = 0.0;
    Vec2d gradient{0.0};
};
struct Noise3 {
    double value = 0.0;
    Vec3d gradient{0.0};
};

/// Gradient noise with unit gradients (1-D: slopes in [-1, 1]) and quintic fade (Perlin2002); one cell = one unit of length. Non-finite coordinates
/// give 0.
Noise1 gradient_noise(double x, std::uint32_t seed);
Noise2 gradient_noise(const Vec2d& p, std::uint32_t seed);
Noise3 gradient_noise(const Vec3d& p, std::uint32_t seed);

/// |value| <= bound and |gradient| <= slope, for all gradients (noise.cpp derives them).
struct NoiseBound {
    double value, slope;
};
constexpr NoiseBound kNoise1Bound{0.5, 1.3472};
constexpr NoiseBound kNoise2Bound{0.7072, 2.0692};
constexpr NoiseBound kNoise3Bound{0.8661, 2.7923};

/// How octaves are added: octave k has frequency lacunarity^k, amplitude gain^k, its own seed, shift and (2-D, 3-D) rotation. `octaves` may be a
/// fraction: the last one is then faded in, which is how a sum is cut off at a footprint without a jump. At most 24 octaves are added.
struct Fractal {
    double octaves = 6.0;
    double lacunarity = 2.0;
    double gain = 0.5;
};

/// Sum of the octaves; the first has the amplitude of the noise itself.
Noise2 fbm(const Vec2d& p, std::uint32_t seed, const Fractal& fractal);
Noise3 fbm(const Vec3d& p, std::uint32_t seed, const Fractal& fractal);
/// What octave k adds to fbm(), its amplitude included. 0 <= k < fractal.octaves.
Noise2 fbm_octave(const Vec2d& p, std::uint32_t seed, const Fractal& fractal, int k);

/// Sum of (1 - |n| / bound)^2 over the octaves: sharp crests. Values in [0, sum of gain^k]. Only C0 on the crests.
Noise2 ridged(const Vec2d& p, std::uint32_t seed, const Fractal& fractal);
Noise3 ridged(const Vec3d& p, std::uint32_t seed, const Fractal& fractal);

/// The gradient of the 2-D noise at a lattice point: the unit vector at the angle 2 pi hash / 2^32.
Vec2d lattice_gradient(std::uint32_t ix, std::uint32_t iy, std::uint32_t seed);

/// Bounds of the sums, from those of one octave: value * sum gain^k, slope * sum (gain lacunarity)^k.
NoiseBound fbm_bound(const NoiseBound& octave, const Fractal& fractal);
NoiseBound ridged_bound(const NoiseBound& octave, const Fractal& fractal);

}  // namespace hoodoo
