// Two motions curl a wave: its water turns about a centre until it passes straight above it, and from there flies on along a parabola.
// Gamito2001, section 4.2, equations 9 and 10. With v(r) the speed at radius r and omega = v / r:
//   circular   chi = max(theta - omega(rho) T, -3 pi/2),  x0 = rho cos chi,  z0 = rho sin chi,  theta in (-3 pi/2, pi/2];
//   parabolic  r = (z + D) / 2,  D = sqrt(z^2 + 2 x^2),  psi = clamp(omega(r) T - |x| / r, 0, 2 pi),  x0 = r sin psi,  z0 = r cos psi.
// Both inverses are closed forms: a particle's path z = r - x^2 / (2 r) does not depend on its speed. The clamps mean air: z0 is then the radius
// itself. Deviations: R1 and R2 are swapped in print (v would be defined nowhere); the core turns rigidly, v = r / R2, where the printed v = 0 would
// tear what enters it; of the two images the union is taken. Derivatives: with s = T r omega', in the frame of the radius: dz0 = (sin chi - s cos
// chi, cos chi), dx0 = (cos chi + s sin chi, -sin chi);
//   second derivatives -cos chi (s / rho + s') - s^2 sin chi / rho, s sin chi / rho, -s cos chi / rho; for x0 chi is a quarter turn further.
//   Parabolic: grad r = (x, r) / D, |Hess r| <= 1 / D, grad psi = (omega' T + q / r) grad r + x / r with q = |x| / r.
// All bounds follow from monotony of each factor in each variable, and of v, omega, |r omega'| and its derivative beyond the core (alpha >= 2).
#include "terrain/fields/wave_profile.h"

#include "terrain/math/sincos.h"
#include "terrain/math/smoothstep.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kPi = 3.141592653589793;
constexpr double kLast = -1.5 * kPi;  ///< angle at which a full circle has been undone
constexpr double kRounding = 1e-12;   ///< relative, of a few operations

/// A little wider, for what rounding does to numbers of that size.
Interval wider(const Interval& a, double size)
{
    return {a.lo - kRounding * size, a.hi + kRounding * size};
}

/// Of the cosine over an interval of angles.
Interval cosine(const Interval& angle)
{
    if (angle.hi - angle.lo >= 2.0 * kPi) return {-1.0, 1.0};
    const double a = std::cos(angle.lo), b = std::cos(angle.hi);
    const auto holds = [&](double at) { return std::floor((angle.hi - at) / (2.0 * kPi)) >= std::ceil((angle.lo - at) / (2.0 * kPi)); };
    return {holds(kPi) ? -1.0 : std::min(a, b), holds(0.0) ? 1.0 : std::max(a, b)};
}

Interval sine(const Interval& angle)
{
    return cosine({angle.lo - 0.5 * kPi, angle.hi - 0.5 * kPi});
}

/// theta in (-3 pi/2, pi/2]: the cut is the half-line above the centre, seen from the left.
double angle_of(double x, double z, bool left)
{
    const double a = std::atan2(z, x);
    return left && (a > 0.0 || (x == 0.0 && z > 0.0)) ? a - 2.0 * kPi : a;
}

/// Distances from the centre to a box.
Interval radius_of(const Interval& x, const Interval& z)
{
    const auto nearest = [](const Interval& i) { return std::max({0.0, i.lo, -i.hi}); };
    return {std::hypot(nearest(x), nearest(z)), std::hypot(x.magnitude(), z.magnitude())};
}

/// r of the parabola through (-q, z), without cancellation.
double parabola_radius(double q, double z)
{
    const double d = std::sqrt(z * z + 2.0 * q * q);
    return z >= 0.0 ? 0.5 * (z + d) : q * q / (d - z);
}

/// q / r of the same parabola; infinite on the axis below the centre.
double flight(double q, double z)
{
    const double r = parabola_radius(q, z);
    return q > 0.0 || z > 0.0 ? q / r : kInfinity;
}

}  // namespace

namespace
{

/// base^exponent: the paper's exponents without the library's general way.
double power(double base, double exponent)
{
    if (exponent == 1.0) return base;
    if (exponent == 2.0) return base * base;
    if (exponent == 3.0) return base * base * base;
    if (exponent == 4.0) return base * base * (base * base);
    return std::pow(base, exponent);
}

}  // namespace

