// The closed form of the waves (Gamito2001, section 4.2) for many points side by side: what BreakingSea::value computes for one, without branches.
//
// Equations as in breaking_sea.cpp, breaker.cpp and wave_profile.cpp. The rotation needs no angle of the point: with phi = omega(rho) T,
//     x0 = x cos phi + z sin phi,   z0 = z cos phi - x sin phi,
// and whether the point has been turned past the cut (the clamp at -3 pi / 2, the axis above the centre seen from the left) follows from signs. Let
// a in (0, 2 pi] be its angle from that cut; it is clamped where phi >= a. Since x0 = rho sin(phi - a), that is x < 0 and x0 >= 0 for phi < pi; for
// phi in [pi, 2 pi) all of x < 0 and of the rest where x0 > 0; and everything from 2 pi on. Where x0 = 0 the clamp changes nothing or phi - a = -pi.
// Sums are taken in one order and nothing is fused, so every instruction set gives the same bits. Exponents of the speed other than 1 to 4 take the
// library's power lane by lane.

#include "terrain/fields/sea_kernel.h"

#include "terrain/isa.h"

#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "terrain/fields/sea_kernel.cpp"
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
using M = hn::Mask<D>;

HWY_INLINE V set(double x)
{
    return hn::Set(D(), x);
}

/// a b + c, rounded twice.
HWY_INLINE V times_plus(V a, V b, V c)
{
    return hn::Add(hn::Mul(a, b), c);
}

struct Turn {
    V sine, cosine;
};

/// As sin_cos() of math/sincos.h.
HWY_INLINE Turn sin_cos_of(V angle)
{
    const D d;
    const DI di;
    const V turns = hn::Round(hn::Mul(angle, set(0.63661977236758134)));
    const V r = hn::Sub(hn::Sub(angle, hn::Mul(turns, set(1.5707963267341256))), hn::Mul(turns, set(6.0771005065061922e-11))), q = hn::Mul(r, r);
    V s = set(2.8114572543455206e-15);
    for (const double k : {-7.6471637318198164e-13, 1.6059043836821613e-10, -2.505210838544172e-8, 2.7557319223985893e-6, -1.9841269841269841e-4,
                           8.3333333333333332e-3, -1.6666666666666666e-1})
        s = times_plus(s, q, set(k));
    V c = set(4.7794773323873853e-14);
    for (const double k : {-1.1470745597729725e-11, 2.08767569878681e-9, -2.7557319223985888e-7, 2.4801587301587302e-5, -1.3888888888888889e-3,
                           4.1666666666666664e-2, -0.5})
        c = times_plus(c, q, set(k));
    s = hn::Add(r, hn::Mul(hn::Mul(r, q), s));
    c = times_plus(q, c, set(1.0));
    const auto quadrant = hn::ConvertTo(di, turns);
    const auto bit = [&](int k) { return hn::RebindMask(d, hn::TestBit(quadrant, hn::Set(di, k))); };
    const M odd = bit(1), low = bit(2);
    const V a = hn::IfThenElse(odd, c, s), b = hn::IfThenElse(odd, s, c);
    return {hn::IfThenElse(low, hn::Neg(a), a), hn::IfThenElse(hn::Xor(odd, low), hn::Neg(b), b)};
}

/// The cosine alone, within 2e-16 up to angles of 1e4: whole half-turns are taken off, Taylor's series to the power 22 on [-pi/2, pi/2].
HWY_INLINE V cosine_of(V angle)
{
    const D d;
    const DI di;
    const V turns = hn::Round(hn::Mul(angle, set(0.5 * 0.63661977236758134)));
    const V r = hn::Sub(hn::Sub(angle, hn::Mul(turns, set(2.0 * 1.5707963267341256))), hn::Mul(turns, set(2.0 * 6.0771005065061922e-11)));
    const V q = hn::Mul(r, r);
    V c = set(-8.8967913924505741e-22);
    for (const double k : {4.1103176233121648e-19, -1.5619206968586225e-16, 4.7794773323873853e-14, -1.1470745597729725e-11, 2.08767569878681e-9,
                           -2.7557319223985888e-7, 2.4801587301587302e-5, -1.3888888888888889e-3, 4.1666666666666664e-2, -0.5, 1.0})
        c = times_plus(c, q, set(k));
    return hn::Xor(c, hn::BitCast(d, hn::ShiftLeft<63>(hn::ConvertTo(di, turns))));
}

