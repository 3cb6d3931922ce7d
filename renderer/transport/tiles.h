// A picture cut into tiles, traced by as many threads as there are: the arrangement never shows in the bits.
#pragma once

#include "renderer/film/film.h"
#include "renderer/scene/scene.h"
#include "renderer/transport/filter.h"
#include "renderer/transport/path.h"

#include <atomic>
#include <functional>

namespace hoodoo
{

struct TileSettings {
    Filter filter{"blackman-harris"};
    int threads = 0;                                ///< 0: all the process may use
    int tile_size = 32;                             ///< pixels, at least 1
    const std::atomic<bool>* cancel = nullptr;      ///< looked at before each row of a tile
    std::function<void(double fraction)> progress;  ///< from any thread, one at a time
};

/// Traces film.layout().samples samples, split evenly over its replicates, for every pixel of its data window. Each pixel is recorded once, with all
/// its samples in order. Runs in an arena of its own and leaves the callers' floating-point state alone. Returns false if it was cancelled: some
/// pixels are then not recorded. Throws Error (internal) if the layout's materials are not the scene's; what `progress` throws comes through.
bool trace_tiles(const Scene& scene, const PathSettings& path, const TileSettings& settings, Film& film);

}  // namespace hoodoo
