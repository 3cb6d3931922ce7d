// A walk on the manifold of refracted paths (Hanika2015), started at random and repeated until it finds its end again (Zeltner2020).
//
// A ray from the point along w leaves the water at y(w), with the normal n there (relief included), in the direction t(w). Wanted: t(w) = s, the sun.
// The unknown w has two degrees of freedom, t as well, and both live on the sphere: Newton's steps need no parameters of the surface, only three
// rays,
//     J = dt / dw by differences,   w <- w - J^-1 (t - s),   shortened while the distance to s grows.
// At the solution |det J| = dw_t / dw_w is the ratio of solid angles, caustics included: the irradiance E facing the sun arrives as
//     sum over solutions of  f(w) cos  (1 - F) E / |det J|  times the transmittance in water and in air          (basic radiance: no factor n^2).
// All solutions lie within 90 degrees - asin(1/n) of the sun, the most a boundary can bend; that cone has a share of the starts, the rest expects
// water as flat as it is ahead. A start leads to a solution with an unknown probability p; the number of further walks until the same solution is
// found again has the mean 1/p, which makes the estimate unbiased for any number of solutions. Deviations: at most kTrials walks, so a solution that
// one start in 256 finds is a third too dark; two solutions nearer than kSame are one. Missing: reflected caustics (glitter on the banks), boundaries
// in a row, the sun's shadow of a crest that stands between (it is black).
#include "renderer/transport/manifold.h"

#include "renderer/shading/coat.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kDifference = 2e-5;  // of directions, radians: 2 mm at 100 m
constexpr double kClose = 1e-6;       // to the sun, radians: its disc is 5000 times as wide
constexpr double kSame = 1e-4;        // radians between two solutions
constexpr double kLongestStep = 0.25;
constexpr int kSteps = 24, kHalvings = 6, kTrials = 256;

/// Where a direction from the point leads.
struct Exit {
    Vec3d towards;                         ///< t(w), unit, in air
    double distance = 0.0, passing = 0.0;  ///< metres in water; share of light that leaves it
    Vec3d outside;                         ///< origin of the ray in air
};

struct Solution {
    Vec3d w;
    double stretch = 0.0;  ///< |det J|
    Exit exit;
};

class Walk
{
public:
    Walk(const Scene& scene, const Vertex& v, const Interior& water, const Vec3d& sun, double time)
        : scene_(scene), v_(v), water_(water), sun_(sun), time_(time)
    {
        orthonormal_frame(sun_, e1_, e2_);
    }

    std::optional<Solution> from(const Vec3d& start) const
    {
        Vec3d w = start;
        std::optional<Exit> here = exit(w);
        for (int step = 0; here && step < kSteps; ++step) {
            const Vec2d off = residual(*here);
            Vec3d a, b;
            orthonormal_frame(w, a, b);
            const auto by_a = exit((w + a * kDifference).normalized()), by_b = exit((w + b * kDifference).normalized());
            if (!by_a || !by_b) return std::nullopt;
            const Vec2d ja = (residual(*by_a) - off) / kDifference, jb = (residual(*by_b) - off) / kDifference;
            const double det = ja.x * jb.y - ja.y * jb.x;
            if (!(std::abs(det) > 0.0)) return std::nullopt;
            if (off.length() < kClose && here->towards.dot(sun_) > 0.0) return Solution{w, std::abs(det), *here};
            Vec2d move(-(jb.y * off.x - jb.x * off.y) / det, -(ja.x * off.y - ja.y * off.x) / det);
            if (move.length() > kLongestStep) move *= kLongestStep / move.length();
            here = shortened(w, a, b, move, (here->towards - sun_).length());
        }
        return std::nullopt;
    }

    /// Of the surface in the direction of the sun.
    std::optional<Vec3d> normal_ahead() const
    {
        Ray ray = leave(v_, sun_, time_, 0.0);
        ray.crossing = Crossing::any;
        const TraceHit hit = scene_.tracer().intersect(ray);
        return hit.valid ? std::optional(scene_.tracer().interact(ray, hit).geometric_normal) : std::nullopt;
    }

private:
    Vec2d residual(const Exit& at) const { return Vec2d(at.towards.dot(e1_), at.towards.dot(e2_)); }

    /// The longest step along `move` that brings the ray nearer to the sun; moves w.
    std::optional<Exit> shortened(Vec3d& w, const Vec3d& a, const Vec3d& b, Vec2d move, double distance) const
    {
        for (int i = 0; i <= kHalvings; ++i, move *= 0.5) {
            const Vec3d next = (w + a * move.x + b * move.y).normalized();
            const std::optional<Exit> there = exit(next);
            if (!there || !((there->towards - sun_).length() < distance)) continue;
            w = next;
            return there;
        }
        return std::nullopt;
    }

