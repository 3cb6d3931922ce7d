// A whole path: samples a second, error at 64 samples, and where the time goes.
#pragma once

#include <nlohmann/json.hpp>

namespace hoodoo::bench
{

nlohmann::json path_benchmark(bool full);

}  // namespace hoodoo::bench
