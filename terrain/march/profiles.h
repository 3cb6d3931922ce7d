// From columns to the pieces of cells that the surface can cross: the first half of building exact cells.
#pragma once

#include "terrain/march/lattice.h"

#include <array>
#include <vector>

namespace hoodoo
{

/// Where the profile of a lattice vertex bends: F at `z`, and its slope from there to the next knot.
struct Knot {
    double z, value, slope;
};

/// F along the vertical line through a lattice vertex: piecewise linear, constant before the first knot and after the last.
/// Its sign changes only between the knots at `first` and `last` (heights; first > last if it never changes).
struct Profile {
    std::vector<Knot> knots;
    double first = kInfinity, last = -kInfinity;
};

/// F at the four corners (x fast) of a lattice cell at one height.
struct Level {
    double z;
    std::array<double, 4> value;
};

/// A piece of one lattice cell: consecutive levels between which F is trilinear and changes sign somewhere in every slab.
struct Chain {
    int a, b;                   ///< lattice cell
    std::vector<Level> levels;  ///< at least 2, heights strictly increasing
};

/// Limits of a chain, in levels and units of height.
struct ChainLimits {
    std::size_t levels = 16;
    double height = 255.0;
};

/// The profiles of lattice vertices (a0, b) to (a1, b), row after row of a tile: what rows share is kept between calls.
class ProfileRows
{
public:
    ProfileRows(const Ground& ground, const Lattice& lattice, int a0, int a1) : ground_(ground), lattice_(lattice), a0_(a0), a1_(a1) {}
    std::vector<Profile> row(int b);

private:
    struct Bend {
        double z, slope;
    };
    /// Bends of one column, or of several, by height; `overlap` is what bottomless runs cover far below.
    struct Bends {
        std::vector<Bend> list;
        double overlap = 0.0;
    };
    Bends column(int i, int j) const;
    static void merge(const Bends& more, Bends& into, std::vector<Bend>& scratch);
    Profile integrate(const Bends& bends) const;

    const Ground& ground_;
    const Lattice& lattice_;
    int a0_, a1_;
    std::vector<std::vector<Bends>> columns_;  ///< rows of columns, the oldest first
    int first_row_ = 0;
};

/// Appends the chains of cell (a, b), given the profiles of its corners (a,b), (a+1,b), (a,b+1), (a+1,b+1).
void cell_chains(const Lattice& lattice, int a, int b, const std::array<const Profile*, 4>& corners, const ChainLimits& limits,
                 std::vector<Chain>& out);

/// The part of a slab that the surface F = delta can touch, as [lo, hi] along each axis in 0..1 of the slab. Empty (lo > hi) if none.
/// Values: four corners below, then four above, x fast, delta already subtracted. Proved: on a plane across an axis F lies in the hull of
/// four numbers that change linearly along the axis, so while all four have one sign there is no root.
void tight_box(const std::array<double, 8>& value, Vec3d& lo, Vec3d& hi);

}  // namespace hoodoo
