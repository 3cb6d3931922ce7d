// Warped surfaces: certified marching beside the paper's area test, and beside a mesh.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

/// `full`: more rays and finer epsilons.
nlohmann::json warp_benchmark(bool full);

}  // namespace hoodoo::bench
