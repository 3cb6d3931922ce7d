// A stream of random numbers that depends on nothing but its seed.
#pragma once

#include "terrain/math/hash.h"
#include "terrain/math/vec.h"

namespace hoodoo::testing
{

class Numbers
{
public:
    explicit Numbers(std::uint64_t seed) : h_(seed) {}
    Numbers(std::uint64_t seed, std::uint64_t n) : h_(hash_cell(seed, static_cast<std::int64_t>(n), 3)) {}

    double operator()() { return unit_real(h_ = mix64(h_)); }  ///< in [0, 1)
    double between(double a, double b) { return a + (b - a) * (*this)(); }
    Vec3d in(const Box3d& b)
    {
        const double x = between(b.min.x, b.max.x), y = between(b.min.y, b.max.y), z = between(b.min.z, b.max.z);
        return {x, y, z};
    }
    /// Uniform on the unit sphere.
    Vec3d direction()
    {
        const double z = between(-1.0, 1.0), phi = between(0.0, 6.283185307179586), r = std::sqrt(1.0 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

private:
    std::uint64_t h_;
};

}  // namespace hoodoo::testing
