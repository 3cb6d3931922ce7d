// How a grid of heights rises, faces and bends: first and second derivatives by the quadric of Zevenbergen and Thorne.
#pragma once

#include "terrain/analysis/elevation.h"

#include <vector>

namespace hoodoo
{

/// The quadric through a cell and its eight neighbours at the cell itself: h = .. + g x + h y + d x^2 + e y^2 + f x y (letters of Zevenbergen1987).
/// x to the east, y to the north; d and e are half the second derivatives. At the rim heights go on as a straight line.
struct Quadric {
    double d = 0.0, e = 0.0, f = 0.0, g = 0.0, h = 0.0;
};
Quadric quadric(const Elevation& elevation, int column, int row);

/// Second derivatives, 1/m; all 0 where the ground is flat (g = h = 0).
struct Curvature {
    double plan = 0.0;        ///< of Zevenbergen and Thorne: + the second derivative along the contour: below 0 on ridges, above 0 in valleys
    double profile = 0.0;     ///< of Zevenbergen and Thorne: - the second derivative along the slope: above 0 where it is convex
    double contour = 0.0;     ///< the curvature of the contour line itself: -plan / |grad h|; above 0 on ridges
    double normal = 0.0;      ///< the curvature of the vertical section along the slope: profile / (1 + |grad h|^2)^(3/2); above 0 where it is convex
    double tangential = 0.0;  ///< of the normal section across the slope: -plan / sqrt(1 + |grad h|^2); above 0 on ridges
};
Curvature curvature(const Quadric& quadric);

/// One value a cell. They throw what check_elevation throws.
std::vector<double> slope(const Elevation& elevation);   ///< atan |grad h|, radians
std::vector<double> aspect(const Elevation& elevation);  ///< where it faces (downhill): radians from north to east, [0, 2 pi); -1 where it is flat
std::vector<Curvature> curvatures(const Elevation& elevation);

/// Brightness under a light from `azimuth` (radians from north to east) at `altitude` (radians above the horizon): the cosine to the normal, 0 in its
/// own shade. Heights are taken `exaggeration` times.
std::vector<double> hillshade(const Elevation& elevation, double azimuth, double altitude, double exaggeration = 1.0);

}  // namespace hoodoo