/// e^-x for x >= 0, within 4e-16 of its value: 2^-n by the exponent's bits, Taylor's series to the power 13 on [-ln 2 / 2, ln 2 / 2].
HWY_INLINE V decayed(V x)
{
    const D d;
    const DI di;
    const V n = hn::Round(hn::Mul(hn::Min(x, set(700.0)), set(1.4426950408889634)));
    // ln 2 in two parts, the first of 32 bits.
    const V r = hn::Sub(hn::Mul(n, set(0x1.62e42feep-1)), hn::Min(x, set(700.0))), rest = hn::Add(r, hn::Mul(n, set(1.9082149292705877e-10)));
    V sum = set(1.0 / 6227020800.0);
    for (const double k : {1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
                           1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0})
        sum = times_plus(sum, rest, set(k));
    const auto exponent = hn::ShiftLeft<52>(hn::Sub(hn::Set(di, 1023), hn::ConvertTo(di, n)));
    return hn::Mul(sum, hn::BitCast(d, exponent));
}

HWY_INLINE V clamped(V x, double lo, double hi)
{
    return hn::Min(hn::Max(x, set(lo)), set(hi));
}

HWY_INLINE V smooth(V a)
{
    const V x = clamped(a, 0.0, 1.0);
    return hn::Mul(hn::Mul(x, x), hn::Sub(set(3.0), hn::Add(x, x)));
}

HWY_INLINE V power_of(V base, double exponent)
{
    const D d;
    if (exponent == 1.0) return base;
    const V square = hn::Mul(base, base);
    if (exponent == 2.0) return square;
    if (exponent == 3.0) return hn::Mul(square, base);
    if (exponent == 4.0) return hn::Mul(square, square);
    alignas(64) double lanes[8];
    hn::Store(base, d, lanes);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) lanes[i] = std::pow(lanes[i], exponent);
    return hn::Load(d, lanes);
}

HWY_INLINE bool none(M mask)
{
    return hn::AllFalse(D(), mask);
}

/// The swells over a place of the plane.
HWY_INLINE V swell_height(const SeaLanes& sea, V x, V y, double t)
{
    V sum = set(0.0);
    if (sea.trains.empty()) return sum;
    const double width = 1.0 / (sea.fade.outer - sea.fade.inner);
    const auto kept = [&](V p, double centre) {
        return hn::Sub(set(1.0), smooth(hn::Mul(hn::Sub(hn::Abs(hn::Sub(p, set(centre))), set(sea.fade.inner)), set(width))));
    };
    const V weight = hn::Mul(kept(x, sea.fade.centre.x), kept(y, sea.fade.centre.y));
    if (none(hn::Gt(weight, set(0.0)))) return sum;
    for (const Swell& s : sea.trains) {
        const V angle = hn::Add(hn::Add(hn::Mul(x, set(s.wave_number.x)), hn::Mul(y, set(s.wave_number.y))), set(s.phase - s.frequency * t));
        sum = times_plus(cosine_of(angle), set(s.amplitude), sum);
    }
    return hn::Mul(sum, weight);
}

/// omega = v / r of the paper.
HWY_INLINE V turn_rate(const WaveShape& w, V r)
{
    const V fade = clamped(hn::Mul(hn::Sub(set(w.outer), r), set(1.0 / (w.outer - w.core))), 0.0, 1.0);
    return hn::IfThenElse(hn::Le(r, set(w.core)), set(1.0 / w.core), hn::Div(power_of(fade, w.alpha), r));
}

struct Place {
    V x, z;
};

/// Where the turning brought the points from; they are in air where it has gone past the cut.
HWY_INLINE Place circular_of(const WaveShape& w, V x, V z, V rho, V duration)
{
    const V phi = hn::Mul(turn_rate(w, rho), duration), zero = set(0.0);
    const Turn turn = sin_cos_of(phi);
    const V x0 = hn::Add(hn::Mul(x, turn.cosine), hn::Mul(z, turn.sine)), z0 = hn::Sub(hn::Mul(z, turn.cosine), hn::Mul(x, turn.sine));
    const M left = hn::Lt(x, zero), first = hn::Lt(phi, set(std::numbers::pi));
    const M past = hn::Or(hn::Or(hn::And(hn::And(first, left), hn::Ge(x0, zero)), hn::AndNot(first, hn::Or(left, hn::Gt(x0, zero)))),
                          hn::Ge(phi, set(2.0 * std::numbers::pi)));
    return {hn::IfThenZeroElse(past, x0), hn::IfThenElse(past, rho, z0)};
}

/// And the flight along the parabolas, for x < 0; other lanes hold nothing.
HWY_INLINE Place parabolic_of(const WaveShape& w, V x, V z, V rho, V duration)
{
    const V square = hn::Mul(x, x), d = hn::Sqrt(times_plus(z, z, hn::Add(square, square))), zero = set(0.0);
    const V r = hn::IfThenElse(hn::Ge(z, zero), hn::Mul(set(0.5), hn::Add(z, d)), hn::Div(square, hn::Sub(d, z)));
    const V psi = hn::Add(hn::Mul(turn_rate(w, r), duration), hn::Div(x, r));
    const M over = hn::Ge(psi, set(2.0 * std::numbers::pi)), flew = hn::Gt(psi, zero);
    const Turn turn = sin_cos_of(clamped(psi, 0.0, 7.0));
    const V air = hn::IfThenElse(over, r, times_plus(rho, smooth(hn::Neg(psi)), r));
    const M there = hn::AndNot(over, flew);
    return {hn::IfThenElseZero(there, hn::Mul(r, turn.sine)), hn::IfThenElse(there, hn::Mul(r, turn.cosine), air)};
}

