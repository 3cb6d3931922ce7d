// Rays over height fields: ours beside Embree's triangles and Embree's grids, by size.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

/// 1024, 2048 and 4096 samples a side of the same terrain (`usual` false: 256 and 512), and 16384, of ours alone, if `largest`.
nlohmann::json height_benchmark(bool usual, bool largest);

}  // namespace hoodoo::bench
