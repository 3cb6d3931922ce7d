// The canyon of Gamito2001, section 4.1: a saturated noise whose walls are moved along its gradient, by an amount that changes with height.
#pragma once

#include "terrain/field.h"
#include "terrain/fields/canyon_kernel.h"
#include "terrain/fields/detail.h"
#include "terrain/fields/warped_field.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace hoodoo
{

struct CanyonShape {
    Vec3d origin{0.0};        ///< metres: of the noise's lattice, and height 0
    double cell = 50.0;       ///< metres: side of the noise's cells
    double height = 50.0;     ///< metres: from height 0 to the plateau
    std::uint32_t seed = 0;   ///< of the noise of the plan
    double amplitude = 0.35;  ///< of T, in squared cells: how far walls move
    double frequency = 3.0;   ///< of T: cells of its first octave from floor to plateau
    int octaves = 4;
    std::uint32_t profile_seed = 0;
    double sediment = 0.35;          ///< k: slope of the deposit
    double sediment_height = 0.3;    ///< zs, a share of the height
    double floor_amplitude = 0.04;   ///< metres by the height: the floor lies in [0, 2 x this] x height, about
    double floor_wavelength = 0.7;   ///< cells
    double lift = 0.0;               ///< share of the height: layers and plateau are lifted by up to about +- half this
    double lift_wavelength = 2.0;    ///< cells
    std::optional<DetailView> view;  ///< octaves of the profile that a pixel does not resolve are faded out (without slack)
};

/// Of the noise that lifts.
inline std::uint32_t lift_seed(const CanyonShape& shape)
{
    return shape.seed + 211u;
}

/// How far the layers are lifted at a place of the plan, metres.
struct CanyonLift {
    double value = 0.0;
    Vec2d gradient{0.0};
    /// Suprema everywhere of |value|, |gradient| and the second derivative.
    struct Bound {
        double value, slope, curve;
    };
    static CanyonLift at(const CanyonShape& shape, const Vec3d& p);
    static Bound bound(const CanyonShape& shape);
    /// Proved over a box.
    struct Range {
        Interval value;
        std::array<Interval, 2> gradient;
        double slope = 0.0;
    };
    static Range over(const CanyonShape& shape, const Box3d& box);
};

/// T(z) = amplitude sum 0.5^k n1(2^k frequency z + 17.3 k, seed + k), z a share of the height; each octave weighted by distance where there is a
/// view.
class CanyonProfile
{
public:
    explicit CanyonProfile(const CanyonShape& shape) : shape_(shape) {}

    /// T at a point in metres, its derivative by height (per metre), and by the distance from the eye (per metre). Sideways it changes by -by_height
    /// times the lift's gradient.
    struct Value {
        double t = 0.0, by_height = 0.0, by_distance = 0.0;
        Vec2d lift_gradient{0.0};
    };
    Value at(const Vec3d& p) const;

    /// Proved over a box, per metre: T, its derivative by height, what the distance adds to that along any direction, and T's second derivative
    /// along a unit direction with a horizontal part c and a vertical part s: at most across c^2 + mixed 2 c |s| + upright s^2.
    struct Range {
        Interval t, by_height;
        double by_distance = 0.0;
        double across = 0.0, mixed = 0.0, upright = 0.0;
        CanyonLift::Range lift;
    };
    Range over(const Box3d& box) const;

    double most() const;   ///< |T| everywhere
    double usual() const;  ///< |T| between floor and plateau, from proved bounds over slices
    double weight(int octave, double distance, double* slope) const;

private:
    const CanyonShape shape_;
};

/// One of the canyon's three surfaces: negative on its own side; all in metres.
class CanyonWall final
{
public:
    explicit CanyonWall(const CanyonShape& shape);
    /// -cell (n(Psi_T(x, y)) + k ramp(zs - z)): negative in rock.
    double value(const Vec3d& p) const;
    Vec3d gradient(const Vec3d& p) const;
    LocalField local(const Box3d& box) const;
    /// Makes values() of points in the box fast.
    void prepare(const Box3d& domain);
    /// The sign of value() where that is certain without following the flow: +1 above `margin`, -1 below -margin, else 0.
    int certain_sign(const Vec3d& p, double margin) const;
    /// value() of eight points, within 1e-12 cells.
    void values(const Vec3d (&p)[CanyonLanes::count], double* out) const;
    /// For the paper's mode: the point in the undeformed plan (its height kept), and the wall there.
    Vec3d inverse(const Vec3d& p) const;
    double base_value(const Vec3d& q) const;
    const CanyonProfile& profile() const { return profile_; }

private:
    double ramp(double z, double* slope, double* curve) const;
    double noise(const Vec2d& q, Vec2d* gradient) const;
    Vec2d carried(const Vec2d& q, double t) const;

    CanyonShape shape_;
    CanyonProfile profile_;
    Warp warp_;
    CanyonLanes lanes_;
};

/// Matter is below the floor, or inside the walls and below the plateau: min(floor, max(wall, plateau)), in metres.
class CanyonField final : public Field
{
public:
    explicit CanyonField(const CanyonShape& shape);
    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override;
    std::array<Interval, 3> gradient_range(const Box3d& box) const override;

    const CanyonWall& wall() const { return wall_; }
    void prepare(const Box3d& domain) { wall_.prepare(domain); }
    double plateau(const Vec3d& p) const { return p.z - (shape_.origin.z + shape_.height) - CanyonLift::at(shape_, p).value; }
    Vec3d plateau_gradient(const Vec3d& p) const;
    double floor(const Vec3d& p) const;
    Vec3d floor_gradient(const Vec3d& p) const;
    LocalField floor_local(const Box3d& box) const;
    LocalField plateau_local(const Box3d& box) const;
    const CanyonShape& shape() const { return shape_; }

private:
    CanyonShape shape_;
    CanyonWall wall_;
};

}  // namespace hoodoo
