// What a file of SIMD kernels needs around them: which instruction sets it is compiled for, and the choice between them when the program runs.
//
// Highway compiles such a file once for each set, so this header has no guard and is read each time. Before it the file defines HWY_TARGET_INCLUDE
// as its own name; behind it <hwy/foreach_target.h> follows, then <hwy/highway.h>. Sets that no choice names are left out: each would cost a
// compilation.
#define HWY_DISABLE_PCLMUL_AES
#ifdef __AVX2__
#define HWY_DISABLED_TARGETS (~(HWY_AVX2 | HWY_AVX3))
#else
#define HWY_DISABLED_TARGETS (~(HWY_SSE4 | HWY_AVX2 | HWY_AVX3))
#endif

/// The function `name` of namespace hoodoo::HWY_NAMESPACE as it was compiled for selected_isa() (terrain/isa.h, which the file includes itself).
#undef HOODOO_KERNEL
#ifdef __AVX2__  // selected_isa() refuses less in such a build
#define HOODOO_KERNEL(name) (selected_isa() == Isa::avx512 ? &N_AVX3::name : &N_AVX2::name)
#else
#define HOODOO_KERNEL(name) (selected_isa() == Isa::avx512 ? &N_AVX3::name : selected_isa() == Isa::avx2 ? &N_AVX2::name : &N_SSE4::name)
#endif
