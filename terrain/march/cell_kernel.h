// The first half of meeting a cluster: all its slabs at once, in single precision, throwing out what certainly holds no crossing.
#pragma once

#include "terrain/march/cluster.h"

namespace hoodoo
{

/// A ray in the frame of one cluster: its corner is the origin, `t` is metres from a point of the ray near the cluster.
struct FilterRay {
    float origin[3], direction[3], inverse[3];
    float t_lo, t_hi;
    float tolerance;  ///< of F: above what single precision loses
    bool entering;
    float t_sure_lo, t_sure_hi;  ///< empty, or where a crossing may be taken for certain
};

/// Beside the lanes: one of them, within t_sure_lo to t_sure_hi, certainly holds a crossing into matter.
inline constexpr std::uint32_t kCertain = 1u << 31;

/// Lanes that may hold a crossing, as bits; `t_in[lane]` is where the ray enters that slab (a little early). Conservative: a lane that is not
/// named holds none. What remains is decided in double precision, so the answer of a ray does not depend on the instruction set. With kCertain
/// nothing remains for a ray that only asks whether: F at the ends is past zero by so much that no rounding, and no step to a neighbouring cell over
/// the widened face, makes up for it; and F is continuous.
/// `slabs_met` counts the slabs the ray passes through.
struct CellFilter {
    std::uint32_t (*compact)(const CompactCluster&, const FilterRay&, float* t_in, int& slabs_met);
    std::uint32_t (*wide)(const WideCluster&, double z_base, const FilterRay&, float* t_in, int& slabs_met);
};

/// The kernels for selected_isa().
CellFilter cell_filter();

}  // namespace hoodoo
