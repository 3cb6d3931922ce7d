// A node of a blob tree: a field that knows all about a box at once, how far it is at least, and whose material a point has.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/warped_field.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace hoodoo
{

/// What a point is made of: materials and terrains by number, with weights that need not sum to 1.
struct BlobShares {
    struct Share {
        std::int32_t source;  ///< kNoSource, a material's number, or kTerrain + a terrain's
        double weight;
    };
    static constexpr std::int32_t kNoSource = -1, kTerrain = 1 << 16;
    std::vector<Share> list;

    void add(std::int32_t source, double weight);
};

/// Negative inside matter. Values are metres from the surface, or less (in magnitude) than that, wherever no terrain's own measure comes in.
/// Immutable, thread-safe.
class BlobNode : public Field
{
public:
    /// Proved, over a box: values, gradients (one-sided ones included), curvature; `centre` is the value at the box's centre.
    virtual LocalField local(const Box3d& box) const = 0;
    /// Proved: value(p) is not below this; cheap, and 1-Lipschitz where it is not minus infinity: nothing is known there.
    virtual double lower_bound(const Vec3d&) const { return -kInfinity; }
    /// Adds what the surface is made of at a point of it; kNoSource for what no scene gave a material: what it was carved out of shows there.
    virtual void shares(const Vec3d& p, double weight, BlobShares& out) const = 0;

    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override { return local(box).value; }
    std::array<Interval, 3> gradient_range(const Box3d& box) const override { return local(box).gradient; }
    double curvature_bound(const Box3d& box) const override { return local(box).curvature; }
};

using BlobPtr = std::shared_ptr<const BlobNode>;

/// What follows over a box from the value and the gradient at its centre, a bound of the slope everywhere in it, and one of the curvature (may be
/// infinite).
LocalField local_from_centre(const Box3d& box, double value, const Vec3d& gradient, double slope, double curvature);

/// Narrows `known` by what its own gradients and curvature say about values, around known.centre. `gradient` is that at the centre, exact.
void narrow_by_gradient(const Box3d& box, const Vec3d& gradient, LocalField& known);

/// Distance of a point from a box; 0 inside.
double distance_to_box(const Vec3d& p, const Box3d& box);

}  // namespace hoodoo
