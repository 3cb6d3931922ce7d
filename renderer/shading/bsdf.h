// How a surface scatters light: a closed set of models. All directions are unit, in world space, and point away from the surface.
#pragma once

#include "renderer/shading/coat.h"
#include "renderer/shading/dielectric.h"
#include "renderer/shading/diffuse.h"

#include <variant>

namespace hoodoo
{

/// Each member has evaluate(wo, wi) and sample(wo, u) with the contracts stated at Lambert. A sample of density infinity is a mirror's: evaluate()
/// leaves it out.
using Bsdf = std::variant<Lambert, RoughDiffuse, Coated, Dielectric>;

/// The model for an albedo, a roughness and a share of coat; what is coated is Lambert beneath. `shading` and `geometric` are unit normals in one
/// hemisphere, `geometric` on the side of the viewer.
inline Bsdf make_diffuse(const Vec3d& shading, const Vec3d& geometric, const Vec3f& albedo, float roughness, float coat = 0.0f)
{
    const CosineLobe lobe(shading, geometric);
    if (coat > 0.0f) return Coated(lobe, albedo, coat);
    if (roughness > 0.0f) return RoughDiffuse(lobe, albedo, roughness);
    return Lambert(lobe, albedo);
}

inline BsdfValue evaluate(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi)
{
    return std::visit([&](const auto& model) { return model.evaluate(wo, wi); }, bsdf);
}

inline BsdfSample sample(const Bsdf& bsdf, const Vec3d& wo, const std::array<double, 3>& u)
{
    return std::visit([&](const auto& model) { return model.sample(wo, u); }, bsdf);
}

}  // namespace hoodoo
