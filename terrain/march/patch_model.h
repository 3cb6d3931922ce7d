// A quadratic that stands for a field in a box, with a proved distance from it; what rays learn from it before they ask the field.
#pragma once

#include "terrain/march/marched_field.h"

#include <array>
#include <vector>

namespace hoodoo
{

/// Values of a field at (parts + 1)^3 points of a box, evenly from corner to corner, x running fastest.
struct NodeGrid {
    Box3d box;
    int parts = 0;
    std::vector<double> values;

    NodeGrid(const MarchedField& field, const Box3d& box, int parts);
    double at(int x, int y, int z) const { return values[static_cast<std::size_t>((z * (parts + 1) + y) * (parts + 1) + x)]; }
    /// The field differs from what the corners of a part interpolate by less than this, `second` bounding its second derivatives along the axes.
    double interpolation_error(const Vec3d& second) const;
};

/// Shrinks the grid's box to the hull of those of its parts that may hold a zero, `flat` either way. Empty if none may.
Box3d parts_with_zero(const NodeGrid& grid, const LocalField& known, double flat);

/// Along a ray the quadratic is a + b s + c s^2, s metres from where it began.
struct ModelAlong {
    double a, b, c;
    double at(double s) const { return a + s * (b + s * c); }
};

/// value + gradient . u + u^T second u, u metres from the box's middle; the field lies within `error` of it all over the box.
struct PatchModel {
    float value = 0.0f;
    std::array<float, 3> gradient{};
    std::array<float, 6> second{};  ///< xx, yy, zz, xy, xz, yz
    float error = std::numeric_limits<float>::infinity();

    double at(const Vec3d& u) const;
    ModelAlong along(const Vec3d& u, const Vec3d& direction) const;
};

/// The closest quadratic (least squares over the grid) with the error that `known`, of the grid's box, proves, and `rounding` more: what values may
/// be off by where the field is asked.
PatchModel fit_model(const NodeGrid& grid, const LocalField& known, double rounding);

/// A piece of a stretch of ray: the field's sign all through it, or 0 where the model cannot tell.
struct SignedPiece {
    double from, to;
    int sign;
};

/// Cuts (0, length) where the model comes within `error` of zero or leaves that. Returns how many pieces there are; no two neighbours have one sign.
int signed_pieces(const ModelAlong& model, double error, double length, SignedPiece (&pieces)[5]);

}  // namespace hoodoo