/// What one breaker makes of points that lie `calm` above the calm sea.
HWY_INLINE V deviation_of(const SeaLanes& sea, const Breaker& b, V px, V py, V pz, V calm, double t)
{
    const Vec2d centre = b.centre_at(t), across = b.across(), along = b.along();
    const V fx = hn::Sub(px, set(centre.x)), fy = hn::Sub(py, set(centre.y)), zero = set(0.0), one = set(1.0);
    const V x = hn::Add(hn::Mul(fx, set(across.x)), hn::Mul(fy, set(across.y)));
    const M near = hn::Lt(x, set(b.shape.outer));
    if (none(near)) return zero;

    // Its life at each place of the crest.
    const V y = hn::Add(hn::Mul(fx, set(along.x)), hn::Mul(fy, set(along.y)));
    const V lag = hn::Sub(hn::Sqrt(times_plus(y, y, set(b.peel_width * b.peel_width))), set(b.peel_width));
    const V since = hn::Sub(set(t - b.start), hn::Mul(lag, set(1.0 / b.peel))), tau = hn::Sub(since, set(b.steepening));
    const V duration = hn::Mul(smooth(hn::Mul(since, set(1.0 / b.steepening))), set(b.intensity));
    const M live = hn::And(near, hn::Gt(duration, zero));
    if (none(live)) return zero;
    const V fallen = smooth(hn::Mul(tau, set(1.0 / b.collapse)));

    V sum = zero;
    const M curls = hn::And(live, hn::Lt(fallen, one));
    if (!none(curls)) {
        const V z = hn::Sub(pz, set(sea.level + b.shape.depth)), rho = hn::Sqrt(times_plus(x, x, hn::Mul(z, z))), depth = set(b.shape.depth);
        const auto level = [&](const Place& from) {
            const V at_x = hn::Add(hn::Add(set(centre.x), hn::Mul(y, set(along.x))), hn::Mul(from.x, set(across.x)));
            const V at_y = hn::Add(hn::Add(set(centre.y), hn::Mul(y, set(along.y))), hn::Mul(from.x, set(across.y)));
            return hn::Sub(hn::Add(from.z, depth), swell_height(sea, at_x, at_y, t));
        };
        V wave = calm;
        const M turns = hn::And(curls, hn::Lt(rho, set(b.shape.outer)));
        if (!none(turns)) wave = hn::IfThenElse(turns, level(circular_of(b.shape, x, z, rho, duration)), calm);
        const M left = hn::And(curls, hn::Lt(x, zero));
        if (!none(left)) {
            const Place from = parabolic_of(b.shape, x, z, rho, duration);
            const M deeper = hn::And(left, hn::Lt(hn::Sub(hn::Add(from.z, depth), set(sea.highest)), wave));
            if (!none(deeper)) wave = hn::IfThenElse(deeper, hn::Min(wave, level(from)), wave);
        }
        sum = hn::IfThenElseZero(curls, hn::Mul(hn::Sub(one, fallen), hn::Sub(wave, calm)));
    }
    const M falls = hn::And(live, hn::Gt(fallen, zero));
    if (!none(falls)) {
        const V white = hn::Mul(decayed(hn::Mul(hn::Max(tau, zero), set(1.0 / b.decay))), set(b.bore)), s = hn::Mul(x, set(1.0 / b.shape.outer));
        const V a = hn::Max(zero, hn::Sub(one, hn::Mul(s, s))), square = hn::Mul(a, a), fourth = hn::Mul(square, square);
        sum = hn::Sub(sum, hn::IfThenElseZero(falls, hn::Mul(hn::Mul(fallen, white), hn::Mul(fourth, fourth))));
    }
    return sum;
}

void values_of(const SeaLanes& sea, const SeaPoints& points, double t, double* values)
{
    const D d;
    for (std::size_t i = 0; i < SeaLanes::count; i += hn::Lanes(d)) {
        const V x = hn::Load(d, points.x + i), y = hn::Load(d, points.y + i), z = hn::Load(d, points.z + i);
        const V calm = hn::Sub(hn::Sub(z, set(sea.level)), swell_height(sea, x, y, t));
        V sum = calm;
        for (const Breaker& b : sea.breakers) sum = hn::Add(sum, deviation_of(sea, b, x, y, z, calm, t));
        hn::StoreU(sum, d, values + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hoodoo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hoodoo
{

void sea_values(const SeaLanes& sea, const SeaPoints& points, double t, double* values)
{
    HOODOO_KERNEL(values_of)(sea, points, t, values);
}

}  // namespace hoodoo
#endif
