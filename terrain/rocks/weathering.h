// A Voronoi cell worn into a rock: an implicit function that is zero at the contacts, and never reaches beyond the cell.
#pragma once

#include "terrain/field.h"
#include "terrain/rocks/contacts.h"

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// Lengths as multiples of the radius r of the Poisson spheres.
struct Weathering {
    double depth = 0.25;      ///< e0 / r: how deep a face is worn away from contacts
    double exposure = 1.0;    ///< kappa in [0, 1]: how much deeper at edges and corners, as a multiple of what rounding needs
    double sharpness = 12.0;  ///< beta r: small is round
    double width = 0.6;       ///< of the resistance around a contact, / r
    double roughness = 0.0;   ///< amplitude of the detail, / r
    std::uint32_t seed = 0;   ///< of the detail
};

/// Phi of maths A9, metres, in the rock's own space (the cell's point is the origin): the rock is where it is below 0.
///   Phi = M + (e0 + kappa (S - M) + a N) (1 - rho),  rho = exp(-min |p - c|^2 / w^2)
/// with M the greatest signed distance to the cell's planes, S its smooth maximum, N detail in [0, 1]. Phi >= M: nothing leaves the cell.
class RockField final : public Field
{
public:
    /// `radius` is r, metres. The cell needs four faces or more.
    RockField(const VoronoiCell& cell, std::vector<Vec3d> contacts, double radius, const Weathering& weathering);

    double value(const Vec3d& p) const override;
    Vec3d gradient(const Vec3d& p) const override;
    double slope_bound(const Segment& segment) const override;
    Interval range(const Box3d& box) const override;
    Box3d bounds() const override { return box_; }

    struct Sample {
        double value;
        Vec3d gradient;
    };
    Sample sample(const Vec3d& p) const;  ///< both for the price of one

    double slope() const { return slope_; }        ///< bound of |gradient| everywhere
    double plane_distance(const Vec3d& p) const;   ///< M
    double smooth_distance(const Vec3d& p) const;  ///< S
    double resistance(const Vec3d& p) const;       ///< rho
    /// Where a ray from inside the cell leaves it, in units of the direction's length.
    double exit(const Vec3d& origin, const Vec3d& direction) const;
    const std::vector<Vec3d>& contacts() const { return contacts_; }
    double radius() const { return radius_; }

private:
    struct Plane {
        Vec3d normal;
        double offset;
    };
    struct Parts {
        double m, rise, rho;  ///< M; S - M >= 0; rho
        std::size_t top;      ///< the plane of M
        Vec3d smooth;         ///< gradient of S
        Vec3d rho_gradient;
    };
    Parts parts(const Vec3d& p) const;

    std::vector<Plane> planes_;
    std::vector<Vec3d> contacts_;
    Box3d box_;
    double radius_, depth_, kappa_, beta_, width_, amplitude_, wavelength_;
    std::uint32_t seed_;
    double slope_;
};

}  // namespace hoodoo
