// The trilinear function of a plain array of samples, met by rays without a grid, blocks or Bernstein polynomials: in long double, all pieces of it.
#pragma once

#include "terrain/fields/voxel_grid.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace hoodoo::testing
{

/// Samples of F with k fastest; air everywhere around.
struct DenseVoxels {
    Index3 size{};
    double cell = 1.0;
    Vec3d first{0.0};
    float air = 1.0f;
    std::vector<float> values;

    float at(int i, int j, int k) const
    {
        if (i < 0 || j < 0 || k < 0 || i >= size[0] || j >= size[1] || k >= size[2]) return air;
        return values[(static_cast<std::size_t>(i) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                          static_cast<std::size_t>(size[2]) +
                      static_cast<std::size_t>(k)];
    }
    long double value(long double x, long double y, long double z) const;  ///< world space
    VoxelGrid grid() const;                                                ///< the same as what the product keeps, untrimmed
};

/// What is certain of a ray: the first t in (0, t_end) after which F is proved to have changed its side (from beyond +margin to below -margin or the
/// other way; only into matter if `entering`). Pieces between all planes of samples are cubics; their extremes are roots of a quadratic.
std::optional<double> certain_crossing(const DenseVoxels& voxels, const Ray& ray, double t_end, double margin);

/// Kinds of solids that find faults: 0 smooth with caves, 1 random numbers, 2 zeros and ones, 3 many samples exactly at the surface's level.
DenseVoxels hard_voxels(int kind, std::uint64_t seed, const Index3& size);

}  // namespace hoodoo::testing
