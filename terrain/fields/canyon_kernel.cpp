// The inverse flow of many points side by side (Gamito2001, section 4.1): what CanyonWall::value computes for one, without branches.
//
// Equations as in noise.cpp and warp.cpp: quintic fade, RK4 in equal steps from T down to 0. Gradients come from a table of the lattice, so that no
// lane hashes. Sums are taken in one order and nothing is fused, so every instruction set gives the same bits.

#include "terrain/fields/canyon_kernel.h"

#include "terrain/isa.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "terrain/fields/canyon_kernel.cpp"
#include "terrain/isa_kernels.h"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hoodoo
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

HWY_INLINE V fade(V t)
{
    const D d;
    const V inner = hn::Add(hn::Mul(t, hn::Sub(hn::Mul(hn::Set(d, 6.0), t), hn::Set(d, 15.0))), hn::Set(d, 10.0));
    return hn::Mul(hn::Mul(hn::Mul(t, t), t), inner);
}

HWY_INLINE V fade_slope(V t)
{
    const D d;
    const V down = hn::Sub(t, hn::Set(d, 1.0));
    return hn::Mul(hn::Mul(hn::Mul(hn::Mul(hn::Set(d, 30.0), t), t), down), down);
}

HWY_INLINE V mix(V a, V b, V t)
{
    return hn::Add(a, hn::Mul(t, hn::Sub(b, a)));
}

/// The lattice's gradients, wherever points are.
struct WholeTable {
    const CanyonLanes::Lattice& lattice;
    HWY_INLINE void corners(VI column, VI row, V* gx, V* gy) const
    {
        const D d;
        const DI di;
        const V wide = hn::Set(d, static_cast<double>(lattice.nx));
        const VI at = hn::Add(column, hn::ConvertTo(di, hn::Mul(hn::ConvertTo(d, row), wide)));
        const VI steps[4] = {hn::Zero(di), hn::Set(di, 1), hn::Set(di, lattice.nx), hn::Set(di, lattice.nx + 1)};
        for (int c = 0; c < 4; ++c) {
            gx[c] = hn::GatherIndex(d, lattice.gradient_x.data(), hn::Add(at, steps[c]));
            gy[c] = hn::GatherIndex(d, lattice.gradient_y.data(), hn::Add(at, steps[c]));
        }
    }
};

#if HWY_TARGET == HWY_AVX3
/// Four by four of them, kept in registers: a gather of eight costs as much as the arithmetic around it.
struct Window {
    V gx[2], gy[2];
    std::int64_t column, row;

    Window(const CanyonLanes::Lattice& lattice, std::int64_t left, std::int64_t low) : column(left), row(low)
    {
        alignas(64) double x[16], y[16];
        for (std::int64_t k = 0; k < 16; ++k) {
            const auto at = static_cast<std::size_t>((low + k / 4) * lattice.nx + left + k % 4);
            x[k] = lattice.gradient_x[at], y[k] = lattice.gradient_y[at];
        }
        const D d;
        for (std::size_t k = 0; k < 2; ++k) gx[k] = hn::Load(d, x + 8 * k), gy[k] = hn::Load(d, y + 8 * k);
    }
    HWY_INLINE void corners(VI columns, VI rows, V* x, V* y) const
    {
        const DI di;
        const VI at = hn::Add(hn::Sub(columns, hn::Set(di, column)), hn::ShiftLeft<2>(hn::Sub(rows, hn::Set(di, row))));
        const int steps[4] = {0, 1, 4, 5};
        for (int c = 0; c < 4; ++c) {
            const __m512i index = hn::Add(at, hn::Set(di, steps[c])).raw;
            x[c] = V{_mm512_permutex2var_pd(gx[0].raw, index, gx[1].raw)};
            y[c] = V{_mm512_permutex2var_pd(gy[0].raw, index, gy[1].raw)};
        }
    }
};
#endif

/// The lattice around a point: gradients of the four corners and the place between them.
struct Around {
    V gx[4], gy[4], v[4], x, y, fx, fy;
};

template <class Table>
HWY_INLINE Around look(const CanyonLanes::Lattice& lattice, const Table& table, V x, V y)
{
    const D d;
    const DI di;
    const V one = hn::Set(d, 1.0), lx = hn::Floor(x), ly = hn::Floor(y);
    Around a;
    table.corners(hn::ConvertTo(di, hn::Sub(lx, hn::Set(d, lattice.x0))), hn::ConvertTo(di, hn::Sub(ly, hn::Set(d, lattice.y0))), a.gx, a.gy);
    a.x = hn::Sub(x, lx);
    a.y = hn::Sub(y, ly);
    a.fx = fade(a.x);
    a.fy = fade(a.y);
    const V rx[2] = {a.x, hn::Sub(a.x, one)}, ry[2] = {a.y, hn::Sub(a.y, one)};
    for (int c = 0; c < 4; ++c) a.v[c] = hn::Add(hn::Mul(a.gx[c], rx[c & 1]), hn::Mul(a.gy[c], ry[c >> 1]));
    return a;
}

template <class Table>
HWY_INLINE V noise(const CanyonLanes::Lattice& lattice, const Table& table, V x, V y)
{
    const Around a = look(lattice, table, x, y);
    return mix(mix(a.v[0], a.v[1], a.fx), mix(a.v[2], a.v[3], a.fx), a.fy);
}

