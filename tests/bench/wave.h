// The breaking wave of the README: where a frame's time goes, and the same water as triangles.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

nlohmann::json wave_benchmark(bool full);

}  // namespace hoodoo::bench
