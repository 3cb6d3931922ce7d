// Digital elevation models as they come (NumPy archives, images; often in degrees) -> height images in metres with square pixels.
#pragma once

#include "terrain/io/height_image.h"

#include <array>
#include <optional>
#include <string>

namespace hoodoo
{

struct DemOptions {
    std::string array;                        ///< of an archive; empty: the only array with two dimensions
    bool flip = false;                        ///< row 0 of the source is the south
    std::array<int, 4> subset{0, 0, 0, 0};    ///< x0, x1, y0, y1 in source pixels, half-open, row 0 = north; all zero: everything
    double scale = 1.0;                       ///< metres for the value 1 (an integer image's white)
    double cell_x = 0.0, cell_y = 0.0;        ///< metres between source pixels; 0: from degrees, or from the file
    double degrees_x = 0.0, degrees_y = 0.0;  ///< degrees between source pixels; 0: an archive's scalars dx and dy
    double latitude = 91.0;                   ///< degrees, of the middle; above 90: from an archive's scalars ymin and ymax
    double resample_to = 0.0;                 ///< metres; 0: the smaller of the two cell sizes if they differ, else none
    std::optional<double> fill;               ///< height for samples that were not measured; without: an error
};

/// Throws Error (file) with what is missing. The result's cell is set, and its place where the file says it.
HeightImage import_dem(const std::string& path, const DemOptions& options);

/// Metres in one degree along the parallel (x) and the meridian (y) at a latitude in degrees, on the WGS 84 ellipsoid.
std::array<double, 2> metres_in_a_degree(double latitude);

}  // namespace hoodoo
