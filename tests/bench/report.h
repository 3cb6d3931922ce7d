// Benchmarks as ratios: Google Benchmark measures (repeated, interleaved at random), a baseline of the same run divides.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hoodoo::bench
{

/// One measured thing: `work()` handles `items` items. Names read "group/method", and each group has a baseline method.
struct Task {
    std::string group, method;
    std::size_t items;
    std::function<void()> work;
};

/// Runs all tasks interleaved, `repetitions` times each; returns items per second of the best repetition, by "group/method".
/// Each task's passes last at least `seconds`.
std::map<std::string, double> measure(const std::vector<Task>& tasks, int repetitions = 3, double seconds = 0.1);

/// Keeps a result from being optimised away.
template <class T>
inline void benchmark_keep(const T& value)
{
    asm volatile("" : : "r,m"(value) : "memory");
}

/// Writes out/bench/NAME.json (atomically enough for a report: aside, then renamed) and says where.
void write_report(const std::string& name, const nlohmann::json& report);

}  // namespace hoodoo::bench
