// Landforms as a tree: each node is an elevation with a weight, mostly of small extent; operators run them together.
#pragma once

#include "terrain/fields/area_jet.h"
#include "terrain/fields/height.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hoodoo
{

/// An elevation and its weight; T is Jet2 or AreaJet. For a node that covers the plane `height` is h - datum; for one that does not it is
/// weight (h - datum), which stays smooth where the weight ends. Heights are counted from a datum near the answer, so that bounds of differences are
/// narrow.
template <class T>
struct Elevated {
    T height, weight;
    /// Over an area: encloses h - datum wherever the weight is not 0; lo above hi if it is 0 everywhere. Unused at a point.
    Interval heights{kInfinity, -kInfinity};
};

/// A node of the tree. Immutable, thread-safe. Metres; weights are pure numbers, 0 or more.
class Landform
{
public:
    virtual ~Landform() = default;

    virtual Elevated<Jet2> at(const Vec2d& p, double datum) const = 0;
    /// Proved over the area, but for rounding.
    virtual Elevated<AreaJet> over(const Area& area, double datum) const = 0;

    /// The weight is 0 outside; may be infinite.
    virtual Box2d support() const = 0;
    /// Above 0: the weight is nowhere below it, and the node covers the plane.
    virtual double least_weight() const { return 0.0; }
    virtual double most_weight() const { return 1.0; }
    virtual std::uint64_t memory_bytes() const { return 0; }
    bool covers() const { return least_weight() > 0.0; }
};

using LandformPtr = std::shared_ptr<const Landform>;

/// The whole tree as a height. The root covers the plane; throws Error (internal) otherwise.
class LandformHeight final : public Height
{
public:
    explicit LandformHeight(LandformPtr root);

    double height(const Vec2d& p) const override { return root_->at(p, 0.0).height.value; }
    Vec2d gradient(const Vec2d& p) const override { return root_->at(p, 0.0).height.gradient; }
    Interval range(const Box2d& area) const override { return bounds(area).value; }
    double slope_bound(const Box2d& area) const override { return bounds(area).slope; }
    Box2d domain() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    std::array<Interval, 2> gradient_range(const Box2d& area) const override { return bounds(area).gradient; }
    double curvature_bound(const Box2d& area) const override { return bounds(area).curvature; }

    HeightBounds bounds(const Box2d& area) const override;

private:
    LandformPtr root_;
};

// -- Primitives --------------------------------------------------------------------------------------------------------

/// How a landform's weight falls from 1 on its skeleton, and as far as `core` from it, to 0 at `radius`: (1 - t^2)^power, t = (d - core) / (radius -
/// core).
struct Falloff {
    double radius = 1.0;  ///< metres
    double core = 0.0;    ///< metres, below the radius
    int power = 3;        ///< 2 or 3
};

/// Heights above a skeleton by the distance from it: knots (distance, height), distances increasing from 0 or more; a monotone cubic between them,
/// level before the first and beyond the last. Empty: 0.
struct Section {
    std::vector<Vec2d> knots;
    bool sharp = false;  ///< a first knot at 0 is a crest or a notch; else level there
};

/// The plane at one height, everywhere.
LandformPtr landform_flat(double height);
/// Any height, everywhere; `height` is finite in the plane.
LandformPtr landform_of(std::shared_ptr<const Height> height, std::uint64_t bytes = 0);
/// The same within a circle.
LandformPtr landform_disc(std::shared_ptr<const Height> height, const Vec2d& centre, const Falloff& falloff, std::uint64_t bytes = 0);

/// A path of straight pieces; one point is a point. Heights: those of the path, which rise evenly along each piece and on beyond it, run together
/// within `joint` of corners; plus the section by the distance; plus `rough` if there is one. Neighbouring points lie apart in the plane.
struct PathForm {
    std::vector<Vec3d> points;
    Falloff falloff;
    Section section;
    double joint = 1.0;                   ///< metres, above 0
    std::shared_ptr<const Height> rough;  ///< about 0
};
LandformPtr landform_path(const PathForm& form);

// -- Operators (Genevaux2015, Guerin2016) ------------------------------------------------------------------------------

/// How weights of a blend add up: their sum, or 1 - prod (1 - w), which stays within 1 (all of them must).
enum class BlendWeight { sum, united };
/// h = sum w h / sum w.
LandformPtr landform_blend(std::vector<LandformPtr> nodes, BlendWeight weight);

/// What later nodes do to the first, one after another, each where its weight is (weights above 1 count as 1):
/// replace  h = (1 - w) h0 + w h1, weight (1 - w) w0 + w^2; the first must cover the plane
/// inset    h = h0 + q(w) (h1 - h0), q = 6 w^5 - 15 w^4 + 10 w^3, weight w0
/// add      h = h0 + w h1, weight w0
/// raise    h = h0 + max(0, w (h1 - h0)), weight w0: the maximum, where w = 1;   lower: the minimum
enum class LandformOperator { replace, inset, add, raise, lower };
LandformPtr landform_apply(LandformOperator what, std::vector<LandformPtr> nodes);

/// h(p + d(p)): `shift_x` and `shift_y` are the parts of d, finite in the plane.
LandformPtr landform_warp(LandformPtr node, std::shared_ptr<const Height> shift_x, std::shared_ptr<const Height> shift_y);

/// The node scaled about the origin (heights too), turned by `angle` (radians, counter-clockwise), moved by `shift`.
LandformPtr landform_move(LandformPtr node, double scale, double angle, const Vec3d& shift);

/// The operators on weighted elevations, as landform_apply and landform_blend use them. `covered`: the first covers the plane.
template <class T>
Elevated<T> applied(LandformOperator what, const Elevated<T>& a, const Elevated<T>& b, bool covered);

}  // namespace hoodoo
