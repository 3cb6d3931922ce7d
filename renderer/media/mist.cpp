// An even or puffy mist in a box. The puffs are fbm n (Perlin2002, N its bound) through a smoothstep,
//     density = smoothstep((n / N - (1 - 2 cover)) / softness) * product over the faces of smoothstep(distance / fade).
// Bounds over a box: the noise at its middle plus its slope bound times half the diagonal, through the monotone steps; a face's step at the point of
// the box farthest from it. The smoothstep has slope 1.5 at most and the rounding of a few operations is far under the bound's slack, except where
// the bound is 1 itself, which nothing exceeds.
#include "renderer/media/mist.h"

#include "terrain/math/smoothstep.h"

#include <algorithm>

namespace hoodoo
{
namespace
{

constexpr double kRounding = 1e-9;

Fractal fractal_of(const Puffs& puffs)
{
    return {.octaves = puffs.octaves};
}

double puff(const Puffs& puffs, double share)
{
    const double above = share - (1.0 - 2.0 * puffs.cover);
    return smoothstep(above / std::max(puffs.softness, 1e-6));
}

}  // namespace

double Mist::value(const Vec3d& p, double) const
{
    if (!box_.intersects(p)) return 0.0;
    double density = 1.0;
    if (fade_ > 0.0)
        for (int k = 0; k < 3; ++k) density *= smoothstep(std::min(p[k] - box_.min[k], box_.max[k] - p[k]) / fade_);
    if (puffs_.wavelength > 0.0 && density > 0.0) {
        const Fractal fractal = fractal_of(puffs_);
        density *= puff(puffs_, fbm(p / puffs_.wavelength, puffs_.seed, fractal).value / fbm_bound(kNoise3Bound, fractal).value);
    }
    return density;
}

double Mist::majorant(const Box3d& box, const Interval&) const
{
    if (!box_.intersects(box)) return 0.0;
    double bound = 1.0;
    if (fade_ > 0.0) {
        for (int k = 0; k < 3; ++k) {
            const double middle = 0.5 * (box_.min[k] + box_.max[k]), deepest = std::clamp(middle, box.min[k], box.max[k]);
            bound *= smoothstep(std::min(deepest - box_.min[k], box_.max[k] - deepest) / fade_);
        }
    }
    if (puffs_.wavelength > 0.0 && bound > 0.0) {
        const Fractal fractal = fractal_of(puffs_);
        const NoiseBound all = fbm_bound(kNoise3Bound, fractal);
        const double middle = fbm(box.center() / puffs_.wavelength, puffs_.seed, fractal).value;
        const double most = std::min(middle + all.slope * 0.5 * box.size().length() / puffs_.wavelength, all.value);
        bound *= puff(puffs_, most / all.value);
    }
    return bound > 0.0 ? std::min(bound + kRounding, 1.0) : 0.0;
}

}  // namespace hoodoo
