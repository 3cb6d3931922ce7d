// A processor that is too old gets a sentence instead of an illegal instruction.
// The check stands in the executable's .preinit_array: the loader runs that before the constructors of any library, and the libraries are compiled
// for the baseline. This file alone is compiled for x86-64, and calls nothing but the kernel's write and exit. Missing: a library that chooses code
// by itself while it is being linked (none of ours does).
#include <string_view>
#include <unistd.h>

namespace
{

constexpr std::string_view baseline = HOODOO_BASELINE;

bool fast_enough()
{
    if (baseline != "x86-64-v3" && baseline != "x86-64-v4") return true;
    __builtin_cpu_init();
    const bool v3 =
        __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    if (baseline == "x86-64-v3") return v3;
    return v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
}

void check_processor(int, char**, char**)
{
    if (fast_enough()) return;
    constexpr std::string_view message = "hoodoo: this processor lacks instructions that this build needs (" HOODOO_BASELINE
                                         ": AVX2, FMA, BMI2). Build with -DHOODOO_BASELINE=x86-64-v2 or run on a processor from 2013 or later.\n";
    [[maybe_unused]] const auto written = ::write(2, message.data(), message.size());
    ::_exit(1);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const run_first)(int, char**, char**) = check_processor;

}  // namespace
