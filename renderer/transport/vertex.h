// A point where a path scatters: on a surface or within a medium.
#pragma once

#include "renderer/media/phase.h"
#include "renderer/media/stream.h"
#include "renderer/scene/scene.h"
#include "renderer/shading/bsdf.h"

#include <array>
#include <variant>

namespace hoodoo
{

/// A point of a path, ready to scatter. The members from `at` to `surface` are those of a surface and have no meaning within a medium.
struct Vertex {
    Interaction at;        ///< both normals on the side of `wo`; the materials that scatter here
    MaterialWeights seen;  ///< all that are seen
    Appearance look;
    bool from_inside = false;           ///< the path came from within the matter, or from behind an open mesh
    const Interior* surface = nullptr;  ///< what lies within the matter, if light passes its surface
    const Interior* around = nullptr;   ///< what the path came through; nullptr: air
    Vec3d point;                        ///< in a medium: the place itself; on a surface: on the side of `wo`, proved not to be beyond it
    Vec3d wo;                           ///< unit, towards the previous point
    double footprint = 0.0;             ///< metres

    /// What lies on the side of a direction; nullptr: air.
    const Interior* medium_towards(const Vec3d& w) const
    {
        return surface && w.dot(at.geometric_normal) < 0.0 ? (from_inside ? nullptr : surface) : around;
    }
};

/// How it scatters there.
using Scattering = std::variant<Bsdf, HenyeyGreenstein>;

BsdfValue evaluate(const Scattering& scattering, const Vec3d& wo, const Vec3d& wi);
BsdfSample sample(const Scattering& scattering, const Vec3d& wo, const std::array<double, 3>& u);

/// Where `ray`, which came through `around`, meets a surface. Where foam covers a part of a water's surface, light meets one or the other, drawn from
/// `random` by their shares.
Vertex surface_vertex(const Scene& scene, const Ray& ray, const TraceHit& hit, const Interior* around, NumberStream& random);
Scattering surface_scattering(const Vertex& v);

/// A place within a medium, `t` metres along the ray.
Vertex medium_vertex(const Ray& ray, double t, const Interior* around);

/// A matte surface scatters over the hemisphere: what the scattered ray looks up may be averaged over a sixteenth of it, a cone about half as wide as
/// long.
constexpr double kMatteSpread = 0.5;

/// The ray from `v` in that direction. In air it looks for entries into matter alone; in water for its surface too.
Ray leave(const Vertex& v, const Vec3d& direction, double time, double spread = kMatteSpread);

}  // namespace hoodoo