template <class Table>
HWY_INLINE void noise_gradient(const CanyonLanes::Lattice& lattice, const Table& table, V x, V y, V& gx, V& gy)
{
    const Around a = look(lattice, table, x, y);
    const V v0 = mix(a.v[0], a.v[1], a.fx), v1 = mix(a.v[2], a.v[3], a.fx);
    const V across = mix(hn::Sub(a.v[1], a.v[0]), hn::Sub(a.v[3], a.v[2]), a.fy);
    gx = hn::Add(mix(mix(a.gx[0], a.gx[1], a.fx), mix(a.gx[2], a.gx[3], a.fx), a.fy), hn::Mul(fade_slope(a.x), across));
    gy = hn::Add(mix(mix(a.gy[0], a.gy[1], a.fx), mix(a.gy[2], a.gy[3], a.fx), a.fy), hn::Mul(fade_slope(a.y), hn::Sub(v1, v0)));
}

/// T(z), each octave weighted by distance.
HWY_INLINE V profile(const CanyonLanes& lanes, V z, V distance)
{
    const D d;
    const DI di;
    const V one = hn::Set(d, 1.0), zero = hn::Zero(d);
    V sum = zero;
    for (const CanyonLanes::Octave& o : lanes.octaves) {
        const V u = hn::Min(hn::Max(hn::Sub(hn::Mul(distance, hn::Set(d, o.fade)), one), zero), one);
        const V weight = hn::Sub(one, hn::Mul(hn::Mul(u, u), hn::Sub(hn::Set(d, 3.0), hn::Add(u, u))));
        const V x = hn::Add(hn::Mul(hn::Set(d, o.frequency), z), hn::Set(d, o.shift)), low = hn::Floor(x), rest = hn::Sub(x, low);
        const VI at = hn::ConvertTo(di, hn::Sub(low, hn::Set(d, o.first)));
        const V g0 = hn::GatherIndex(d, o.slopes.data(), at), g1 = hn::GatherIndex(d, o.slopes.data(), hn::Add(at, hn::Set(di, 1)));
        const V n = mix(hn::Mul(g0, rest), hn::Mul(g1, hn::Sub(rest, one)), fade(rest));
        sum = hn::Add(sum, hn::Mul(hn::Mul(weight, hn::Set(d, o.amplitude)), n));
    }
    return sum;
}

/// The noise where the points (x, y) come from, carried back for the time T.
template <class Table>
HWY_INLINE V carried_noise(const CanyonLanes& lanes, const Table& table, V x, V y, V t)
{
    const D d;
    const V two = hn::Set(d, 2.0), h = hn::Div(t, hn::Set(d, static_cast<double>(lanes.steps)));
    const V half_step = hn::Mul(hn::Set(d, 0.5), h), part = hn::Div(h, hn::Set(d, 6.0));
    for (int n = 0; n < lanes.steps; ++n) {
        V ax, ay, bx, by, cx, cy, ex, ey;
        noise_gradient(lanes.plan, table, x, y, ax, ay);
        noise_gradient(lanes.plan, table, hn::Sub(x, hn::Mul(ax, half_step)), hn::Sub(y, hn::Mul(ay, half_step)), bx, by);
        noise_gradient(lanes.plan, table, hn::Sub(x, hn::Mul(bx, half_step)), hn::Sub(y, hn::Mul(by, half_step)), cx, cy);
        noise_gradient(lanes.plan, table, hn::Sub(x, hn::Mul(cx, h)), hn::Sub(y, hn::Mul(cy, h)), ex, ey);
        x = hn::Sub(x, hn::Mul(hn::Add(hn::Add(ax, hn::Mul(hn::Add(bx, cx), two)), ex), part));
        y = hn::Sub(y, hn::Mul(hn::Add(hn::Add(ay, hn::Mul(hn::Add(by, cy), two)), ey), part));
    }
    return noise(lanes.plan, table, x, y);
}

void noise_of(const CanyonLanes& lanes, const CanyonPoints& points, double* values)
{
    const D d;
    for (std::size_t i = 0; i < CanyonLanes::count; i += hn::Lanes(d)) {
        const V x = hn::Load(d, points.x + i), y = hn::Load(d, points.y + i);
        V z = hn::Load(d, points.z + i);
        if (lanes.lift.nx > 0) {
            const V f = hn::Set(d, lanes.lift_frequency);
            z = hn::Sub(z, hn::Mul(hn::Set(d, lanes.lift_amplitude), noise(lanes.lift, WholeTable{lanes.lift}, hn::Mul(x, f), hn::Mul(y, f))));
        }
        const V t = profile(lanes, z, hn::Load(d, points.distance + i));
#if HWY_TARGET == HWY_AVX3
        // No stage of a step leaves the disc of the greatest speed times |T|.
        const double reach = lanes.speed * hn::GetLane(hn::MaxOfLanes(d, hn::Abs(t)));
        const auto cell = [&](V v, double by, double origin) { return static_cast<std::int64_t>(std::floor(hn::GetLane(v) + by - origin)); };
        const std::int64_t left = cell(hn::MinOfLanes(d, x), -reach, lanes.plan.x0), right = cell(hn::MaxOfLanes(d, x), reach, lanes.plan.x0);
        const std::int64_t low = cell(hn::MinOfLanes(d, y), -reach, lanes.plan.y0), high = cell(hn::MaxOfLanes(d, y), reach, lanes.plan.y0);
        if (right - left <= 2 && high - low <= 2) {
            const Window window(lanes.plan, std::min(left, lanes.plan.nx - 4), std::min(low, lanes.plan.ny - 4));
            hn::StoreU(carried_noise(lanes, window, x, y, t), d, values + i);
            continue;
        }
#endif
        hn::StoreU(carried_noise(lanes, WholeTable{lanes.plan}, x, y, t), d, values + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hoodoo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hoodoo
{

void canyon_noise(const CanyonLanes& lanes, const CanyonPoints& points, double* values)
{
    HOODOO_KERNEL(noise_of)(lanes, points, values);
}

}  // namespace hoodoo
#endif
