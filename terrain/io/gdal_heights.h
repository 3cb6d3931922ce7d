// Elevation models through GDAL: GeoTIFFs of every kind and what else it reads, with their places on the earth.
#pragma once

#include "terrain/io/height_image.h"

#include <optional>
#include <string>

namespace hoodoo
{

struct GdalHeights {
    HeightImage image;                                         ///< metres, place set where the file has one
    double cell_x = 0.0, cell_y = 0.0;                         ///< metres between pixels; 0 where the system is no projection
    double degrees_x = 0.0, degrees_y = 0.0, latitude = 91.0;  ///< between pixels, and of the middle, where it is geographic
};

/// Band 1 of a file with a geotransform, times its scale, plus its offset, its unit turned into metres; row 0 is the north. Samples without data
/// become `fill`. Nothing if the file has no geotransform, GDAL does not know it, or this build is without GDAL. Throws Error (file): samples without
/// data and no fill (how many, the first), a raster that is turned, more than 2^27 samples, more than 2000 bytes for each of the file's, damage.
std::optional<GdalHeights> read_gdal_heights(const std::string& path, std::optional<double> fill);

}  // namespace hoodoo
