// A box of mist: a density of its own, even or in puffs of noise, that needs no terrain to carry it.
#pragma once

#include "terrain/density.h"
#include "terrain/math/noise.h"

namespace hoodoo
{

/// Puffs of an even mist's density; `wavelength` 0: even.
struct Puffs {
    double wavelength = 0.0;  ///< metres, of the largest
    double octaves = 4.0;
    double cover = 0.5;     ///< share of the noise's range that is mist, in (0, 1]
    double softness = 0.2;  ///< of that range, over which a puff goes from nothing to full density
    std::uint32_t seed = 0;
};

/// Density 1 in the box, fading to 0 over `fade` metres inside its faces, times the puffs.
class Mist final : public Density
{
public:
    Mist(const Box3d& box, double fade, const Puffs& puffs) : box_(box), fade_(fade), puffs_(puffs) {}

    double value(const Vec3d& p, double time) const override;
    double majorant(const Box3d& box, const Interval& times) const override;
    Box3d bounds() const override { return box_; }

private:
    Box3d box_;
    double fade_;
    Puffs puffs_;
};

}  // namespace hoodoo
