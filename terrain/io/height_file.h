// Large height images as they are stored: read piece by piece into a grid of their own type, with what the file says of its place on the earth.
#pragma once

#include "terrain/fields/heightgrid.h"
#include "terrain/io/georeference.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hoodoo
{

/// What a file says of itself. Row 0 of the file is the north, row 0 of a grid the south.
struct HeightFileInfo {
    int columns = 0, rows = 0;
    SampleType type = SampleType::f32;
    bool is_unsigned = false;       ///< integers from 0: whose step means nothing by itself
    double largest = 1.0;           ///< number of an unsigned image's white
    Vec2d cell{0.0};                ///< metres between samples; 0 where the file does not say
    double height_scale = 0.0;      ///< metres for a stored 1; 0 where the file does not say
    std::optional<double> no_data;  ///< the stored number that stands for "not measured"
    GeoReference place;
    int tile_width = 0, tile_height = 0;  ///< 0: rows
};

/// A file that is open. Its first channel counts. Integers of 8 and 16 bits and floats (16 or 32 bits) are kept as they are; doubles and integers of
/// 32 bits become floats.
class HeightFile
{
public:
    /// Throws Error (file) if it cannot be read, has no 2 x 2 samples, more than 2^31, or promises over 2000 bytes for each of the file's.
    explicit HeightFile(const std::string& path);
    ~HeightFile();
    HeightFile(const HeightFile&) = delete;
    HeightFile& operator=(const HeightFile&) = delete;

    const HeightFileInfo& info() const;

    /// Fills a grid of the file's size and type: a row of tiles (or 64 rows of pixels) in memory at a time. `progress` may be empty. Throws Error
    /// (file).
    void read(HeightGrid& grid, const std::function<void(double)>& progress) const;

private:
    struct Open;
    std::unique_ptr<Open> open_;
};

}  // namespace hoodoo
