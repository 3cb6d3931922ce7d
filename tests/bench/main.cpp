// `./run bench [NAME] [--small | --full]`: benchmarks by name, all without one. Each writes out/bench/NAME.json. `--full` adds the largest sizes,
// where a benchmark has such.

#include "tests/bench/edit.h"
#include "tests/bench/height.h"
#include "tests/bench/path.h"
#include "tests/bench/report.h"
#include "tests/bench/rocks.h"
#include "tests/bench/trace.h"
#include "tests/bench/warp.h"
#include "tests/bench/wave.h"

#include <cstdio>
#include <cstring>
#include <functional>

int main(int argc, char** argv)
{
    using namespace hoodoo::bench;
    bool full = true, largest = false;
    const std::map<std::string, std::function<nlohmann::json(bool)>> benchmarks{
        {"edit", edit_benchmark},   {"height", [&](bool usual) { return height_benchmark(usual, largest); }},
        {"path", path_benchmark},   {"rocks", rocks_benchmark},
        {"trace", trace_benchmark}, {"warp", warp_benchmark},
        {"wave", wave_benchmark},
    };
    std::string name;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--small") == 0) {
            full = false;
        } else if (std::strcmp(argv[i], "--full") == 0) {
            largest = true;
        } else {
            name = argv[i];
        }
    }
    if (!name.empty() && !benchmarks.count(name)) {
        std::fprintf(stderr, "no benchmark is called %s; there are:", name.c_str());
        for (const auto& [known, run] : benchmarks) std::fprintf(stderr, " %s", known.c_str());
        std::fprintf(stderr, "\n");
        return 2;
    }
    for (const auto& [known, run] : benchmarks)
        if (name.empty() || name == known) write_report(known, run(full));
    return 0;
}
