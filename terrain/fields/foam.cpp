// White where water breaks: three weights say where, noise carried by the flow says how it is torn.
// Gamito2001, section 4.2.3: "the spray and the foam are modelled with procedural density functions"; which functions it leaves open. Ours, for one
// wave of unit u (its core by the paper's 0.75), with S the smoothstep, keep = 1 - c:
//   lip     keep S(falling / 0.5u) exp(-(x0 / 0.4u)^2) S(1 - |F_par| / 0.6u):  the water that was foremost, as it flies;
//   impact  keep S(-x / 0.3u) S((0.9u - z) / 0.6u) S(1 - (F_circ+ + F_par+) / 0.9u):  where sheet and trough meet, the seam included;
//   white   c exp(-tau / 1.5 decay) g(x),  g a bell before the front and an exponential tail behind it:  white water;
//   w = 1 - (1 - lip)(1 - impact)(1 - white),  base = w (1 - F / h)^2 for 0 <= F < h,  density = spray base clamp(1.5 base - 0.3 + n, 0, 1).
// n is fBm at the place that the circular flow alone carried here: it has no seam, so nothing tears. Of several waves the densest counts. The
// majorant takes each factor's own bound: F, F_circ and F_par by intervals, the bells by the ends of x, |n| by its proved bound. On the water foam is
// lace: the lines n = 0 of a noise of the rest place, wider where there is more of it; it stays on the water, is drawn up the face with it, and
// remains behind the wave. Missing: bubbles below the surface.
#include "terrain/fields/foam.h"

#include "terrain/math/noise.h"
#include "terrain/math/smoothstep.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

constexpr Fractal kPuffs{3.0, 2.17, 0.5};

double unit_of(const Breaker& b)
{
    return b.shape.core / 0.75;
}

double bell(double x)
{
    return std::exp(-x * x);
}

/// g of the white water: highest at the front.
double spread(const Breaker& b, double x)
{
    return x < 0.0 ? bell(x / (0.6 * b.bore_width())) : std::exp(-x / (1.2 * b.bore_width()));
}

double together(double a, double b, double c)
{
    return 1.0 - (1.0 - a) * (1.0 - b) * (1.0 - c);
}

/// Share of the lines |n| < a / 2 at `q`, in meshes; their mean where the footprint (in meshes too) hides them.
double lace(const Vec2d& q, double a, double footprint, std::uint32_t seed)
{
    if (!(a > 0.0)) return 0.0;
    const double mean = std::min(a, 1.0), kept = footprint > 0.0 ? smoothstep(0.5 / footprint - 1.0) : 1.0;
    if (kept == 0.0) return mean;
    const Noise2 bend = gradient_noise(q * 0.7, seed + 1);
    const Vec2d bent = q + bend.gradient * 0.12;
    const double wide = std::abs(gradient_noise(bent, seed + 2).value), fine = std::abs(gradient_noise(bent * 2.7, seed + 3).value);
    const double edge = 0.06;
    const double lines = smoothstep((0.5 * a - wide) / edge + 0.5), threads = smoothstep((0.4 * a - 0.04 - fine) / edge + 0.5);
    return mean + ((1.0 - (1.0 - lines) * (1.0 - threads)) - mean) * kept;
}

struct Weights {
    double lip = 0.0, impact = 0.0, white = 0.0;
};

Weights weights(const BreakerPoint& at, const Breaker& b)
{
    const double u = unit_of(b), keep = 1.0 - at.life.fallen, x = at.local.x;
    Weights w;
    if (at.life.fallen > 0.0) w.white = at.life.fallen * std::exp(-at.life.since_fall / (1.5 * b.decay)) * spread(b, x);
    if (!(x < 0.0) || keep == 0.0) return w;
    if (at.flying.falling > 0.0)
        w.lip =
            keep * smoothstep(at.flying.falling / (0.5 * u)) * bell(at.flying.at.x / (0.4 * u)) * smoothstep(1.0 - std::abs(at.flown) / (0.6 * u));
    w.impact = keep * smoothstep(-x / (0.3 * u)) * smoothstep((0.9 * u - at.local.z) / (0.6 * u)) *
               smoothstep(1.0 - (std::max(at.turned, 0.0) + std::max(at.flown, 0.0)) / (0.9 * u));
    return w;
}

}  // namespace

