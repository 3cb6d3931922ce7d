// The heart: one camera ray becomes one sample of a picture.
#pragma once

#include "renderer/film/film.h"
#include "renderer/scene/scene.h"
#include "renderer/transport/sampler.h"

#include <span>

namespace hoodoo
{

struct PathSettings {
    int max_depth = 8;       ///< scattering events of a path; 0 = unlimited
    int roulette_depth = 3;  ///< scattering events before Russian roulette may end a path
    std::uint64_t seed = 0;
    std::uint32_t frame = 0;
    Vec2i size{0, 0};  ///< of the picture, pixels: what motion is told in; (0, 0): none is told
};

/// Sets of random numbers beside those of the events. The camera's holds the place on the film and the first scattered direction: where most of a
/// pixel's noise comes from is stratified in four dimensions together. The shutter's first number is the time.
constexpr std::uint32_t kCameraSet = 0, kShutterSet = (1u << 31) + 1;

/// Follows a path from the camera and returns what it saw. `sampler` stands at the sample.
/// `shares` has one place for each of scene.material_names(), is overwritten and referred to by the result. Pure, thread-safe, throws nothing.
PixelSample trace_path(const Scene& scene, const PathSettings& settings, const Ray& camera_ray, const Sampler& sampler, std::span<float> shares);

}  // namespace hoodoo
