// Flows: velocity fields along which a surface is carried (Gamito2001, section 2), with proved bounds; and the flows there are.
#pragma once

#include "terrain/fields/detail.h"
#include "terrain/math/interval.h"
#include "terrain/math/vec.h"

#include <memory>
#include <optional>
#include <vector>

namespace hoodoo
{

/// Of a map or a velocity: element [i][j] is the derivative of component i along axis j. (Imath multiplies rows: a * m is the transpose applied to
/// a.)
using Matrix3d = Imath::M33d;

/// Suprema over a box and a span of times. Norms are Euclidean; kInfinity where there is no bound.
struct FlowBound {
    double speed = 0.0;     ///< |v|, metres per unit of time
    double gradient = 0.0;  ///< |Dv|: the Lipschitz constant in space, per unit of time
    double hessian = 0.0;   ///< |D2v|: the Lipschitz constant of Dv, per metre and unit of time
    double drift = 0.0;     ///< |v(p, t) - v(q, s)| <= gradient (|p - q| + drift |t - s|), and the same for Dv with hessian; 0: steady
};

/// Where a point is carried, and the derivative of that by where it started.
struct Carried {
    Vec3d point{0.0};
    Matrix3d jacobian;
};

/// A velocity and its derivative.
struct Motion {
    Vec3d velocity{0.0};
    Matrix3d gradient;
};

/// A velocity field v(p, t), Lipschitz in p: then no two paths meet, and what is carried keeps its topology. Pure and thread-safe. "Time" is the
/// amount of warping, not the time of an animation; metres a unit of it.
class Flow
{
public:
    virtual ~Flow() = default;
    virtual Vec3d velocity(const Vec3d& p, double t) const = 0;
    /// Dv at p; one-sided where it jumps.
    virtual Matrix3d gradient(const Vec3d& p, double t) const = 0;
    /// Both at once; the velocity is velocity() but for rounding.
    virtual Motion motion(const Vec3d& p, double t) const { return {velocity(p, t), gradient(p, t)}; }
    /// Proved, over all points of the box and all times of the span.
    virtual FlowBound bound(const Box3d& box, const Interval& times) const = 0;

    /// About the largest |Dv| that is met, for the choice of steps; a proof uses bound(). By default the bound everywhere.
    virtual double usual_gradient() const;

    /// Whether carry() is a closed form. Such a flow is steady.
    virtual bool closed_form() const { return false; }
    /// Along the flow for `duration` (negative: backwards), exactly. Precondition: closed_form().
    virtual Carried carry(const Vec3d& p, double duration) const;
};

using FlowPtr = std::shared_ptr<const Flow>;

/// One octave of a flow with the weight that its distance leaves it: w v, with the product rule for its derivative and its bounds.
class FadingOctave
{
public:
    /// Full where the footprint is a quarter of the wavelength, gone at a half. By the distance over the first `axes` axes.
    FadingOctave(const std::optional<DetailView>& view, double wavelength, int axes = 3) : axes_(axes)
    {
        if (view) fade_.emplace(*view, 0.25 * wavelength);
    }
    DetailFade::Weight weight(const Vec3d& p) const { return fade_ ? fade_->at(p, axes_) : DetailFade::Weight{}; }
    /// Of the octave with the weights of the box, from those of the octave alone.
    FlowBound bound(const Box3d& box, const FlowBound& alone) const;

private:
    std::optional<DetailFade> fade_;
    int axes_;
};

// -- In closed form -------------------------------------------------------------------------------------------------------

/// Everything turns about an axis through `centre`, one radian a unit of time.
FlowPtr rotation_flow(const Vec3d& centre, const Vec3d& axis);
/// Turns about an axis as fast as exp(-(r / radius)^2) at the distance r from it.
FlowPtr vortex_flow(const Vec3d& centre, const Vec3d& axis, double radius);
/// Outwards from `centre` by q (1 - |q|^2 / R^2), q = p - centre, within the radius R; at rest beyond.
FlowPtr bulge_flow(const Vec3d& centre, double radius);
/// Along `direction` (made perpendicular to `normal`), as fast as the height above the plane through `centre`.
FlowPtr shear_flow(const Vec3d& centre, const Vec3d& normal, const Vec3d& direction);
/// v = (0, 0, f(x, y)), f a sum of noise: makes a height field of a plane (section 2). Amplitude 1, `wavelength` metres of the first octave. Octaves
/// fade by the horizontal distance.
FlowPtr vertical_flow(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed,
                      const std::optional<DetailView>& view = {});

// -- Of noise --------------------------------------------------------------------------------------------------------------
// With a view, an octave fades as a pixel grows from a quarter to a half of its wavelength, there where it acts. What is left is a flow like any
// other, so that what is carried still keeps its topology; a curl keeps volumes where nothing fades.

/// Along the gradient of a 2-D noise with cells of `wavelength` metres: horizontal, speed about 1 (the canyon's flow, section 4.1).
FlowPtr noise_gradient_flow(const Vec3d& origin, double wavelength, std::uint32_t seed, const std::optional<DetailView>& view = {});
/// The curl of three sums of 3-D noise: keeps volumes. `wavelength` metres of the first octave; speed about 1.
FlowPtr curl_flow(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed, const std::optional<DetailView>& view = {});

// -- Of other flows ----------------------------------------------------------------------------------------------------------

FlowPtr scaled_flow(FlowPtr flow, double factor);
FlowPtr sum_flow(std::vector<FlowPtr> flows);
/// The pattern of a steady flow moves with `drift` metres a unit of time: v(p, t) = v0(p - drift t).
FlowPtr drifting_flow(FlowPtr flow, const Vec3d& drift);
/// Faded out over `fade` metres outside the box, whose sides may be infinite (a mask by height).
FlowPtr masked_flow(FlowPtr flow, const Box3d& box, double fade);

/// The matrix applied to a column.
inline Vec3d apply(const Matrix3d& m, const Vec3d& v)
{
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}
/// a b^T.
inline Matrix3d outer(const Vec3d& a, const Vec3d& b)
{
    return {a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.x, a.y * b.y, a.y * b.z, a.z * b.x, a.z * b.y, a.z * b.z};
}
/// The transpose applied to a column: how a gradient comes back through a map.
inline Vec3d apply_transposed(const Matrix3d& m, const Vec3d& v)
{
    return {m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z, m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z,
            m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z};
}

}  // namespace hoodoo