SeaFoam::SeaFoam(const BreakingSea& sea, const FoamShape& shape, const Vec3d& origin, double open, double close)
    : sea_(sea), shape_(shape), origin_(origin), open_(open), close_(close), bounds_(find_bounds())
{
}

double SeaFoam::weight(const BreakerPoint& at, const Breaker& b) const
{
    const Weights w = weights(at, b);
    return together(w.lip, w.impact, w.white);
}

double SeaFoam::value(const Vec3d& world, double time) const
{
    const Vec3d p = world - origin_;
    const double t = seconds(time);
    double most = 0.0, level = kInfinity;
    for (const Breaker& b : sea_.breakers()) {
        if (life(b, b.along().dot(Vec2d(p.x, p.y) - b.centre_at(t)), t).duration == 0.0) continue;
        const BreakerPoint at = sea_.point(b, p, t);
        const double w = weight(at, b);
        if (!(w > 1e-3)) continue;
        if (std::isinf(level)) level = sea_.value(p, t);
        if (!(level >= 0.0 && level < shape_.height)) return 0.0;
        const double fall = 1.0 - level / shape_.height, base = (w - 1e-3) * fall * fall;
        // Where the turning alone would have brought it from.
        const WaveProfile profile(b.shape);
        const double turned = profile.turn(std::hypot(at.local.x, at.local.z)) * at.life.duration, c = std::cos(turned), s = std::sin(turned);
        const Vec3d carried(at.local.x * c + at.local.z * s, at.local.y + 0.2 * t, at.local.z * c - at.local.x * s - 0.4 * t);
        const double torn = std::clamp(1.5 * base - 0.3 + fbm(carried / shape_.puff, shape_.seed, kPuffs).value, 0.0, 1.0);
        most = std::max(most, shape_.spray * base * torn);
    }
    return most;
}

double SeaFoam::weight_bound(const Breaker& b, const Box3d& box, const Interval& times) const
{
    const BreakerPointBound at = sea_.point_bound(b, box, times);
    if (at.life.duration.hi == 0.0) return 0.0;
    const double u = unit_of(b), keep = 1.0 - at.life.fallen.lo;
    // The bell rises to the front and falls behind it.
    const double nearest = std::clamp(0.0, at.x.lo, at.x.hi);
    const double white = at.life.fallen.hi * std::exp(-std::max(0.0, at.life.since_fall.lo) / (1.5 * b.decay)) * spread(b, nearest);
    if (!(at.x.lo < 0.0) || keep == 0.0) return white;
    const double x0 = std::max({0.0, at.flown_x0.lo, -at.flown_x0.hi}), away = std::max({0.0, at.flown.lo, -at.flown.hi});
    const double lip = keep * bell(x0 / (0.4 * u)) * smoothstep(1.0 - away / (0.6 * u));
    const double impact = keep * smoothstep(-at.x.lo / (0.3 * u)) * smoothstep((0.9 * u - at.z.lo) / (0.6 * u)) *
                          smoothstep(1.0 - (std::max(at.turned.lo, 0.0) + std::max(at.flown.lo, 0.0)) / (0.9 * u));
    return together(lip, impact, white);
}

double SeaFoam::majorant(const Box3d& world, const Interval& times) const
{
    const double grain = 1e-9 + 0x1p-50 * (origin_.length() + world.size().length());
    const Box3d box(world.min - origin_ - Vec3d(grain), world.max - origin_ + Vec3d(grain));
    const Interval span{seconds(times.lo), seconds(times.hi)};
    double weight = 0.0;
    for (const Breaker& b : sea_.breakers()) weight = std::max(weight, weight_bound(b, box, span));
    if (!(weight > 1e-3)) return 0.0;
    const Interval level = sea_.local(box, span).value;
    if (level.hi < 0.0 || level.lo >= shape_.height) return 0.0;
    const double fall = 1.0 - std::max(0.0, level.lo) / shape_.height, base = (weight - 1e-3) * fall * fall;
    static const double noise = fbm_bound(kNoise3Bound, kPuffs).value;
    return shape_.spray * base * std::clamp(1.5 * base - 0.3 + noise, 0.0, 1.0) * (1.0 + 1e-9);
}

