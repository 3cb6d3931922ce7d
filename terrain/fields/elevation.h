// Hills without end: a sum of scaled noise as a height, with its derivative and proved bounds.
#pragma once

#include "terrain/fields/height.h"
#include "terrain/math/noise.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace hoodoo
{

enum class ElevationKind { fbm, ridged, billow, multifractal };

/// Octaves finer than two footprints are left out, those up to four are faded; the footprint grows with the distance from the eye. A function of the
/// place alone, without a jump.
struct OctaveLimit {
    Vec3d eye{0.0};
    double spread = 0.0;   ///< width of a pixel's cone a metre of distance, above 0
    double nearest = 1.0;  ///< metres: distances below count as this
};

struct ElevationShape {
    ElevationKind kind = ElevationKind::fbm;
    Vec2d origin{0.0};           ///< a corner of the noise's lattice, metres
    double height = 0.0;         ///< mean, metres
    double relief = 100.0;       ///< metres that the sum of all octaves rises above and falls below the mean at most
    double wavelength = 1000.0;  ///< of the first octave, metres
    Fractal fractal;             ///< its octaves are whole or not; a fraction fades the last
    std::uint32_t seed = 0;
    std::optional<OctaveLimit> limit;
};

class ElevationHeight final : public Height
{
public:
    explicit ElevationHeight(const ElevationShape& shape);

    double height(const Vec2d& p) const override { return at(p).value; }
    Vec2d gradient(const Vec2d& p) const override { return at(p).gradient; }
    Interval range(const Box2d& area) const override { return bounds(area).value; }
    double slope_bound(const Box2d& area) const override { return bounds(area).slope; }
    Box2d domain() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    std::array<Interval, 2> gradient_range(const Box2d& area) const override { return bounds(area).gradient; }
    double curvature_bound(const Box2d& area) const override { return bounds(area).curvature; }

    HeightBounds bounds(const Box2d& area) const override;
    Noise2 at(const Vec2d& p) const;

private:
    struct Octave {
        double per_metre, amplitude, cosine, sine;
        Vec2d shift;
        std::uint32_t seed;
    };
    struct Fade {
        double weight = 1.0;
        Vec2d gradient{0.0};
    };
    struct Term;
    Vec2d lattice_point(const Octave& octave, const Vec2d& p) const;
    Fade fade(const Octave& octave, const Vec2d& p) const;
    Term term(const Octave& octave, const Vec2d& centre, double radius, const Interval& distance) const;

    ElevationShape shape_;
    std::vector<Octave> octaves_;
    double scale_ = 1.0;  ///< metres for a sum of 1
};

}  // namespace hoodoo
