// Light that comes straight from the lights: to a point, or to a ray that leaves the world.
#pragma once

#include "renderer/transport/sampler.h"
#include "renderer/transport/vertex.h"

namespace hoodoo
{

/// What the sampled lights send through this point, one direction each: through air with all that is in it, and to a matte point under water the sun
/// through the surface. `set`: the first of the sampler's sets for it, one a light. `suns`: whether suns count here.
Vec3f next_event(const Scene& scene, const Vertex& v, const Scattering& scattering, const Sampler& sampler, std::uint32_t set, double time, bool suns,
                 NumberStream& random);

/// What a ray brings that leaves the world, before media. `pdf`: of the scattering that made it; infinite if no light was sampled there, as for a
/// camera ray and a mirror. `suns`: whether their discs count.
Vec3f escaped(const Scene& scene, const Vec3d& direction, double pdf, bool suns);

}  // namespace hoodoo
