// The film adds samples; means and their variance are all it keeps.
//
// A pixel's samples come from one thread in sample order. They are summed in double precision in blocks of 16, and the block sums are added in
// order, so threads, tiles and crops cannot change a bit, and a picture can later be resumed or merged at block boundaries.
//
// Variance of the pixel mean. The points of a scrambled Sobol' sequence depend on each other, so the plain sample variance is no estimate of the
// error; it is an upper one where the points do what they promise. Between batches b of n_b samples with means m_b, N = sum n_b, mean m:
//     variance = sum_b n_b (m_b - m)^2 / ((B - 1) N),
// exact in expectation for independent samples of any batch sizes (for equal sizes it is the variance of the m_b over B).
// - replicates > 1: batches are replicates. They are scrambled independently, so the estimate is unbiased.
// - otherwise: blocks of 16 consecutive samples. Each block is well distributed in itself, but blocks also complement each other, which this
//   cannot see: the estimate is conservative. Measured at 64 samples: 1.3 times the true variance on a plane under a clear sky, 1.2 times in a cave
//   of many bounces; between replicates it was 0.92 to 1.03 times.
// - fewer than 32 samples make fewer than two full blocks: then each sample is a batch. Still conservative, and noisier.
// Replicates cost noise, because points of different replicates do not complement each other. Measured at 64 samples, true variance against one
// replicate: 2 replicates +7 to 13%, 4 +20 to 23%, 8 +30 to 33%, 16 +34 to 65% (the more, the smoother the light). Batch means enter a weighted
// update of mean and squared deviations, one batch at a time (West1979).
//
// Missing: merging of films, checkpoints.
#include "renderer/film/film.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

