// The instruction set of the hot kernels. They are compiled once for each and chosen here, at run time.
// The library as a whole is compiled for HOODOO_BASELINE, below which nothing can be chosen.

#include "terrain/isa.h"

#include "terrain/error.h"

#include <cstdlib>

namespace hoodoo
{
namespace
{

bool processor_has(Isa isa)
{
    __builtin_cpu_init();
    if (isa == Isa::avx512) {
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd");
    }
    return isa == Isa::avx2 ? __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") : static_cast<bool>(__builtin_cpu_supports("sse4.2"));
}

bool built_for(Isa isa)
{
#ifdef __AVX2__
    return isa != Isa::sse4;  // the baseline is newer: kernels for older processors are not compiled
#else
    return isa == Isa::sse4 || isa == Isa::avx2 || isa == Isa::avx512;
#endif
}

Isa choose()
{
    const char* forced = std::getenv("HOODOO_ISA");
    if (!forced || !*forced) {
        for (const Isa isa : {Isa::avx512, Isa::avx2})
            if (built_for(isa) && processor_has(isa)) return isa;
        return Isa::sse4;
    }
    for (const Isa isa : {Isa::sse4, Isa::avx2, Isa::avx512}) {
        if (isa_name(isa) != forced) continue;
        if (!processor_has(isa)) throw Error(ErrorKind::scene, std::string("HOODOO_ISA=") + forced + ": this processor does not have it");
        if (!built_for(isa))
            throw Error(ErrorKind::scene,
                        std::string("HOODOO_ISA=") + forced + ": this build starts at AVX2; configure with -DHOODOO_BASELINE=x86-64-v2");
        return isa;
    }
    throw Error(ErrorKind::scene, Problem{{}, "HOODOO_ISA names no instruction set", "sse4, avx2 or avx512", forced, {}});
}

}  // namespace

Isa selected_isa()
{
    static const Isa isa = choose();
    return isa;
}

std::string isa_name(Isa isa)
{
    return isa == Isa::avx512 ? "avx512" : isa == Isa::avx2 ? "avx2" : "sse4";
}

const char* embree_isa_option(Isa isa)
{
    // Embree's trees are eight wide: AVX-512 adds nothing to a step but its latencies. Measured on Zen 4: AVX2 is 7 to 13% faster for single rays,
    // on triangles as on user geometry.
    return isa == Isa::sse4 ? "isa=sse4.2" : "isa=avx2";
}

}  // namespace hoodoo