double WaveProfile::speed(double r) const
{
    if (r <= shape_.core) return r / shape_.core;
    if (r >= shape_.outer) return 0.0;
    return power((shape_.outer - r) / (shape_.outer - shape_.core), shape_.alpha);
}

double WaveProfile::speed_slope(double r) const
{
    if (r <= shape_.core) return 1.0 / shape_.core;
    if (r >= shape_.outer) return 0.0;
    const double width = shape_.outer - shape_.core;
    return -shape_.alpha / width * power((shape_.outer - r) / width, shape_.alpha - 1.0);
}

double WaveProfile::turn(double r) const
{
    return r <= shape_.core ? 1.0 / shape_.core : speed(r) / r;
}

double WaveProfile::shear(double r) const
{
    return r <= shape_.core ? 0.0 : speed_slope(r) - speed(r) / r;
}

double WaveProfile::shear_slope(double r) const
{
    if (r <= shape_.core || r >= shape_.outer) return 0.0;
    const double width = shape_.outer - shape_.core;
    const double bend = shape_.alpha * (shape_.alpha - 1.0) / (width * width) * power((shape_.outer - r) / width, shape_.alpha - 2.0);
    return bend - speed_slope(r) / r + speed(r) / (r * r);
}

WaveOrigin WaveProfile::circular(const Vec2d& p, double duration) const
{
    WaveOrigin origin;
    const double rho = p.length();
    const double theta = angle_of(p.x, p.y, p.x < 0.0), chi = theta - turn(rho) * duration;
    const Vec2d out(std::cos(theta), std::sin(theta)), around(-out.y, out.x);
    if (chi <= kLast) {
        origin.at = Vec2d(0.0, rho);
        origin.by_x = Vec2d(0.0, out.x);
        origin.by_z = Vec2d(0.0, out.y);
        return origin;
    }
    const double c = std::cos(chi), s = std::sin(chi), k = duration * shear(rho), v = speed(rho);
    origin.at = Vec2d(rho * c, rho * s);
    const Vec2d radial(c + k * s, s - k * c), tangential(-s, c);  // of (x0, z0), along `out` and `around`
    origin.by_x = radial * out.x + tangential * around.x;
    origin.by_z = radial * out.y + tangential * around.y;
    origin.by_duration = Vec2d(v * s, -v * c);
    return origin;
}

WaveOrigin WaveProfile::parabolic(const Vec2d& p, double duration) const
{
    WaveOrigin origin;
    const double q = -p.x, d = std::sqrt(p.y * p.y + 2.0 * q * q), r = parabola_radius(q, p.y), flown = flight(q, p.y);
    const Vec2d gr = d > 0.0 ? Vec2d(p.x, r) / d : Vec2d(0.0, 1.0);
    const double psi = turn(r) * duration - flown;
    if (psi >= 2.0 * kPi) {
        origin.at = Vec2d(0.0, r);
        origin.by_x = Vec2d(0.0, gr.x);
        origin.by_z = Vec2d(0.0, gr.y);
        return origin;
    }
    if (!(psi > 0.0)) {
        const double rho = p.length(), far = smoothstep(-psi), turning = smoothstep_slope(-psi);
        Vec2d g = gr + (rho > 0.0 ? p * (far / rho) : Vec2d(0.0));
        if (turning > 0.0) {
            g -= (gr * (duration * shear(r) + flown) + Vec2d(1.0, 0.0)) * (rho / r * turning);
            origin.by_duration.y = -rho * turning * turn(r);
        }
        origin.at = Vec2d(0.0, r + rho * far);
        origin.by_x = Vec2d(0.0, g.x);
        origin.by_z = Vec2d(0.0, g.y);
        return origin;
    }
    const double c = std::cos(psi), s = std::sin(psi), k = duration * shear(r) + flown, v = speed(r);
    origin.at = Vec2d(r * s, r * c);
    const Vec2d along(s + k * c, c - k * s);  // of (x0, z0), along grad r
    origin.by_x = along * gr.x + Vec2d(c, -s);
    origin.by_z = along * gr.y;
    origin.by_duration = Vec2d(v * c, -v * s);
    origin.falling = v > 0.0 ? q / v : 0.0;
    return origin;
}

