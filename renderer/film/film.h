// Samples in, sums out: the film adds what the light brings, in an order that does not depend on who brought it.
#pragma once

#include "renderer/film/image.h"

#include <array>
#include <span>
#include <vector>

namespace hoodoo {

/// One camera sample: the radiance it saw and what its first hit was. Colours in the rendering space.
struct PixelSample {
    Vec3f radiance{0.0f};          ///< W/m2/sr a channel
    float alpha = 0.0f;            ///< 1 where something was hit
    float z = 0.0f;                ///< distance along the view axis, metres; +inf on a miss
    Vec3f position{0.0f}, shading_normal{0.0f}, geometric_normal{0.0f}, albedo{0.0f};
    std::uint32_t object = 0;      ///< 1-based id of the object, 0 on a miss
    std::uint32_t instance = 0;
    float cost = 0.0f;             ///< field evaluations of the whole path
    std::span<const float> materials;   ///< one share for each FilmLayout::materials
};

struct FilmLayout {
    int width = 0, height = 0;
    PixelBounds data;
    int samples = 0;               ///< a pixel, over all replicates
    int replicates = 1;            ///< independently scrambled repetitions; 1: variance from blocks of 16
    std::vector<std::string> materials;   ///< names of the material.* channels
};

/// The samples of one pixel, added by one thread in sample order. Blocks of 16 are summed apart, then added in order: the same bits
/// however threads and tiles are arranged. Non-finite radiance is dropped and counted.
class PixelSums {
public:
    explicit PixelSums(const FilmLayout& layout);
    void add(const PixelSample& sample);
    void end_replicate();          ///< after the last sample of each replicate

private:
    friend class Film;
    const FilmLayout* layout_;
    std::vector<double> total_, block_;              ///< one a summed channel
    std::array<double, 3> replicate_{};              ///< radiance of the running replicate
    std::array<double, 3> mean_{}, square_{};        ///< Welford sums over blocks or replicates
    int in_block_ = 0, blocks_ = 0, added_ = 0, in_replicate_ = 0, dropped_ = 0;
    float best_z_ = kInfinity;
    std::uint32_t object_ = 0, instance_ = 0;
    void close_block();
};

/// Distinct pixels may be recorded at the same time.
class Film {
public:
    explicit Film(FilmLayout layout);
    const FilmLayout& layout() const { return layout_; }
    void record(int x, int y, const PixelSums& sums);   ///< display coordinates inside the data window
    std::uint64_t dropped_samples() const;              ///< non-finite, over all pixels
    Vec2i first_dropped_pixel() const;                  ///< in row order; (-1, -1) if none

    /// R,G,B,A, Z, N.*, Ng.*, P.*, albedo.*, material.*, objectId, instanceId, variance.*, samples.Y, cost.Y. variance.* is the variance of the pixel mean.
    Image develop() const;

private:
    FilmLayout layout_;
    std::vector<Channel> channels_;
    std::vector<std::uint16_t> dropped_;
};

}  // namespace hoodoo