    std::optional<Exit> exit(const Vec3d& w) const
    {
        Ray ray = leave(v_, w, time_, 0.0);
        ray.crossing = Crossing::any;
        const TraceHit hit = scene_.tracer().intersect(ray);
        if (!hit.valid) return std::nullopt;
        Interaction at = scene_.tracer().interact(ray, hit);
        float open = 0.0f;
        std::size_t which = 0;
        if (scene_.interior(hit.object, at, &open, &which) != &water_ || !(w.dot(at.geometric_normal) > 0.0)) return std::nullopt;
        const std::uint8_t material = at.materials.index[which];
        at.materials = {};
        at.materials.add(material, 1.0f);
        const Vec3d inwards = -scene_.appearance(hit.object, at, ray.footprint(at.t)).normal;
        const double cosine = -w.dot(inwards);
        if (!(cosine > 0.0)) return std::nullopt;
        Exit out;
        out.towards = refracted(-w, inwards, 1.0 / water_.ior);
        if (!(out.towards.dot(at.geometric_normal) > 0.0)) return std::nullopt;
        out.distance = at.t;
        out.passing = (1.0 - fresnel_dielectric(cosine, 1.0 / water_.ior)) * static_cast<double>(open);  // what foam leaves of the surface
        out.outside = at.position + at.geometric_normal * at.spawn_offset;
        return out;
    }

    const Scene& scene_;
    const Vertex& v_;
    const Interior& water_;
    Vec3d sun_, e1_, e2_;
    double time_;
};

/// Where walks begin: mostly where a boundary as flat as the one straight ahead would have the solution, sometimes as if it were tilted, sometimes
/// anywhere that a boundary of that index can bend to the sun.
class Starts
{
public:
    Starts(const Vec3d& sun, double ior, const Vec3d& normal) : sun_(sun), ior_(ior), normal_(normal)
    {
        orthonormal_frame(sun_, a_, b_);
        orthonormal_frame(normal_, u_, v_);
    }

    Vec3d draw(NumberStream& random) const
    {
        const double kind = random(), angle = 2.0 * kPi * random(), radius = random();
        const double x = std::cos(angle), y = std::sin(angle);
        if (kind < kAnywhere) {
            const double cosine = 1.0 - radius * (1.0 - 1.0 / ior_), sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
            return sun_ * cosine + a_ * (sine * x) + b_ * (sine * y);
        }
        const double slope = kind < kAnywhere + kTilted ? kSteepest * std::sqrt(radius) : 0.0;
        const Vec3d normal = (normal_ + (u_ * x + v_ * y) * slope).normalized();
        return normal.dot(sun_) > 0.0 ? -refracted(sun_, normal, ior_) : sun_;
    }

private:
    static constexpr double kAnywhere = 0.15, kTilted = 0.15, kSteepest = 0.5;

    Vec3d sun_;
    double ior_;
    Vec3d normal_, a_, b_, u_, v_;
};

}  // namespace

Vec3f sun_through_boundary(const Scene& scene, const Vertex& v, const Scattering& scattering, const Interior& water, const LightSample& to,
                           double time, NumberStream& random)
{
    const Walk walk(scene, v, water, to.direction, time);
    const Starts starts(to.direction, water.ior, walk.normal_ahead().value_or(to.direction));
    const auto found = walk.from(starts.draw(random));
    if (!found) return Vec3f(0.0f);

    const double scale = found->exit.passing / (found->stretch * (to.delta ? 1.0 : to.pdf));
    Vec3f part = evaluate(scattering, v.wo, found->w).value * to.value * static_cast<float>(scale);
    if (part == Vec3f(0.0f)) return part;
    Ray out;
    out.origin = found->exit.outside;
    out.direction = to.direction;
    out.time = time;
    out.crossing = Crossing::entering;
    if (scene.tracer().occluded(out)) return Vec3f(0.0f);
    part *= scene.media().transmittance(leave(v, found->w, time), found->exit.distance, &water, random);
    part *= scene.media().transmittance(out, kInfinity, nullptr, random);
    if (part == Vec3f(0.0f)) return part;

    // How often does a start lead here?
    int trials = 1;
    for (; trials < kTrials; ++trials) {
        const auto again = walk.from(starts.draw(random));
        if (again && (again->w - found->w).length() < kSame) break;
    }
    return part * static_cast<float>(trials);
}

}  // namespace hoodoo
