// Tiles that do not repeat: 256 cubes of seed points, chosen by the colours of their eight corners, that fit together wherever corners agree.
#pragma once

#include "terrain/rocks/sites.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hoodoo
{

/// An endless arrangement of corner cubes (Lagae2006). Memory: 256 lists of points.
class CornerCubes final : public SiteArrangement
{
public:
    /// The least length / radius: regions around opposite corners must not meet.
    static constexpr double least_length = 7.7;

    /// Needs length >= least_length * radius.
    CornerCubes(double length, double radius, std::uint64_t seed);

    std::span<const Site> sites(const Vec3i& tile) const override { return cubes_[code(tile)]; }
    double density() const override { return density_; }

    /// Colours of the corners of a tile: bit dx + 2 dy + 4 dz.
    std::size_t code(const Vec3i& tile) const;
    std::span<const Site> cube(std::size_t code) const { return cubes_[code]; }

private:
    void assemble(std::size_t code);

    std::uint64_t seed_;
    std::array<std::vector<Site>, 2> corner_;                ///< relative to the corner
    std::array<std::array<std::vector<Site>, 4>, 3> edge_;   ///< by axis and colours of its ends; relative to the lower end
    std::array<std::array<std::vector<Site>, 16>, 3> face_;  ///< by normal and colours of its corners; relative to the lowest corner
    std::array<std::vector<Site>, 256> inside_;
    std::array<std::vector<Site>, 256> cubes_;
    double density_ = 0.0;
};

}  // namespace hoodoo
