// From a stroke to the next frame's first ray: what an editor waits for.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

nlohmann::json edit_benchmark(bool full);

}  // namespace hoodoo::bench
