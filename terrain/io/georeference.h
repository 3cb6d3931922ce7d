// Where on the earth a height image lies.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace hoodoo
{

/// A coordinate system and the affine map into it. Empty `system`: unknown.
struct GeoReference {
    std::string system;  ///< "EPSG:32613", or a definition in WKT
    /// x = map[0] + map[1] column + map[2] row, y = map[3] + map[4] column + map[5] row; column and row from the outer corner of the first pixel.
    std::array<double, 6> map{0, 1, 0, 0, 0, 1};

    bool known() const { return !system.empty(); }
    std::string map_text() const;  ///< six numbers, all digits
    /// The same system for other pixels, whose column c and row r are column + c step_x and row + r step_y of these.
    GeoReference of_pixels(double column, double row, double step_x, double step_y) const;
};

/// The reverse of map_text(); nothing if the text is not six finite numbers.
std::optional<std::array<double, 6>> parse_map(const std::string& text);

/// A surface that knows where on the earth it lies, beside what it can do as a surface.
class Georeferenced
{
public:
    virtual ~Georeferenced() = default;
    /// From the world's x and y (metres) to the system's coordinates: map[0] + map[1] x + map[2] y, and likewise from map[3]. Unknown: an empty
    /// system.
    virtual GeoReference world_to_earth() const = 0;
};

/// What the tags of a GeoTIFF say beside its pixels. Everything is absent in an ordinary TIFF.
struct GeoTiffTags {
    GeoReference place;
    bool metres = false;            ///< the system is projected: map[1] and map[5] are lengths in metres
    std::optional<double> no_data;  ///< GDAL's tag
};

/// Reads the tags of a TIFF; nothing at all from other files. Throws nothing.
GeoTiffTags read_geotiff_tags(const std::string& path);

}  // namespace hoodoo