namespace
{

// Places of the summed channels in PixelSums::total_. Radiance, alpha and cost are means over all samples, the rest over those that hit.
enum Sum : std::size_t { radiance = 0, alpha = 3, normal = 4, geometric = 7, position = 10, albedo = 13, motion = 16, cost = 18, materials = 19 };

constexpr std::size_t plane_z = 4;  // in Film::channels_

bool is_finite(const Vec3f& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_finite(const PixelSample& s)
{
    bool finite = is_finite(s.radiance) && std::isfinite(s.alpha) && std::isfinite(s.cost);
    if (s.alpha > 0.0f) {
        finite = finite && std::isfinite(s.z) && is_finite(s.position) && is_finite(s.shading_normal) && is_finite(s.geometric_normal) &&
                 is_finite(s.albedo) && std::isfinite(s.motion.x) && std::isfinite(s.motion.y);
        for (const float share : s.materials) finite = finite && std::isfinite(share);
    }
    return finite;
}

void add_vector(double* sums, const Vec3f& v)
{
    sums[0] += v.x;
    sums[1] += v.y;
    sums[2] += v.z;
}

std::vector<std::string> channel_names(const FilmLayout& layout)
{
    std::vector<std::string> names = {"R",    "G",   "B",   "A",   "Z",        "N.X",      "N.Y",      "N.Z",      "Ng.X",    "Ng.Y",
                                      "Ng.Z", "P.X", "P.Y", "P.Z", "albedo.R", "albedo.G", "albedo.B", "motion.X", "motion.Y"};
    for (const std::string& material : layout.materials) names.push_back("material." + material);
    for (const char* name : {"objectId", "instanceId", "variance.R", "variance.G", "variance.B", "samples.Y", "cost.Y"}) names.emplace_back(name);
    return names;
}

}  // namespace

PixelSums::PixelSums(const FilmLayout& layout)
    : batch_kind_(layout.replicates > 1             ? Batch::replicate
                  : layout.samples < 2 * block_size ? Batch::sample
                                                    : Batch::block),
      total_(materials + layout.materials.size(), 0.0),
      block_(total_)
{
}

void PixelSums::add(const PixelSample& sample)
{
    if (!is_finite(sample)) {
        ++dropped_;
        return;
    }
    double* sums = block_.data();
    add_vector(sums + radiance, sample.radiance);
    sums[alpha] += sample.alpha;
    sums[cost] += sample.cost;
    if (sample.alpha > 0.0f) {
        add_vector(sums + normal, sample.shading_normal);
        add_vector(sums + geometric, sample.geometric_normal);
        add_vector(sums + position, sample.position);
        add_vector(sums + albedo, sample.albedo);
        sums[motion] += sample.motion.x;
        sums[motion + 1] += sample.motion.y;
        const std::size_t shares = std::min(sample.materials.size(), block_.size() - materials);
        for (std::size_t i = 0; i < shares; ++i) sums[materials + i] += sample.materials[i];
        if (sample.z < best_z_) {
            best_z_ = sample.z;
            object_ = sample.object;
            instance_ = sample.instance;
        }
    }
    add_vector(batch_.data(), sample.radiance);
    ++in_batch_;
    if (batch_kind_ == Batch::sample) close_batch();
    if (++in_block_ == block_size) close_block();
}

void PixelSums::end_replicate()
{
    close_block();
    if (batch_kind_ == Batch::replicate) close_batch();
}

void PixelSums::close_block()
{
    for (std::size_t i = 0; i < total_.size(); ++i) total_[i] += block_[i];
    std::fill(block_.begin(), block_.end(), 0.0);
    in_block_ = 0;
    if (batch_kind_ == Batch::block) close_batch();
}

void PixelSums::close_batch()
{
    if (in_batch_ == 0) return;
    in_batches_ += in_batch_;
    ++batches_;
    for (int c = 0; c < 3; ++c) {
        const double value = batch_[c] / in_batch_;
        const double delta = value - mean_[c];
        mean_[c] += delta * in_batch_ / in_batches_;
        square_[c] += in_batch_ * delta * (value - mean_[c]);
    }
    batch_ = {};
    in_batch_ = 0;
}

Film::Film(FilmLayout layout) : layout_(std::move(layout))
{
    const PixelBounds& d = layout_.data;
    if (d.x0 < 0 || d.y0 < 0 || d.x1 > layout_.width || d.y1 > layout_.height || d.x0 >= d.x1 || d.y0 >= d.y1)
        throw Error(ErrorKind::scene, Problem{{},
                                              "the pixel bounds must be a part of the picture",
                                              fmt::format("0 <= x0 < x1 <= {} and 0 <= y0 < y1 <= {}", layout_.width, layout_.height),
                                              fmt::format("{},{},{},{}", d.x0, d.x1, d.y0, d.y1),
                                              {}});
    const std::size_t pixels = static_cast<std::size_t>(d.width()) * d.height();
    for (const std::string& name : channel_names(layout_)) channels_.push_back({name, std::vector<float>(pixels, 0.0f)});
    std::fill(channels_[plane_z].pixels.begin(), channels_[plane_z].pixels.end(), static_cast<float>(kInfinity));
    dropped_.assign(pixels, 0);
}

void Film::record(int x, int y, PixelSums sums)
{
    sums.end_replicate();
    const std::size_t pixel = static_cast<std::size_t>(y - layout_.data.y0) * layout_.data.width() + (x - layout_.data.x0);
    std::size_t plane = 0;
    const auto put = [&](double value) { channels_[plane++].pixels[pixel] = static_cast<float>(value); };

    // Hits are counted by alpha, which is 1 for each: the sum is exact.
    const std::vector<double>& total = sums.total_;
    const int taken = sums.in_batches_;
    const double per_sample = taken > 0 ? 1.0 / taken : 0.0;
    const double per_hit = total[alpha] > 0.0 ? 1.0 / total[alpha] : 0.0;
    for (std::size_t i = radiance; i < normal; ++i) put(total[i] * per_sample);
    put(sums.best_z_);
    for (std::size_t i = normal; i < cost; ++i) put(total[i] * per_hit);
    for (std::size_t i = materials; i < total.size(); ++i) put(total[i] * per_hit);
    put(sums.object_);
    put(sums.instance_);
    for (int c = 0; c < 3; ++c) put(sums.batches_ > 1 ? sums.square_[c] / ((sums.batches_ - 1.0) * sums.in_batches_) : kInfinity);
    put(taken);
    put(total[cost] * per_sample);
    dropped_[pixel] = static_cast<std::uint32_t>(sums.dropped_);
}

std::uint64_t Film::dropped_samples() const
{
    std::uint64_t sum = 0;
    for (const std::uint32_t dropped : dropped_) sum += dropped;
    return sum;
}

Vec2i Film::first_dropped_pixel() const
{
    const auto first = std::find_if(dropped_.begin(), dropped_.end(), [](std::uint32_t dropped) { return dropped > 0; });
    if (first == dropped_.end()) return {-1, -1};
    const int index = static_cast<int>(first - dropped_.begin());
    return {layout_.data.x0 + index % layout_.data.width(), layout_.data.y0 + index / layout_.data.width()};
}

Image Film::develop() const
{
    Image image;
    image.width = layout_.width;
    image.height = layout_.height;
    image.data = layout_.data;
    image.channels = channels_;
    return image;
}

}  // namespace hoodoo
