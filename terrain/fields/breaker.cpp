// The break runs along the crest from its middle; every place of the crest has its own age (Gamito2001, section 4.2.3, the intensity T(y, t)).
//   since(y, t) = t - start - (sqrt(y^2 + w^2) - w) / peel;  T = Tmax S(since / steepening);  tau = since - steepening;
//   c = S(tau / collapse);  white = H exp(-max(tau, 0) / decay);  S a smoothstep.
// Deviations: the paper stops before the wave falls; collapse and decay are ours. Bounds: every factor is monotone in since, and since in |y| and t.
#include "terrain/fields/breaker.h"

#include "terrain/math/smoothstep.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 1e-12;

}  // namespace

BreakerLife life(const Breaker& b, double y, double t)
{
    const double root = std::sqrt(y * y + b.peel_width * b.peel_width);
    const double since = t - b.start - (root - b.peel_width) / b.peel, delay = y / root / b.peel;  // d(since)/dy = -delay
    BreakerLife l{};
    const double a = since / b.steepening, k = smoothstep_slope(a) * b.intensity / b.steepening;
    l.duration = b.intensity * smoothstep(a);
    l.duration_t = k;
    l.duration_y = -k * delay;
    const double tau = since - b.steepening, c = smoothstep_slope(tau / b.collapse) / b.collapse;
    l.fallen = smoothstep(tau / b.collapse);
    l.fallen_t = c;
    l.fallen_y = -c * delay;
    l.white = tau > 0.0 ? b.bore * std::exp(-tau / b.decay) : b.bore;
    l.white_t = tau > 0.0 ? -l.white / b.decay : 0.0;
    l.white_y = -l.white_t * delay;
    l.since_fall = tau;
    return l;
}

BreakerBound life_bound(const Breaker& b, const Interval& y, const Interval& times)
{
    const double near = std::max({0.0, y.lo, -y.hi}), far = y.magnitude();
    const auto lag = [&](double d) { return (std::sqrt(d * d + b.peel_width * b.peel_width) - b.peel_width) / b.peel; };
    const double size = kRounding * (1.0 + times.magnitude() + std::abs(b.start) + lag(far));
    const Interval since{times.lo - b.start - lag(far) - size, times.hi - b.start - lag(near) + size};
    const double delay = far / std::sqrt(far * far + b.peel_width * b.peel_width) / b.peel, delay_slope = 1.0 / (b.peel_width * b.peel);
    BreakerBound l;
    const Interval a = since.scaled(1.0 / b.steepening), c = Interval{since.lo - b.steepening, since.hi - b.steepening}.scaled(1.0 / b.collapse);
    l.duration = {b.intensity * smoothstep(a.lo), b.intensity * smoothstep(a.hi)};
    l.fallen = {smoothstep(c.lo), smoothstep(c.hi)};
    const auto bend = [](const Interval& i) { return i.hi <= 0.0 || i.lo >= 1.0 ? 0.0 : 6.0; };
    const double k = b.intensity / b.steepening;
    l.duration_y = k * smoothstep_steepest(a) * delay;
    l.duration_yy = k * (bend(a) / b.steepening * delay * delay + smoothstep_steepest(a) * delay_slope);
    l.fallen_y = smoothstep_steepest(c) / b.collapse * delay;
    l.fallen_yy = (bend(c) / b.collapse * delay * delay + smoothstep_steepest(c) * delay_slope) / b.collapse;
    l.white = {b.bore * std::exp(-std::max(0.0, since.hi - b.steepening) / b.decay),
               b.bore * std::exp(-std::max(0.0, since.lo - b.steepening) / b.decay)};
    l.white_y = l.white.hi / b.decay * delay;
    l.white_yy = l.white.hi / b.decay * (delay * delay / b.decay + delay_slope);
    l.since_fall = {since.lo - b.steepening, since.hi - b.steepening};
    return l;
}

}  // namespace hoodoo
