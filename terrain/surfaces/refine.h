// From a patch's hit to the crossing of the field itself, in double precision; and the one rule about shading normals.
#pragma once

#include "terrain/field.h"

#include <functional>

namespace hoodoo
{

struct Refined {
    double t = 0.0;      ///< metres along the ray
    double error = 0.0;  ///< the field changes its sign along the ray within this distance of ray.at(t), metres
};

/// The crossing of the kind ray.crossing nearest to `t`, where |field| <= value_error is known. If the field does not change its sign within a
/// thousandth of `scale` around t (a graze), t is kept and the error is that thousandth.
Refined refine_crossing(const std::function<double(const Vec3d&)>& field, const Ray& ray, double t, double value_error, double scale);
Refined refine_crossing(const Field& field, const Ray& ray, double t, double value_error, double scale);

/// The unit vector `shading`, mirrored at the tangent plane of `geometric` if it lies below it: continuous, where turning it round would jump.
Vec3d into_hemisphere(const Vec3d& shading, const Vec3d& geometric);

}  // namespace hoodoo
