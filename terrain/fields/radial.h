// Curves over the distance from a skeleton: how a landform's weight falls off, and its section; with bounds over spans of the distance.
#pragma once

#include "terrain/fields/landform.h"

namespace hoodoo
{

/// Bounds of a curve f(d), d >= 0, as a function of the plane: d is the distance from a convex set.
struct RadialBounds {
    CurveBounds curve;
    double slope_by_distance = kInfinity;  ///< |f'(d)| / d; infinite for a crest at d = 0
};

/// (value, derivative) of the weight at a distance, and its bounds.
std::pair<double, double> falloff_at(const Falloff& falloff, double distance);
RadialBounds falloff_over(const Falloff& falloff, const Interval& distance);

/// A section made ready.
class SectionCurve
{
public:
    explicit SectionCurve(const Section& section);
    std::pair<double, double> at(double distance) const;
    RadialBounds over(const Interval& distance) const;

private:
    struct Piece {
        double from, to;        ///< distances
        double a0, a1, a2, a3;  ///< of (d - from)
    };
    std::vector<Piece> pieces_;
    double first_ = 0.0, last_ = 0.0;
};

/// What is known of the distance from a skeleton over an area. `convex`: there is only one nearest piece, a convex one.
struct DistanceOver {
    AreaJet jet;
    bool convex = true;
};

/// f(distance), f given by its value and derivative at the distance of the area's point and by its bounds.
AreaJet radial(const std::pair<double, double>& at, const RadialBounds& bounds, const DistanceOver& distance);

}  // namespace hoodoo