Vec2d WaveProfile::circular_place(const Vec2d& p, double duration) const
{
    const double rho = p.length();
    if (rho >= shape_.outer) return p;
    const double theta = angle_of(p.x, p.y, p.x < 0.0), chi = theta - turn(rho) * duration;
    if (chi <= kLast) return {0.0, rho};
    const SinCos at = sin_cos(chi);
    return {rho * at.cosine, rho * at.sine};
}

Vec2d WaveProfile::parabolic_place(const Vec2d& p, double duration) const
{
    const double r = parabola_radius(-p.x, p.y), psi = turn(r) * duration - flight(-p.x, p.y);
    if (psi >= 2.0 * kPi) return {0.0, r};
    if (!(psi > 0.0)) return {0.0, r + p.length() * smoothstep(-psi)};
    const SinCos at = sin_cos(psi);
    return {r * at.sine, r * at.cosine};
}

WaveBound WaveProfile::circular_bound(const Interval& x, const Interval& z, const Interval& duration) const
{
    const bool left = x.hi <= 0.0 && x.lo < 0.0;
    const Interval rho = wider(radius_of(x, z), radius_of(x, z).hi);
    Interval theta = left ? Interval{kLast, -0.5 * kPi} : Interval{-0.5 * kPi, 0.5 * kPi};
    if (radius_of(x, z).lo > 0.0) {
        const auto [lo, hi] =
            std::minmax({angle_of(x.lo, z.lo, left), angle_of(x.lo, z.hi, left), angle_of(x.hi, z.lo, left), angle_of(x.hi, z.hi, left)});
        theta = wider({lo, hi}, 4.0);
    }
    const double slow = turn(rho.hi), fast = turn(std::max(rho.lo, 0.0));
    const Interval chi = wider({theta.lo - fast * duration.hi, theta.hi - slow * duration.lo}, 4.0 + fast * duration.hi);
    const Interval cos_theta = cosine(theta), sin_theta = sine(theta);
    const bool clamped = chi.hi <= kLast, partly = chi.lo < kLast;

    WaveBound bound;
    const Interval turned{std::max(chi.lo, kLast), std::max(chi.hi, kLast)};
    const Interval c = clamped ? Interval{0.0, 0.0} : cosine(turned), s = clamped ? Interval{1.0, 1.0} : sine(turned);
    bound.x0 = wider(rho * c, rho.hi);
    bound.z0 = wider(rho * s, rho.hi);
    const double from = std::max(rho.lo, shape_.core), h = rho.hi <= shape_.core ? 0.0 : std::abs(shear(std::nextafter(from, kInfinity)));
    const Interval k = clamped ? Interval{0.0, 0.0} : Interval{-duration.hi * h, rho.lo < shape_.core ? 0.0 : -duration.lo * std::abs(shear(rho.hi))};
    Interval radial[2] = {c + k * s, s + -(k * c)}, tangential[2] = {-s, c};
    if (clamped) radial[0] = tangential[0] = {0.0, 0.0};
    if (partly) radial[0] = Interval::hull(radial[0], {0.0, 0.0}), tangential[0] = Interval::hull(tangential[0], {0.0, 0.0});
    for (int i = 0; i < 2; ++i) {
        const double size = radial[i].magnitude() + tangential[i].magnitude();
        bound.by_x[i] = wider(radial[i] * cos_theta + -(tangential[i] * sin_theta), size);
        bound.by_z[i] = wider(radial[i] * sin_theta + tangential[i] * cos_theta, size);
    }
    const double v = rho.lo <= shape_.core && rho.hi >= shape_.core ? 1.0 : std::max(speed(rho.lo), speed(rho.hi));
    bound.by_duration[0] = clamped ? Interval{0.0, 0.0} : Interval{-v, v};
    bound.by_duration[1] = clamped ? Interval{0.0, 0.0} : Interval{0.0, v} * -c;
    if (partly) bound.by_duration[1] = Interval::hull(bound.by_duration[1], {0.0, 0.0});

    // Second derivatives: none are known across the core's rim, nor at the centre of a clamped part.
    const bool rim = rho.lo < shape_.core && rho.hi > shape_.core;
    if (rim || !(rho.lo > 0.0)) {
        bound.second = bound.duration_slope = rho.hi <= shape_.core && !partly ? 0.0 : kInfinity;
        if (rho.hi <= shape_.core && !partly) bound.duration_slope = 1.0 / shape_.core;
    } else {
        const double tk = duration.hi * h, dk = duration.hi * std::abs(rho.hi <= shape_.core ? 0.0 : shear_slope(std::nextafter(from, kInfinity)));
        const double rr = tk / rho.lo + dk + tk * tk / rho.lo, rt = tk / rho.lo;
        bound.second = std::sqrt(rr * rr + 3.0 * rt * rt) + (partly || clamped ? 1.0 / rho.lo : 0.0);
        bound.duration_slope = std::abs(speed_slope(from)) + fast * (1.0 + tk);
        if (rho.lo < shape_.core) bound.duration_slope = std::max(bound.duration_slope, 1.0 / shape_.core + fast);
    }
    bound.duration_second = v * fast;
    bound.x0_bends = partly && !clamped;
    return bound;
}

