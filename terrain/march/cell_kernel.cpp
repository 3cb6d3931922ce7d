// A ray against the 15 slabs of a cluster, in SIMD lanes, once for each instruction set.
//
// Along the ray F is a cubic in each slab. Its value and slope at both ends give the four Bernstein coefficients, whose hull encloses it:
// all above or all below zero, by more than the tolerance, and there is no crossing. Slabs are widened a little, so that rounding cannot
// lose a ray between two of them.

#include "terrain/march/cell_kernel.h"

#include "terrain/isa.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "terrain/march/cell_kernel.cpp"
#include "terrain/isa_kernels.h"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hoodoo
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using D8 = hn::Rebind<std::uint8_t, D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

/// Half-widths by which slabs are widened: several units in the last place of cell coordinates up to 8 and heights up to 255.
constexpr float kWidenCell = 2e-5f;
constexpr float kWidenUnit = 2e-4f;

struct Corners {
    V z0, z1;
    V low[4], high[4];
};

HWY_INLINE VI load_bytes(const std::uint8_t* from)
{
    return hn::PromoteTo(DI(), hn::LoadU(D8(), from));
}

HWY_INLINE void decode_level(const CompactCluster& c, std::size_t lane, V* value)
{
    const VI pair01 = load_bytes(c.high[0] + lane), pair23 = load_bytes(c.high[1] + lane);
    const VI nibble[4] = {hn::ShiftLeft<28>(pair01), hn::ShiftLeft<24>(pair01), hn::ShiftLeft<28>(pair23), hn::ShiftLeft<24>(pair23)};
    for (int k = 0; k < 4; ++k) {
        // Twelve bits at the top of the word, sign-extended downwards. The odd corners carry the even one's nibble below theirs: cut it off.
        const VI top = hn::And(nibble[k], hn::Set(DI(), static_cast<std::int32_t>(0xf0000000u)));
        const VI bits = hn::Or(top, hn::ShiftLeft<20>(load_bytes(c.low[k] + lane)));
        value[k] = hn::ConvertTo(D(), hn::ShiftRight<20>(bits));
    }
}

HWY_INLINE void decode_heights(const CompactCluster& c, double, std::size_t lane, Corners& out)
{
    out.z0 = hn::ConvertTo(D(), load_bytes(c.z + lane));
    out.z1 = hn::ConvertTo(D(), load_bytes(c.z + lane + 1));
}

HWY_INLINE void decode_values(const CompactCluster& c, std::size_t lane, Corners& out)
{
    decode_level(c, lane, out.low);
    decode_level(c, lane + 1, out.high);
}

HWY_INLINE void decode_heights(const WideCluster& c, double z_base, std::size_t lane, Corners& out)
{
    HWY_ALIGN float z[17];
    for (std::size_t i = 0; i < 16; ++i) z[i] = static_cast<float>(c.z[i] - z_base);
    z[16] = 0.0f;
    out.z0 = hn::LoadU(D(), z + lane);
    out.z1 = hn::LoadU(D(), z + lane + 1);
}

HWY_INLINE void decode_values(const WideCluster& c, std::size_t lane, Corners& out)
{
    for (int k = 0; k < 4; ++k) {
        out.low[k] = hn::LoadU(D(), c.value[k] + lane);
        out.high[k] = hn::LoadU(D(), c.value[k] + lane + 1);
    }
}

/// Value and slope of F at `t`, from the coefficients 1, U, V, UV of the lower level and their change to the upper one.
struct Trilinear {
    V c[4], dc[4];
    V u, v, w, du, dv, dw;

    HWY_INLINE void at(V t, V& value, V& slope) const
    {
        const V x = hn::MulAdd(t, du, u), y = hn::MulAdd(t, dv, v), z = hn::MulAdd(t, dw, w);
        const V xy = hn::Mul(x, y);
        const V b = hn::MulAdd(z, dc[1], c[1]), g = hn::MulAdd(z, dc[2], c[2]), e = hn::MulAdd(z, dc[3], c[3]);
        value = hn::MulAdd(xy, e, hn::MulAdd(y, g, hn::MulAdd(x, b, hn::MulAdd(z, dc[0], c[0]))));
        const V rise = hn::MulAdd(xy, dc[3], hn::MulAdd(y, dc[2], hn::MulAdd(x, dc[1], dc[0])));
        slope = hn::MulAdd(du, hn::MulAdd(y, e, b), hn::MulAdd(dv, hn::MulAdd(x, e, g), hn::Mul(dw, rise)));
    }
};

HWY_INLINE void clip(V from, V to, V inverse, V& t_in, V& t_out)
{
    const V a = hn::Mul(from, inverse), b = hn::Mul(to, inverse);
    t_in = hn::Max(t_in, hn::Min(a, b));
    t_out = hn::Min(t_out, hn::Max(a, b));
}

