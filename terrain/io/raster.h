// Several numbers a pixel with a place on the ground: what analyses write and masks read.
#pragma once

#include "terrain/io/georeference.h"

#include <string>
#include <vector>

namespace hoodoo
{

struct Raster {
    int columns = 0, rows = 0;
    double cell = 0.0;  ///< metres between pixels; 0 where a file does not say
    std::vector<std::string> names;
    std::vector<std::vector<float>> channels;  ///< one a name, row by row, row 0 = north
    GeoReference place = {};                   ///< of its pixels; not read back
};

/// A float EXR with the attribute `hoodoo:cell`, and hoodoo:crs and hoodoo:geoTransform where the place is known, replaced in one step. Throws Error
/// (file).
void write_raster(const std::string& path, const Raster& raster);

/// One channel of any image OpenImageIO reads; the name matches as written, or with any layer's name before it. Throws Error (file): cannot be read,
/// has no such channel (names those it has), is larger than 2^27 pixels or promises over 2000 bytes for each of the file's.
Raster read_raster(const std::string& path, const std::string& channel);

}  // namespace hoodoo