WaveBound WaveProfile::parabolic_bound(const Interval& x, const Interval& z, const Interval& duration) const
{
    const double q0 = std::max(0.0, -x.hi), q1 = -x.lo;
    const Interval r = wider({parabola_radius(q0, z.lo), parabola_radius(q1, z.hi)}, parabola_radius(q1, z.hi));
    const double fast = turn(std::max(r.lo, 0.0)), slow = turn(r.hi), cap = fast * duration.hi;
    const double longest = z.lo < 0.0 ? flight(q0, z.lo) : flight(q1, z.lo);
    const double shortest = z.hi < 0.0 ? flight(q1, z.hi) : flight(q0, z.hi);
    const Interval psi = wider({slow * duration.lo - longest, cap - shortest}, 1.0 + cap + std::min(longest, 1e3));
    const bool clamped = !(psi.hi > 0.0) || psi.lo >= 2.0 * kPi;
    const bool partly = !clamped && (psi.lo < 0.0 || psi.hi > 2.0 * kPi);

    // grad r = (-q, r) / D: each component is monotone in q and in z or |z|.
    const double z_near = std::max({0.0, z.lo, -z.hi}), z_far = z.magnitude();
    const auto share = [](double q, double height) { return q > 0.0 ? q / std::sqrt(height * height + 2.0 * q * q) : 0.0; };
    Interval gr[2] = {{-0.70710678118654768, 0.0}, {0.0, 1.0}};
    const double d_least = std::sqrt(z_near * z_near + 2.0 * q0 * q0);
    if (d_least > 0.0) {
        const auto rise = [](double q, double height) { return parabola_radius(q, height) / std::sqrt(height * height + 2.0 * q * q); };
        const auto [lo, hi] = std::minmax({rise(q0, z.lo), rise(q1, z.lo), rise(q0, z.hi), rise(q1, z.hi)});
        gr[0] = wider({-share(q1, z_near), -share(q0, z_far)}, 1.0);
        gr[1] = wider({lo, hi}, 1.0);
    }

    WaveBound bound;
    const double v = r.lo <= shape_.core && r.hi >= shape_.core ? 1.0 : std::max(speed(std::max(r.lo, 0.0)), speed(r.hi));
    const double from_core = std::max(r.lo, shape_.core), h_all = r.hi <= shape_.core ? 0.0 : std::abs(shear(std::nextafter(from_core, kInfinity)));

    // Where no water has flown: r + rho S. While S rises, q / r <= omega T + 1 =: Q, so that rho / r <= Q sqrt(1 + Q^2).
    const Interval rho = radius_of(x, z), far{smoothstep(-psi.hi), smoothstep(-psi.lo)};
    const double rising =
        psi.lo >= 0.0 || psi.hi <= -1.0 ? 0.0 : smoothstep_slope(std::clamp(0.5, std::clamp(-psi.hi, 0.0, 1.0), std::clamp(-psi.lo, 0.0, 1.0)));
    const double most = cap + 1.0, pull = rising * most * std::sqrt(1.0 + most * most) * (duration.hi * h_all + most + 1.0);
    const Interval air_z0 = wider(r + rho * far, r.hi + rho.hi), away[2] = {{-1.0, 0.0}, {z.lo >= 0.0 ? 0.0 : -1.0, z.hi <= 0.0 ? 0.0 : 1.0}};
    const auto air_gradient = [&](int k) { return wider(gr[k] + far * away[k] + Interval{-pull, pull}, 2.0 + pull); };
    const double air_by_duration = rho.hi * rising * fast;
    double air_second = d_least > 0.0 ? 1.0 / d_least : kInfinity;
    if (far.hi > 0.0) air_second += rho.lo > 0.0 ? 1.0 / rho.lo : kInfinity;
    if (rising > 0.0) air_second = kInfinity;
    if (clamped) {
        bound.x0 = {0.0, 0.0};
        bound.z0 = air_z0;
        for (auto* by : {bound.by_x, bound.by_z}) by[0] = {0.0, 0.0};
        bound.by_x[1] = air_gradient(0);
        bound.by_z[1] = air_gradient(1);
        bound.by_duration[0] = {0.0, 0.0};
        bound.by_duration[1] = {-air_by_duration, 0.0};
        bound.second = air_second;
        bound.duration_slope = rising > 0.0 ? kInfinity : 0.0;
        bound.duration_second = rising > 0.0 ? kInfinity : 0.0;
        return bound;
    }
    const Interval angle{std::clamp(psi.lo, 0.0, 2.0 * kPi), std::clamp(psi.hi, 0.0, 2.0 * kPi)};
    const Interval c = cosine(angle), s = sine(angle);
    bound.x0 = wider(r * s, r.hi);
    bound.z0 = wider(r * c, r.hi);
    // Where nothing is clamped the flight is shorter than the turn: q / r <= omega T, so that r >= q / (omega T).
    const Interval flown{std::min(shortest, cap), std::min(longest, cap)};
    const double r_least = std::max(r.lo, cap > 0.0 ? q0 / cap * (1.0 - kRounding) : 0.0);
    const double from = std::max(r_least, shape_.core), h = r.hi <= shape_.core ? 0.0 : std::abs(shear(std::nextafter(from, kInfinity)));
    const Interval k = Interval{-duration.hi * h, 0.0} + flown;
    Interval along[2] = {s + k * c, c + -(k * s)};
    const Interval straight[2] = {c, -s};
    for (int i = 0; i < 2; ++i) {
        const double size = along[i].magnitude() + 1.0;
        bound.by_x[i] = wider(along[i] * gr[0] + straight[i], size);
        bound.by_z[i] = wider(along[i] * gr[1], size);
        if (!partly) continue;
        bound.by_x[i] = Interval::hull(bound.by_x[i], i == 0 ? Interval{0.0, 0.0} : air_gradient(0));
        bound.by_z[i] = Interval::hull(bound.by_z[i], i == 0 ? Interval{0.0, 0.0} : air_gradient(1));
    }
    if (psi.lo < 0.0) bound.z0 = Interval::hull(bound.z0, air_z0);
    bound.by_duration[0] = Interval::hull(Interval{0.0, v} * c, {0.0, 0.0});
    bound.by_duration[1] = Interval::hull(Interval{0.0, v} * -s, {-air_by_duration, 0.0});

    const bool rim = r_least < shape_.core && r.hi > shape_.core;
    if (rim || !(r_least > 0.0) || !(d_least > 0.0)) {
        bound.second = bound.duration_slope = kInfinity;
    } else {
        const double tk = duration.hi * h, dk = duration.hi * (r.hi <= shape_.core ? 0.0 : std::abs(shear_slope(std::nextafter(from, kInfinity))));
        const double g = tk + flown.hi, bent = 1.0 / d_least, turning = (g + 1.0) / r_least;
        bound.second = bent + 2.0 * turning + (g + 1.0) * turning + dk + tk / r_least + 2.0 * (flown.hi + 1.0) / r_least + g * bent;
        bound.duration_slope = std::max(std::abs(speed_slope(from)), r_least < shape_.core ? 1.0 / shape_.core : 0.0) + v * turning;
    }
    bound.duration_second = v * fast;
    bound.x0_bends = partly;
    if (psi.lo < 0.0) {
        bound.second = std::max(bound.second, air_second);
        if (rising > 0.0) bound.duration_slope = bound.duration_second = kInfinity;
    }
    return bound;
}

}  // namespace hoodoo