Box3d SeaFoam::find_bounds() const
{
    // How far the break has come along each crest, and what of that box may hold any: seven halvings.
    Box3d whole;
    const Interval heights = sea_.heights(), span{std::min(open_, close_), std::max(open_, close_)};
    for (const Breaker& b : sea_.breakers()) {
        const double since = span.hi - b.start;
        if (!(since > 0.0)) continue;
        const double lag = since * b.peel + b.peel_width, y = std::sqrt(std::max(0.0, lag * lag - b.peel_width * b.peel_width));
        const double x = b.shape.outer + 12.0 * b.bore_width();
        for (const double t : {span.lo, span.hi}) {
            for (const double i : {-x, x}) {
                for (const double j : {-y, y}) {
                    const Vec2d at = b.centre_at(t) + b.across() * i + b.along() * j;
                    whole.extendBy(origin_ + Vec3d(at.x, at.y, heights.lo));
                    whole.extendBy(origin_ + Vec3d(at.x, at.y, heights.hi));
                }
            }
        }
    }
    if (whole.isEmpty() || shape_.spray == 0.0) return Box3d(origin_);
    Box3d found;
    const auto search = [&](const auto& self, const Box3d& box, int levels) -> void {
        if (!(majorant(box, {0.0, 1.0}) > 0.0)) return;
        if (levels == 0) {
            found.extendBy(box);
            return;
        }
        const Vec3d size = box.size();
        const int k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        Box3d low = box, high = box;
        low.max[k] = high.min[k] = 0.5 * (box.min[k] + box.max[k]);
        self(self, low, levels - 1);
        self(self, high, levels - 1);
    };
    search(search, whole, 12);
    return found.isEmpty() ? Box3d(origin_) : found;
}

double SeaFoam::cover(const Vec3d& p, const Vec3d& rest, double t, double footprint) const
{
    if (!(shape_.cover > 0.0)) return 0.0;
    const Vec2d q = Vec2d(rest.x, rest.y) / shape_.lace;
    const double width = footprint / shape_.lace;
    double amount = 0.0;
    for (const Breaker& b : sea_.breakers()) {
        const BreakerPoint at = sea_.point(b, p, t);
        if (at.life.duration == 0.0) continue;
        const Weights w = weights(at, b);
        const double u = unit_of(b), keep = 1.0 - at.life.fallen;
        // Streaks on the top of the falling sheet; lines drawn up the face; what remains behind the front.
        double sheet = 0.0, trail = 0.0;
        if (at.origin.falling > 0.0 && at.flown < at.turned) {
            const Vec2d stretched(b.across().dot(Vec2d(rest.x, rest.y)) / (1.5 * u), b.along().dot(Vec2d(rest.x, rest.y)) / (0.22 * u));
            sheet = keep * smoothstep(at.origin.falling / u) * std::clamp(0.35 + 1.3 * gradient_noise(stretched, shape_.seed + 4).value, 0.0, 1.0);
        }
        const double speed = WaveProfile(b.shape).speed(std::hypot(at.local.x, at.local.z));
        const double face = 0.12 * keep * speed * std::min(1.0, at.life.duration / (3.0 * u));
        if (at.local.x > 0.0 && b.speed > 0.0) {
            const double age = at.local.x / b.speed;
            trail = smoothstep((at.life.since_fall - age) / b.collapse) * std::exp(-age / (1.5 * b.decay));
        }
        amount += 1.3 * w.white + 1.2 * w.lip + 1.2 * w.impact + 0.4 * sheet + face + 0.8 * trail;
    }
    return lace(q, shape_.cover * amount, width, shape_.seed);
}

}  // namespace hoodoo
