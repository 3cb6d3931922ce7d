// Tiles in row order over a TBB arena of our own; a pixel is a pure function of its number, so any arrangement gives the same picture.
//
// TBB hands its workers the floating-point state that was current when the arena was made, so flush-to-zero is set inside each tile and undone after
// it: a host's own threads must not notice. Denormal numbers are flushed because Embree expects it and tests directions wrongly without. A replicate
// has ceil or floor of samples / replicates samples, the first ones the larger share.

#include "renderer/transport/tiles.h"

#include "terrain/error.h"
#include "terrain/math/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <immintrin.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <vector>

namespace hoodoo
{
namespace
{

/// Flush-to-zero and denormals-are-zero while it lives.
class FlushDenormals
{
public:
    FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
    ~FlushDenormals() { _mm_setcsr(saved_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
};

class Tracing
{
public:
    Tracing(const Scene& scene, const PathSettings& path, const TileSettings& settings, Film& film)
        : scene_(scene), path_(path), settings_(settings), film_(film), layout_(film.layout())
    {
        const PixelBounds& window = layout_.data;
        size_ = std::max(1, settings.tile_size);
        columns_ = (window.width() + size_ - 1) / size_;
        count_ = columns_ * ((window.height() + size_ - 1) / size_);
    }

    int count() const { return count_; }
    bool cancelled() const { return settings_.cancel && settings_.cancel->load(std::memory_order_relaxed); }

    void trace_tile(int tile)
    {
        {
            const FlushDenormals flush;
            std::vector<float> shares(scene_.material_names().size());
            const PixelBounds& window = layout_.data;
            const int x0 = window.x0 + tile % columns_ * size_, y0 = window.y0 + tile / columns_ * size_;
            for (int y = y0; y < std::min(y0 + size_, window.y1); ++y)
                for (int x = x0; x < std::min(x0 + size_, window.x1); ++x) trace_pixel({x, y}, shares);
        }
        if (!settings_.progress || cancelled()) return;
        const std::lock_guard lock(mutex_);
        ++done_;
        settings_.progress(static_cast<double>(done_) / count_);
    }

private:
    void trace_pixel(const Vec2i& pixel, std::vector<float>& shares)
    {
        PixelSums sums(layout_);
        const int replicates = std::max(1, layout_.replicates);
        for (int r = 0; r < replicates; ++r) {
            const int samples = layout_.samples / replicates + (r < layout_.samples % replicates ? 1 : 0);
            Sampler sampler(path_.seed, path_.frame, pixel, static_cast<std::uint32_t>(r));
            for (int s = 0; s < samples; ++s) {
                if (cancelled()) return;  // between samples: a pixel alone may take minutes
                sampler.start(static_cast<std::uint32_t>(s));
                const auto u = sampler.get(kCameraSet);
                const Vec2d film = Vec2d(pixel.x + 0.5, pixel.y + 0.5) + settings_.filter.sample(Vec2d(u[0], u[1]));
                const Ray ray = scene_.camera().ray(film, Vec2i(layout_.width, layout_.height), sampler.get(kShutterSet)[0]);
                sums.add(trace_path(scene_, path_, ray, sampler, shares));
            }
            sums.end_replicate();
        }
        film_.record(pixel.x, pixel.y, sums);
    }

    const Scene& scene_;
    const PathSettings& path_;
    const TileSettings& settings_;
    Film& film_;
    const FilmLayout& layout_;
    int size_ = 1, columns_ = 0, count_ = 0, done_ = 0;
    std::mutex mutex_;
};

}  // namespace

bool trace_tiles(const Scene& scene, const PathSettings& path, const TileSettings& settings, Film& film)
{
    if (film.layout().materials != scene.material_names()) throw Error(ErrorKind::internal, "the film's materials are not those of the scene");
    Tracing tracing(scene, path, settings, film);
    // More threads than processors are allowed only by an explicit permission, and asked for without it TBB complains on the error stream.
    std::optional<tbb::global_control> permission;
    if (settings.threads > tbb::info::default_concurrency())
        permission.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(settings.threads));
    tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        parallel_items(tracing.count(), [&](int tile) {
            if (!tracing.cancelled()) tracing.trace_tile(tile);
        });
    });
    return !tracing.cancelled();
}

}  // namespace hoodoo
