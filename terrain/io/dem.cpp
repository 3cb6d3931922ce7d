// Elevation models in degrees become square cells in metres: the step along a parallel shrinks with the cosine of the latitude.
// Snyder1987, equations 4-18 to 4-20: with e^2 = f(2 - f), a degree of the meridian is pi/180 a(1 - e^2)/(1 - e^2 sin^2 phi)^1.5,
// one of the parallel pi/180 a cos(phi)/(1 - e^2 sin^2 phi)^0.5; a = 6378137 m, f = 1/298.257223563.
// Deviation: one latitude for the whole model (its middle): over 0.3 degrees the width errs by 0.2 % at the edges. GeoTIFFs and their
// like come through GDAL (gdal_heights.cpp). Missing: reprojection.
#include "terrain/io/dem.h"

#include "terrain/error.h"
#include "terrain/io/gdal_heights.h"
#include "terrain/io/npz.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace hoodoo
{

namespace
{

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

struct RawHeights {
    HeightImage image;
    double degrees_x = 0.0, degrees_y = 0.0, latitude = 91.0;  ///< what the file itself says
    double cell_x = 0.0, cell_y = 0.0;                         ///< metres
};

std::optional<double> scalar(const NpzFile& file, const std::string& name)
{
    if (!file.has(name)) return std::nullopt;
    const NumpyArray array = file.read(name);
    if (array.values.size() != 1 || !std::isfinite(array.values[0])) return std::nullopt;
    return array.values[0];
}

RawHeights read_archive(const std::string& path, const std::string& wanted)
{
    const NpzFile file(path);
    std::string name = wanted;
    if (name.empty()) {
        std::vector<std::string> flat;
        for (const std::string& candidate : file.names()) {
            if (file.read(candidate).shape.size() == 2) flat.push_back(candidate);
        }
        if (flat.size() != 1)
            refuse(path, "which array holds the heights?", "the name of an array with two dimensions",
                   fmt::format("{} of them: {}", flat.size(), fmt::join(flat, ", ")));
        name = flat[0];
    }
    const NumpyArray array = file.read(name);
    if (array.shape.size() != 2 || array.values.empty())
        refuse(path, "\"" + name + "\" is no height map", "an array with two dimensions", fmt::format("{} dimensions", array.shape.size()));
    RawHeights source;
    source.image.height = static_cast<int>(array.shape[0]);
    source.image.width = static_cast<int>(array.shape[1]);
    source.image.values.reserve(array.values.size());
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        if (!std::isfinite(static_cast<float>(array.values[i]))) {
            refuse(path, "a sample of the height map is no number", "finite heights",
                   fmt::format("{} at column {}, row {}", array.values[i], i % array.shape[1], i / array.shape[1]));
        }
        source.image.values.push_back(static_cast<float>(array.values[i]));
    }
    source.degrees_x = std::abs(scalar(file, "dx").value_or(0.0));
    source.degrees_y = std::abs(scalar(file, "dy").value_or(0.0));
    const auto south = scalar(file, "ymin"), north = scalar(file, "ymax");
    if (south && north) source.latitude = 0.5 * (*south + *north);
    return source;
}

/// An archive; what GDAL knows, in a build with it; else an image.
RawHeights read_raw(const std::string& path, const DemOptions& options)
{
    if (path.ends_with(".npz")) return read_archive(path, options.array);
    std::optional<GdalHeights> measured = read_gdal_heights(path, options.fill);
    if (!measured) return RawHeights{read_height_image(path)};
    RawHeights source{std::move(measured->image), measured->degrees_x, measured->degrees_y, measured->latitude, measured->cell_x, measured->cell_y};
    return source;
}

HeightImage cropped(const std::string& path, const HeightImage& image, const DemOptions& options)
{
    std::array<int, 4> s = options.subset;
    if (s == std::array<int, 4>{0, 0, 0, 0}) s = {0, image.width, 0, image.height};
    if (!(0 <= s[0] && s[0] < s[1] && s[1] <= image.width && 0 <= s[2] && s[2] < s[3] && s[3] <= image.height)) {
        refuse(path, "subset of the height map", fmt::format("x0,x1,y0,y1 inside {} x {}", image.width, image.height),
               fmt::format("{},{},{},{}", s[0], s[1], s[2], s[3]));
    }
    HeightImage result{s[1] - s[0], s[3] - s[2], image.cell, {}, {}};
    // Turned over, row r of the result is the source's row height - 1 - r.
    if (options.flip)
        result.place = image.place.of_pixels(s[0], image.height - s[2], 1.0, -1.0);
    else
        result.place = image.place.of_pixels(s[0], s[2], 1.0, 1.0);
    result.values.reserve(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height));
    for (int row = s[2]; row < s[3]; ++row) {
        for (int column = s[0]; column < s[1]; ++column) {
            result.values.push_back(static_cast<float>(options.scale * image.at(column, options.flip ? image.height - 1 - row : row)));
        }
    }
    return result;
}

}  // namespace

std::array<double, 2> metres_in_a_degree(double latitude)
{
    constexpr double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f), degree = std::numbers::pi / 180.0;
    const double s = std::sin(latitude * degree), w = 1.0 - e2 * s * s;
    return {degree * a * std::cos(latitude * degree) / std::sqrt(w), degree * a * (1.0 - e2) / (w * std::sqrt(w))};
}

HeightImage import_dem(const std::string& path, const DemOptions& options)
{
    RawHeights source = read_raw(path, options);
    HeightImage image = cropped(path, source.image, options);

    // Metres a pixel: as told, else from degrees, else what the image says of itself.
    double x = options.cell_x, y = options.cell_y > 0.0 ? options.cell_y : options.cell_x;
    const double degrees_x = options.degrees_x > 0.0 ? options.degrees_x : source.degrees_x;
    const double degrees_y =
        options.degrees_y > 0.0 ? options.degrees_y : (source.degrees_y > 0.0 && options.degrees_x == 0.0 ? source.degrees_y : degrees_x);
    const double latitude = options.latitude <= 90.0 ? options.latitude : source.latitude;
    if (!(x > 0.0) && degrees_x > 0.0) {
        if (!(std::abs(latitude) < 89.9)) refuse(path, "heights in degrees need a latitude", "a latitude between -89.9 and 89.9 degrees");
        const auto [along, up] = metres_in_a_degree(latitude);
        x = degrees_x * along;
        y = degrees_y * up;
    }
    if (!(x > 0.0) && source.cell_x > 0.0) x = source.cell_x, y = source.cell_y;
    if (!(x > 0.0)) x = y = source.image.cell;
    if (!(x > 0.0 && y > 0.0)) refuse(path, "the size of a pixel is not known", "a cell size in metres, or degrees and a latitude");

    const double square = options.resample_to > 0.0 ? options.resample_to : std::min(x, y);
    if (std::abs(square / x - 1.0) > 1e-9 || std::abs(square / y - 1.0) > 1e-9) image = resample(image, square / x, square / y);
    image.cell = square;
    return image;
}

}  // namespace hoodoo
