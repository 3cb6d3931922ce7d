// GDAL knows what tags alone do not say: definitions of systems without a code, units of length, scaled bands, masks of missing data.
// Opened without side files and without the network, by drivers that read local rasters only. A system is named by its EPSG code where it has one,
// else defined in WKT 2. Coordinates keep the order x (east), y (north). Missing: rotated rasters, reprojection, several bands.
#include "terrain/io/gdal_heights.h"

#ifdef HOODOO_GDAL

#include "terrain/error.h"

#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <cmath>
#include <cpl_conv.h>
#include <cpl_error.h>
#include <filesystem>
#include <memory>

namespace hoodoo
{

namespace
{

constexpr double kMaxSamples = 134217728.0;  // 2^27, as for any height image
constexpr double kMaxExpansion = 2000.0;

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

struct CloseDataset {
    void operator()(void* dataset) const { GDALClose(dataset); }
};

/// GDAL prints its errors otherwise.
struct Quiet {
    Quiet() { CPLPushErrorHandler(CPLQuietErrorHandler); }
    ~Quiet() { CPLPopErrorHandler(); }
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
};

std::string system_of(OGRSpatialReferenceH system)
{
    const char *authority = OSRGetAuthorityName(system, nullptr), *code = OSRGetAuthorityCode(system, nullptr);
    if (authority && code) return fmt::format("{}:{}", authority, code);
    const char* options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
    char* text = nullptr;
    if (OSRExportToWktEx(system, &text, options) != OGRERR_NONE || !text) return {};
    std::string wkt(text);
    CPLFree(text);
    return wkt;
}

/// Metres for 1 of the band's unit.
double unit_of(const std::string& path, GDALRasterBandH band)
{
    const std::string unit = GDALGetRasterUnitType(band);
    if (unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" || unit == "meters") return 1.0;
    if (unit == "ft" || unit == "foot" || unit == "feet") return 0.3048;
    if (unit == "US survey foot" || unit == "sfoot" || unit == "ftUS") return 1200.0 / 3937.0;
    refuse(path, "the unit of its heights", "metres or feet", '"' + unit + '"');
}

void read_heights(const std::string& path, GDALRasterBandH band, std::optional<double> fill, HeightImage& image)
{
    const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    std::vector<double> numbers(count);
    std::vector<unsigned char> valid(count);
    const int w = image.width, h = image.height;
    if (GDALRasterIO(band, GF_Read, 0, 0, w, h, numbers.data(), w, h, GDT_Float64, 0, 0) != CE_None ||
        GDALRasterIO(GDALGetMaskBand(band), GF_Read, 0, 0, w, h, valid.data(), w, h, GDT_Byte, 0, 0) != CE_None)
        refuse(path, "cannot read the heights: " + std::string(CPLGetLastErrorMsg()));
    const double unit = unit_of(path, band), scale = GDALGetRasterScale(band, nullptr) * unit, offset = GDALGetRasterOffset(band, nullptr) * unit;
    std::size_t missing = 0, first = 0;
    image.values.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double z = offset + scale * numbers[k];
        const bool measured = valid[k] != 0 && std::isfinite(static_cast<float>(z));
        if (!measured && missing++ == 0) first = k;
        image.values[k] = static_cast<float>(measured ? z : fill.value_or(0.0));
    }
    if (missing > 0 && !fill)
        refuse(path, "heights are missing in the file", "a height everywhere, or --fill METRES",
               fmt::format("{} of {} samples without one, the first at column {}, row {}", missing, count, first % static_cast<std::size_t>(w),
                           first / static_cast<std::size_t>(w)));
}

}  // namespace

std::optional<GdalHeights> read_gdal_heights(const std::string& path, std::optional<double> fill)
{
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return std::nullopt;
    const auto bytes = static_cast<double>(std::filesystem::file_size(path, failed));
    const Quiet quiet;
    GDALAllRegister();
    const char* drivers[] = {"GTiff", "AAIGrid", "SRTMHGT", "EHdr", "USGSDEM", "HFA", "DTED", nullptr};
    const char* no_siblings[] = {nullptr};
    const std::unique_ptr<void, CloseDataset> dataset(GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, no_siblings));
    std::array<double, 6> map{};
    if (!dataset || GDALGetRasterCount(dataset.get()) < 1 || GDALGetGeoTransform(dataset.get(), map.data()) != CE_None) return std::nullopt;

    GdalHeights heights;
    heights.image.width = GDALGetRasterXSize(dataset.get());
    heights.image.height = GDALGetRasterYSize(dataset.get());
    const double samples = static_cast<double>(heights.image.width) * heights.image.height;
    const auto size = [&] { return fmt::format("{} x {}", heights.image.width, heights.image.height); };
    if (samples > kMaxSamples) refuse(path, "the elevation model is too large", "at most 134217728 samples", size());
    GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
    const int width = GDALGetDataTypeSizeBytes(GDALGetRasterDataType(band));
    if (samples * width > kMaxExpansion * bytes + 65536.0)
        refuse(path, "the elevation model promises more than its file can hold", fmt::format("at most 2000 bytes for each of its {}", bytes), size());
    if (map[2] != 0.0 || map[4] != 0.0) refuse(path, "an elevation model that is turned against its map", "rows from west to east");
    if (!(map[1] > 0.0 && map[5] < 0.0)) refuse(path, "the order of its rows", "columns to the east, rows to the south");

    if (OGRSpatialReferenceH system = GDALGetSpatialRef(dataset.get())) {
        heights.image.place = {system_of(system), map};
        if (OSRIsProjected(system)) {
            const double metres = OSRGetLinearUnits(system, nullptr);
            heights.cell_x = map[1] * metres;
            heights.cell_y = -map[5] * metres;
        } else if (OSRIsGeographic(system)) {
            const double degrees = OSRGetAngularUnits(system, nullptr) * 57.29577951308232;
            heights.degrees_x = map[1] * degrees;
            heights.degrees_y = -map[5] * degrees;
            heights.latitude = (map[3] + 0.5 * heights.image.height * map[5]) * degrees;
        }
    }
    read_heights(path, band, fill, heights.image);
    return heights;
}

}  // namespace hoodoo

#else

namespace hoodoo
{

std::optional<GdalHeights> read_gdal_heights(const std::string&, std::optional<double>)
{
    return std::nullopt;
}

}  // namespace hoodoo

#endif
