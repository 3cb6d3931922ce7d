// Are two noisy pictures the same light? Pooled statistical tests with a stated rate of false alarms and a stated change that they would find.
#pragma once

#include "renderer/film/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

struct CompareSettings {
    double false_alarm = 1e-6;  ///< chance that two pictures of the same light are called different, over all regions and channels together
    double power = 0.99;        ///< chance that a change of RegionTest::detectable is found
    int block = 16;             ///< pixels: side of the square regions
    int smallest_mask = 64;     ///< pixels: objects and materials that cover fewer are not tested on their own
};

/// The light of one region in one channel: reference against test.
struct RegionTest {
    std::string region;   ///< "picture", "object 2", "material sand", "block 32,16"
    std::string channel;  ///< "R", "G", "B"
    std::int64_t pixels = 0;
    double reference = 0.0;  ///< mean radiance over the region
    double test = 0.0;
    double t = 0.0;            ///< Welch's statistic, signed: positive where the test picture is brighter
    double probability = 1.0;  ///< two-sided: of a larger |t| by noise alone
    double detectable = 0.0;   ///< relative change of the region's light that is found with chance CompareSettings::power
};

struct Comparison {
    bool same = false;
    std::string problem;              ///< why the pictures cannot be compared at all; empty if they can
    std::vector<RegionTest> regions;  ///< most improbable first
    double detectable = 0.0;          ///< of the whole picture, the least sensitive channel

    /// A few lines for a person: the verdict, the worst regions, what would have been found.
    std::string text() const;
};

/// Both pictures need R, G, B, variance.R, variance.G, variance.B and the metadata hoodoo:replicates >= 2 (the variance must be that between
/// replicates). Masks come from the reference's objectId and material.* where it has them. A value that is not finite makes the pictures
/// incomparable.
Comparison compare_statistically(const Image& reference, const Image& test, const CompareSettings& settings = {});

}  // namespace hoodoo
