// Carrying points along a flow for a given time, and back; with bounds of the way back over a box.
#pragma once

#include "terrain/fields/flow.h"
#include "terrain/fields/norm_jet.h"

#include <string>

namespace hoodoo
{

/// What is known of the inverse warp over a box of points and a span of durations.
struct InverseBound {
    Vec3d image{0.0};       ///< of the centre, at the middle of the span
    Matrix3d jacobian;      ///< there
    NormJet all;            ///< over the whole box and span; h is the duration
    Vec3d half_image{0.0};  ///< the image of the whole lies within image +- half_image
};

/// A flow followed for durations up to `longest`. Closed forms are used as they are; other flows go by `steps()` equal steps of RK4, however long
/// the duration, so that the discrete map is as smooth as the flow in the point and in the duration. Immutable, thread-safe.
class Warp
{
public:
    /// Beyond this growth (Lipschitz constant times duration) neighbouring points may part by e^8 = 3000: no march ends in time.
    static constexpr double kMostGrowth = 8.0;

    /// Precondition: why_not(flow, longest) is empty. `longest` >= 0; the number of steps goes by `usual`, where that is less.
    Warp(FlowPtr flow, double longest, double usual = kInfinity);
    /// Empty, or why no warp can be made of these, in words with the numbers.
    static std::string why_not(const Flow& flow, double longest);

    /// Where the point of the warped world came from: along p' = v(p, t) from t = duration down to 0 (Gamito2001, eq. 3, corrected for flows that
    /// depend on time). A steady flow may be followed the other way, by a negative duration of at most longest().
    Vec3d inverse(const Vec3d& p, double duration) const;
    Carried inverse_with_jacobian(const Vec3d& p, double duration) const;

    /// Where a point is carried: the exact inverse of inverse(), up to rounding.
    Vec3d forward(const Vec3d& p, double duration) const;

    InverseBound inverse_bound(const Box3d& box, const Interval& durations) const;

    /// No point is moved farther than this, starting anywhere in the box.
    double reach(const Box3d& box) const;

    int steps() const { return steps_; }
    double longest() const { return longest_; }
    const Flow& flow() const { return *flow_; }

private:
    struct Stage {
        Vec3d point;
        double speed;
        Matrix3d gradient;
    };
    struct StepBound {
        Carried centre;
        NormJet jet;
    };
    Carried step(const Carried& at, double t, double h, Stage (&stages)[4]) const;
    StepBound bound_step(const Vec3d& at, double spread, const Interval& lengths, double t, const Interval& times) const;
    FlowPtr flow_;
    double longest_ = 0.0;
    double lipschitz_ = 0.0;
    int steps_ = 1;
};

/// An upper bound of the matrix's Euclidean norm, close: (max row sum of (m^T m)^2)^(1/4).
double norm_bound(const Matrix3d& m);

}  // namespace hoodoo
