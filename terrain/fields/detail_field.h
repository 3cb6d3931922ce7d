// A field that grows coarser with the distance from the eye, through coarser forms of itself.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/detail.h"

#include <memory>
#include <vector>

namespace hoodoo
{

/// Level 0 near the eye; from level k - 1 to level k as the footprint grows from widths[k - 1] to twice that. A weighted mean of two levels, once
/// continuously differentiable in the weight: where both say matter (air), so does the mean.
class DetailField final : public Field
{
public:
    /// `levels` is one longer than `widths` (metres), which at least double from one to the next.
    DetailField(std::vector<std::shared_ptr<const Field>> levels, std::vector<double> widths, const DetailView& view);

    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;
    std::array<Interval, 3> gradient_range(const Box3d& box) const override;
    double curvature_bound(const Box3d& box) const override;

    /// The share of level 0: 1 where all detail is there.
    double fineness(const Vec3d& p) const { return fades_.front().at(p).value; }

private:
    /// Levels that count in a box, and how fast the mean changes by the weights alone.
    struct Mixed {
        std::size_t first = 0, last = 0;
        double slope = 0.0, curve = 0.0;  ///< of the weights
        double apart = 0.0;               ///< most that two neighbours among them differ by
    };
    Mixed mixed(const Box3d& box) const;

    std::vector<std::shared_ptr<const Field>> levels_;
    std::vector<DetailFade> fades_;  ///< of each level to the next
};

}  // namespace hoodoo
