// The canyon's walls at eight points at once: the profile, the way back along the flow and the noise there, in SIMD lanes.
#pragma once

#include <cstdint>
#include <vector>

namespace hoodoo
{

/// What the lanes need, in cells of the plan and shares of the height.
struct CanyonLanes {
    static constexpr int count = 8;

    /// Gradients of a noise at lattice points x0 <= x < x0 + nx, row by row.
    struct Lattice {
        std::vector<double> gradient_x, gradient_y;
        double x0 = 0.0, y0 = 0.0;
        std::int64_t nx = 0, ny = 0;
    };
    Lattice plan;
    Lattice lift;                                       ///< of the noise that lifts the layers, empty if none does
    double lift_amplitude = 0.0, lift_frequency = 1.0;  ///< shares of the height; by the plan's cells
    double speed = 0.0;                                 ///< the noise's steepest slope
    double reach = 0.0;                                 ///< cells: how far a point may be carried
    int steps = 1;                                      ///< of RK4

    // Octave k of T: slopes of the 1-D noise at the lattice points from `first` on.
    struct Octave {
        std::vector<double> slopes;
        double first = 0.0, frequency = 0.0, shift = 0.0, amplitude = 0.0;
        double fade = 0.0;  ///< share of the octave's fade a cell of distance from the eye
    };
    std::vector<Octave> octaves;
    double z_lo = 0.0, z_hi = 0.0;  ///< the octaves know T in between
};

/// Of eight points: place in the plan (cells), height (a share, before the lift is taken off) and distance from the eye (cells).
struct CanyonPoints {
    alignas(64) double x[CanyonLanes::count], y[CanyonLanes::count], z[CanyonLanes::count], distance[CanyonLanes::count];
};

/// n(Psi_T(x, y)) of each point, the same bits on every instruction set. Precondition: z within [z_lo, z_hi], which leave room for the lift; (x, y),
/// widened by reach and one cell, within the lattice points known.
void canyon_noise(const CanyonLanes& lanes, const CanyonPoints& points, double* values);

}  // namespace hoodoo
