// The sun seen from under water: which directions a smooth boundary bends towards it, and how much light they bring.
#pragma once

#include "renderer/media/stream.h"
#include "renderer/transport/vertex.h"

namespace hoodoo
{

/// An unbiased estimate of what reaches the matte point `v` within `water` from the sun's sample `to`, by exactly one refraction at the body's
/// surface, scattered towards v.wo. Reflected light, and light through more boundaries, is not part of it.
Vec3f sun_through_boundary(const Scene& scene, const Vertex& v, const Scattering& scattering, const Interior& water, const LightSample& to,
                           double time, NumberStream& random);

}  // namespace hoodoo
