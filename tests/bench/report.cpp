#include "tests/bench/report.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace hoodoo::bench
{
namespace
{

class Collector : public benchmark::BenchmarkReporter
{
public:
    explicit Collector(std::map<std::string, double>& best) : best_(best) {}
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override
    {
        for (const Run& run : runs) {
            const auto rate = run.counters.find("items_per_second");
            if (run.error_occurred || rate == run.counters.end() || run.run_type != Run::RT_Iteration) continue;
            double& best = best_[run.run_name.function_name];
            best = std::max<double>(best, rate->second);
        }
    }

private:
    std::map<std::string, double>& best_;
};

}  // namespace

std::map<std::string, double> measure(const std::vector<Task>& tasks, int repetitions, double seconds)
{
    benchmark::ClearRegisteredBenchmarks();
    for (const Task& task : tasks) {
        benchmark::RegisterBenchmark((task.group + "/" + task.method).c_str(),
                                     [&task](benchmark::State& state) {
                                         for (auto _ : state) task.work();
                                         state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * task.items));
                                     })
            ->Repetitions(repetitions)
            ->MinTime(seconds);
    }
    std::string program = "bench", interleave = "--benchmark_enable_random_interleaving=true";
    char* arguments[] = {program.data(), interleave.data(), nullptr};
    int count = 2;
    benchmark::Initialize(&count, arguments);
    std::map<std::string, double> best;
    Collector collector(best);
    benchmark::RunSpecifiedBenchmarks(&collector);
    return best;
}

void write_report(const std::string& name, const nlohmann::json& report)
{
    std::filesystem::create_directories("out/bench");
    const std::string path = "out/bench/" + name + ".json";
    std::ofstream(path + ".tmp") << report.dump(2) << "\n";
    std::filesystem::rename(path + ".tmp", path);
    std::printf("written: %s\n", path.c_str());
}

}  // namespace hoodoo::bench
