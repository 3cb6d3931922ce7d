// The few tags of a GeoTIFF that a terrain needs, through libtiff; OpenImageIO passes over them.
// Ritter2000: ModelPixelScale (33550), ModelTiepoint (33922), GeoKeyDirectory (34735) with keys of four numbers, of which 1024 says projected or
// geographic, 1025 whether a pixel is an area or a point, 3072 and 2048 the EPSG codes, 3076 the unit of length (9001: metre). GDAL_NODATA (42113) is
// a text. Missing: rotated rasters (ModelTransformation), systems without a code; `import-dem` reads those through GDAL.
#include "terrain/io/georeference.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <sstream>

namespace hoodoo
{

namespace
{

constexpr ttag_t kPixelScale = 33550, kTiepoint = 33922, kGeoKeys = 34735, kNoData = 42113;
constexpr int kModelType = 1024, kRasterType = 1025, kGeographic = 2048, kProjected = 3072, kLinearUnits = 3076;

struct CloseTiff {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
struct FreeOptions {
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

int keep_quiet(TIFF*, void*, const char*, const char*, va_list)
{
    return 1;
}

/// The values of one tag of numbers or of text, and how many.
template <class T>
const T* tag(TIFF* tiff, ttag_t which, TIFFDataType type, std::size_t& count)
{
    count = 0;
    const TIFFField* field = TIFFFieldWithTag(tiff, which);
    if (!field || TIFFFieldDataType(field) != type || !TIFFFieldPassCount(field)) return nullptr;
    void* values = nullptr;
    if (TIFFFieldReadCount(field) == TIFF_VARIABLE2) {
        std::uint32_t n = 0;
        if (TIFFGetField(tiff, which, &n, &values) == 1) count = n;
    } else {
        std::uint16_t n = 0;
        if (TIFFGetField(tiff, which, &n, &values) == 1) count = n;
    }
    return static_cast<const T*>(values);
}

/// The value of a key in the directory, or 0.
int geo_key(const std::uint16_t* keys, std::size_t count, int which)
{
    for (std::size_t k = 4; k + 3 < count; k += 4)
        if (keys[k] == which && keys[k + 1] == 0) return keys[k + 3];
    return 0;
}

}  // namespace

std::string GeoReference::map_text() const
{
    return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}", map[0], map[1], map[2], map[3], map[4], map[5]);
}

GeoReference GeoReference::of_pixels(double column, double row, double step_x, double step_y) const
{
    // Plus 0, so that no zero is written with a minus sign.
    return {system,
            {map[0] + map[1] * column + map[2] * row, map[1] * step_x + 0.0, map[2] * step_y + 0.0, map[3] + map[4] * column + map[5] * row,
             map[4] * step_x + 0.0, map[5] * step_y + 0.0}};
}

std::optional<std::array<double, 6>> parse_map(const std::string& text)
{
    std::istringstream in(text);
    std::array<double, 6> map{};
    for (double& x : map)
        if (!(in >> x) || !std::isfinite(x)) return std::nullopt;
    return map;
}

GeoTiffTags read_geotiff_tags(const std::string& path)
{
    GeoTiffTags tags;
    const std::unique_ptr<TIFFOpenOptions, FreeOptions> options(TIFFOpenOptionsAlloc());
    if (!options) return tags;
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_quiet, nullptr);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), keep_quiet, nullptr);
    const std::unique_ptr<TIFF, CloseTiff> tiff(TIFFOpenExt(path.c_str(), "r", options.get()));
    if (!tiff) return tags;

    std::size_t n_scale = 0, n_tie = 0, n_keys = 0, n_text = 0;
    const double* scale = tag<double>(tiff.get(), kPixelScale, TIFF_DOUBLE, n_scale);
    const double* tie = tag<double>(tiff.get(), kTiepoint, TIFF_DOUBLE, n_tie);
    const auto* keys = tag<std::uint16_t>(tiff.get(), kGeoKeys, TIFF_SHORT, n_keys);
    if (const char* text = tag<char>(tiff.get(), kNoData, TIFF_ASCII, n_text)) {
        const std::string written(text, strnlen(text, n_text));
        char* end = nullptr;
        const double value = std::strtod(written.c_str(), &end);
        if (end != written.c_str()) tags.no_data = value;
    }
    if (n_scale < 2 || n_tie < 6 || n_keys < 4 || !(scale[0] > 0.0 && scale[1] > 0.0)) return tags;
    for (const double x : {scale[0], scale[1], tie[0], tie[1], tie[3], tie[4]})
        if (!std::isfinite(x)) return tags;

    const bool projected = geo_key(keys, n_keys, kModelType) == 1;
    const int code = geo_key(keys, n_keys, projected ? kProjected : kGeographic), unit = geo_key(keys, n_keys, kLinearUnits);
    // Codes above 32766 say that the user defined the system, which tags alone do not name.
    if (code <= 0 || code >= 32767) return tags;
    tags.place.system = fmt::format("EPSG:{}", code);
    tags.metres = projected && (unit == 0 || unit == 9001);
    const double half = geo_key(keys, n_keys, kRasterType) == 2 ? 0.5 : 0.0;
    tags.place.map = {tie[3] - (tie[0] + half) * scale[0], scale[0], 0.0, tie[4] + (tie[1] + half) * scale[1], 0.0, -scale[1]};
    return tags;
}

}  // namespace hoodoo
