// Heights as an image: one number a pixel, metres, row 0 in the north.
#pragma once

#include "terrain/io/georeference.h"

#include <string>
#include <vector>

namespace hoodoo
{

struct HeightImage {
    int width = 0, height = 0;
    double cell = 0.0;          ///< metres between neighbouring pixels; 0 where the file does not say
    std::vector<float> values;  ///< metres, row by row, row 0 = north (largest y)
    GeoReference place;         ///< of its pixels; unknown where the file does not say

    float& at(int column, int row)
    {
        return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
    }
    float at(int column, int row) const { return const_cast<HeightImage*>(this)->at(column, row); }
};

/// The first channel of any image OpenImageIO reads; integers count as 0 to 1. Throws Error (file) if it cannot be read, is larger than 2^27 samples,
/// promises over 2000 bytes for each of the file's, or holds a sample that is no finite number.
HeightImage read_height_image(const std::string& path);

/// A float EXR with the attribute `hoodoo:cell` (metres), and where the place is known hoodoo:crs and hoodoo:geoTransform. Throws Error (file).
void write_height_image(const std::string& path, const HeightImage& image);

/// Bicubic (Keys1981, a = -1/2) at the new pixels' centres, edges repeated. Steps are in old pixels. Enlarging interpolates the old values.
HeightImage resample(const HeightImage& image, double step_x, double step_y);

}  // namespace hoodoo
