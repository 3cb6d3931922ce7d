// Rocks from a thousand to a million: memory, build, rays; instances by Embree against one user geometry; what a tile costs and what its rocks look
// like.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

nlohmann::json rocks_benchmark(bool full);

}  // namespace hoodoo::bench
