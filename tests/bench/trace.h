// Rays a second of the intersectors, against Embree's triangle mesh of the same surface.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

/// `full`: all views and meshes at full size. Otherwise a smaller terrain, to see that the benchmark works.
nlohmann::json trace_benchmark(bool full);

}  // namespace hoodoo::bench
