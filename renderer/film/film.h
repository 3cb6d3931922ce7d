// Samples in, sums out: the film adds what the light brings, in an order that does not depend on who brought it.
#pragma once

#include "renderer/film/image.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// One camera sample: the radiance it saw and what its first hit was. Colours in the rendering space.
struct PixelSample {
    Vec3f radiance{0.0f};  ///< W/m2/sr a channel
    float alpha = 0.0f;    ///< 1 where something was hit; the members from z to materials are read only then
    float z = 0.0f;        ///< distance along the view axis, metres; +inf on a miss
    Vec3f position{0.0f}, shading_normal{0.0f}, geometric_normal{0.0f}, albedo{0.0f};
    Vec2f motion{0.0f};        ///< of what is seen, pixels from the shutter's opening to its closing, x to the right, y downwards
    std::uint32_t object = 0;  ///< 1-based id of the object, 0 on a miss
    std::uint32_t instance = 0;
    float cost = 0.0f;                 ///< field evaluations of the whole path
    std::span<const float> materials;  ///< one share for each FilmLayout::materials; may be shorter, the rest is 0
};

struct FilmLayout {
    int width = 0, height = 0;
    PixelBounds data;
    int samples = 0;                     ///< a pixel, over all replicates; each takes its share, to within one
    int replicates = 1;                  ///< independently scrambled repetitions; 1: variance from blocks of 16
    std::vector<std::string> materials;  ///< names of the material.* channels
};

/// The samples of one pixel, added by one thread in sample order. Blocks of 16 are summed apart, then added in order: the same bits
/// however threads and tiles are arranged. A sample with a number that is not finite is dropped and counted. Keeps a reference to the layout.
class PixelSums
{
public:
    static constexpr int block_size = 16;

    explicit PixelSums(const FilmLayout& layout);
    void add(const PixelSample& sample);
    void end_replicate();  ///< after the last sample of each replicate; blocks never span replicates

private:
    friend class Film;
    enum class Batch { sample, block, replicate };  ///< whose means the variance is taken between

    Batch batch_kind_;
    std::vector<double> total_, block_;        ///< one a summed channel
    std::array<double, 3> batch_{};            ///< radiance sum of the running batch
    std::array<double, 3> mean_{}, square_{};  ///< of the batches closed so far: mean, and weighted squared deviations from it
    int in_block_ = 0, in_batch_ = 0, in_batches_ = 0, batches_ = 0, dropped_ = 0;
    double best_z_ = kInfinity;
    std::uint32_t object_ = 0, instance_ = 0;
    void close_block();
    void close_batch();
};

/// Distinct pixels may be recorded at the same time.
class Film
{
public:
    /// Throws Error (scene) if the data window is empty or leaves the display window.
    explicit Film(FilmLayout layout);
    const FilmLayout& layout() const { return layout_; }
    void record(int x, int y, PixelSums sums);  ///< display coordinates inside the data window
    std::uint64_t dropped_samples() const;      ///< not finite, over all pixels
    Vec2i first_dropped_pixel() const;          ///< in row order; (-1, -1) if none

    /// The channels, in this order:
    /// - R, G, B: mean radiance of the samples, W/m2/sr. A: share of samples that hit something.
    /// - Z: distance along the view axis of the nearest sample, metres; +inf where every sample missed. objectId, instanceId: of that same sample;
    ///   0 on a miss.
    /// - motion (X Y): how far what is seen moves over the picture while the shutter is open, pixels, x to the right, y downwards: by its own motion
    ///   and the camera's. Of a surface that flows it is the motion across itself. Mean over the samples that hit, 0 on a miss.
    /// - N, Ng (shading and geometric normal, X Y Z, world space), P (position, X Y Z, metres), albedo (R G B), material.NAME (share in [0, 1]):
    ///   means over the samples that hit, not multiplied by A, 0 on a miss. A mean of unit normals is shorter than 1 where they differ.
    /// - variance (R G B): variance of the pixel mean, (W/m2/sr)^2. +inf where it cannot be known: a single sample or replicate.
    /// - samples.Y: samples that count (taken minus dropped). cost.Y: mean field evaluations of a sample's whole path;
    ///   the only channel that may depend on the instruction set, because Embree's trees then have another width.
    Image develop() const;

private:
    FilmLayout layout_;
    std::vector<Channel> channels_;
    std::vector<std::uint32_t> dropped_;
};

}  // namespace hoodoo