template <class Cluster>
HWY_INLINE std::uint32_t filter(const Cluster& cluster, double z_base, const FilterRay& ray, float* t_in_out, int& slabs_met)
{
    const D d;
    const DI di;
    const std::size_t n = hn::Lanes(d);
    std::uint32_t found = 0;
    for (std::size_t lane = 0; lane < 16; lane += n) {
        const std::uint32_t valid = (cluster.slabs >> lane) & ((1u << n) - 1u);
        if (valid == 0) continue;

        // Which cell each lane is about.
        const VI index = hn::Iota(di, static_cast<std::int32_t>(lane));
        const VI word = hn::IfThenElse(hn::Lt(index, hn::Set(di, 8)), hn::Set(di, static_cast<std::int32_t>(cluster.offsets)),
                                       hn::Set(di, static_cast<std::int32_t>(cluster.offsets >> 32)));
        const auto shift = hn::BitCast(DU(), hn::ShiftLeft<2>(hn::And(index, hn::Set(di, 7))));
        const VI offset = hn::BitCast(di, hn::Shr(hn::BitCast(DU(), word), shift));
        const V cell_x = hn::ConvertTo(d, hn::And(offset, hn::Set(di, 3)));
        const V cell_y = hn::ConvertTo(d, hn::And(hn::ShiftRight<2>(offset), hn::Set(di, 3)));

        Corners corner;
        decode_heights(cluster, z_base, lane, corner);

        // Clip the ray to the widened slabs.
        const V x = hn::Sub(hn::Set(d, ray.origin[0]), cell_x), y = hn::Sub(hn::Set(d, ray.origin[1]), cell_y), z = hn::Set(d, ray.origin[2]);
        V t_in = hn::Set(d, ray.t_lo), t_out = hn::Set(d, ray.t_hi);
        clip(hn::Sub(hn::Set(d, -kWidenCell), x), hn::Sub(hn::Set(d, 1.0f + kWidenCell), x), hn::Set(d, ray.inverse[0]), t_in, t_out);
        clip(hn::Sub(hn::Set(d, -kWidenCell), y), hn::Sub(hn::Set(d, 1.0f + kWidenCell), y), hn::Set(d, ray.inverse[1]), t_in, t_out);
        clip(hn::Sub(hn::Sub(corner.z0, hn::Set(d, kWidenUnit)), z), hn::Sub(hn::Add(corner.z1, hn::Set(d, kWidenUnit)), z),
             hn::Set(d, ray.inverse[2]), t_in, t_out);
        const auto met = hn::And(
            hn::Le(t_in, t_out),
            hn::RebindMask(d, hn::Ne(hn::And(hn::Set(di, static_cast<std::int32_t>(cluster.slabs)), hn::Shl(hn::Set(di, 1), index)), hn::Zero(di))));
        if (hn::AllFalse(d, met)) continue;
        decode_values(cluster, lane, corner);

        // Value and slope at both ends.
        Trilinear f;
        for (int k = 0; k < 2; ++k) {
            const V* v = k == 0 ? corner.low : corner.high;
            V* c = k == 0 ? f.c : f.dc;
            c[0] = v[0];
            c[1] = hn::Sub(v[1], v[0]);
            c[2] = hn::Sub(v[2], v[0]);
            c[3] = hn::Sub(hn::Sub(v[3], v[2]), c[1]);
        }
        for (int k = 0; k < 4; ++k) f.dc[k] = hn::Sub(f.dc[k], f.c[k]);
        const V thickness = hn::Div(hn::Set(d, 1.0f), hn::Sub(corner.z1, corner.z0));
        f.u = x, f.v = y, f.w = hn::Mul(hn::Sub(z, corner.z0), thickness);
        f.du = hn::Set(d, ray.direction[0]), f.dv = hn::Set(d, ray.direction[1]), f.dw = hn::Mul(hn::Set(d, ray.direction[2]), thickness);
        V b0, b3, slope_in, slope_out;
        f.at(t_in, b0, slope_in);
        f.at(t_out, b3, slope_out);

        // Bernstein coefficients of the cubic between them.
        const V third = hn::Mul(hn::Sub(t_out, t_in), hn::Set(d, 1.0f / 3.0f));
        const V b1 = hn::MulAdd(slope_in, third, b0), b2 = hn::NegMulAdd(slope_out, third, b3);
        const V least = hn::Min(hn::Min(b0, b1), hn::Min(b2, b3)), most = hn::Max(hn::Max(b0, b1), hn::Max(b2, b3));
        const V tolerance = hn::Set(d, ray.tolerance);
        auto candidate = hn::And(met, hn::And(hn::Le(least, tolerance), hn::Ge(most, hn::Neg(tolerance))));
        if (ray.entering) {
            // F that only rises cannot be entered.
            const V rise = hn::Min(hn::Sub(b1, b0), hn::Min(hn::Sub(b2, b1), hn::Sub(b3, b2)));
            candidate = hn::AndNot(hn::Gt(rise, tolerance), candidate);
            if (ray.t_sure_lo < ray.t_sure_hi) {
                // A face is widened by less than the tolerance's share of F, on both sides of it.
                const V past = hn::Mul(tolerance, hn::Set(d, 8.0f));
                const auto ends = hn::And(hn::Gt(b0, past), hn::Lt(b3, hn::Neg(past)));
                const auto within = hn::And(hn::Ge(t_in, hn::Set(d, ray.t_sure_lo)), hn::Le(t_out, hn::Set(d, ray.t_sure_hi)));
                if (!hn::AllFalse(d, hn::And(hn::And(met, ends), within))) return found | kCertain;
            }
        }
        slabs_met += static_cast<int>(hn::CountTrue(d, met));
        if (hn::AllFalse(d, candidate)) continue;
        hn::StoreU(t_in, d, t_in_out + lane);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, candidate, bits);
        found |= (static_cast<std::uint32_t>(bits[0]) | (static_cast<std::uint32_t>(bits[1]) << 8)) << lane;
    }
    return found;
}

std::uint32_t filter_compact(const CompactCluster& c, const FilterRay& ray, float* t_in, int& met)
{
    return filter(c, 0.0, ray, t_in, met);
}
std::uint32_t filter_wide(const WideCluster& c, double z_base, const FilterRay& ray, float* t_in, int& met)
{
    return filter(c, z_base, ray, t_in, met);
}

}  // namespace HWY_NAMESPACE
}  // namespace hoodoo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hoodoo
{

CellFilter cell_filter()
{
    return {HOODOO_KERNEL(filter_compact), HOODOO_KERNEL(filter_wide)};
}

}  // namespace hoodoo
#endif
