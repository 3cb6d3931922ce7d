// Points, directions, boxes, rays: Imath's types under the names used here, and the few plain values that Imath lacks.
// Right-handed, z up, metres, double precision: a terrain may lie 4000 km from the origin of its map.
#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathQuat.h>
#include <Imath/ImathVec.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace hoodoo
{

using Vec2d = Imath::V2d;
using Vec3d = Imath::V3d;
using Vec2f = Imath::V2f;
using Vec3f = Imath::V3f;
using Vec2i = Imath::V2i;
using Box3d = Imath::Box3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A straight piece of space from `a` to `b`, in metres.
struct Segment {
    Vec3d a, b;
};

/// Which crossings of a closed surface a ray looks for. `any` is right for a ray that may start anywhere, inside matter too.
/// `entering` (air to matter) is what a ray asks that is known to start in air: it is faster and cannot hit what it just left.
enum class Crossing : std::uint8_t { any, entering };

/// A ray in world space. The open interval (t_min, t_max) is in metres, since `direction` has unit length.
/// The footprint is the cone a pixel (or a scattering event) sends along the ray: its width at distance t is
/// `footprint_width + footprint_spread * t` metres. `time` is in [0, 1] between shutter opening and closing.
struct Ray {
    Vec3d origin{0.0};
    Vec3d direction{0.0, 0.0, 1.0};
    double t_min = 0.0;
    double t_max = kInfinity;
    double time = 0.0;
    double footprint_width = 0.0;
    double footprint_spread = 0.0;
    Crossing crossing = Crossing::any;

    Vec3d at(double t) const { return origin + direction * t; }
    double footprint(double t) const { return footprint_width + footprint_spread * t; }
};

inline bool is_finite(const Vec3d& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// `v` turned by the unit quaternion `q`: v + 2 r (u x v) + 2 u x (u x v) with q = (r, u). (Imath's own function depends on its row vectors.)
inline Vec3d rotated(const Imath::Quatd& q, const Vec3d& v)
{
    const Vec3d u = q.v, c = u.cross(v) * 2.0;
    return v + c * q.r + u.cross(c);
}

/// Two unit vectors that complete the unit vector `n` to a right-handed orthonormal frame (Duff2017, no branch on n.z's neighbourhood of -1).
inline void orthonormal_frame(const Vec3d& n, Vec3d& tangent, Vec3d& bitangent)
{
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    tangent = Vec3d(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    bitangent = Vec3d(b, sign + n.y * n.y * a, -n.y);
}

}  // namespace hoodoo
