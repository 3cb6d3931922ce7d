// Height images through OpenImageIO, the only place in the terrain that includes it.
// What a file promises is checked before memory is taken: size, and bytes decoded for each byte stored (deflate cannot pass 1032).
// Resampling: Keys1981 (a = -1/2), which reproduces parabolas; when it shrinks, the kernel is widened by the step, so that nothing aliases.
// Missing: several channels, tiles on demand (a height map is small beside the terrain made from it).
#include "terrain/io/height_image.h"

#include "terrain/error.h"

#include <OpenImageIO/imageio.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hoodoo
{

namespace
{

constexpr double kMaxSamples = 134217728.0;  // 2^27: half a gigabyte of floats
constexpr double kMaxExpansion = 2000.0;

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

double keys(double x)
{
    x = std::abs(x);
    if (x < 1.0) return (1.5 * x - 2.5) * x * x + 1.0;
    if (x < 2.0) return ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0;
    return 0.0;
}

struct Taps {
    int first = 0;
    std::vector<double> weights;
};

/// Weights for each new pixel along one axis.
std::vector<Taps> taps(double step, int count)
{
    const double wide = std::max(1.0, step);
    std::vector<Taps> all(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) {
        const double centre = (k + 0.5) * step - 0.5;
        Taps& t = all[static_cast<std::size_t>(k)];
        t.first = static_cast<int>(std::ceil(centre - 2.0 * wide));
        double sum = 0.0;
        for (int i = t.first; i <= centre + 2.0 * wide; ++i) sum += t.weights.emplace_back(keys((i - centre) / wide));
        for (double& w : t.weights) w /= sum;
    }
    return all;
}

}  // namespace

HeightImage read_height_image(const std::string& path)
{
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (failed || !std::filesystem::is_regular_file(path, failed))
        refuse(path, "cannot read the height image", "a regular file", failed ? failed.message() : "none");
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) refuse(path, "cannot read the height image: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    const double samples = static_cast<double>(spec.width) * spec.height * std::max(1, spec.depth);
    const double promised = samples * std::max(1, spec.nchannels) * static_cast<double>(std::max<std::size_t>(1, spec.format.size()));
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.nchannels > 64) {
        refuse(path, "size of the height image", "a flat image of 1 to 64 channels",
               fmt::format("{} x {} x {}, {} channels", spec.width, spec.height, spec.depth, spec.nchannels));
    }
    if (samples > kMaxSamples)
        refuse(path, "the height image is too large", "at most 134217728 pixels", fmt::format("{} x {}", spec.width, spec.height));
    if (promised > kMaxExpansion * static_cast<double>(bytes) + 65536.0) {
        refuse(path, "the height image promises more than its file can hold", fmt::format("at most 2000 bytes for each of its {}", bytes),
               fmt::format("{} x {}", spec.width, spec.height));
    }
    HeightImage image;
    image.width = spec.width;
    image.height = spec.height;
    const double cell = spec.get_float_attribute("hoodoo:cell", 0.0f);
    image.cell = std::isfinite(cell) && cell > 0.0 ? cell : 0.0;
    if (const auto map = parse_map(std::string(spec.get_string_attribute("hoodoo:geoTransform"))))
        image.place = {std::string(spec.get_string_attribute("hoodoo:crs")), *map};
    image.values.resize(static_cast<std::size_t>(samples));
    if (!input->read_image(0, 0, 0, 1, OIIO::TypeDesc::FLOAT, image.values.data()))
        refuse(path, "cannot read the height image: " + input->geterror());
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (!std::isfinite(image.values[i])) {
            refuse(path, "a sample of the height image is no number", "finite heights",
                   fmt::format("{} at column {}, row {}", image.values[i], i % image.width, i / image.width));
        }
    }
    return image;
}

void write_height_image(const std::string& path, const HeightImage& image)
{
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
    if (!output) refuse(path, "cannot write the height image: " + OIIO::geterror());
    OIIO::ImageSpec spec(image.width, image.height, 1, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"Y"};
    spec.attribute("compression", "zip");
    spec.attribute("hoodoo:cell", static_cast<float>(image.cell));
    if (image.place.known()) {
        spec.attribute("hoodoo:crs", image.place.system);
        spec.attribute("hoodoo:geoTransform", image.place.map_text());
    }
    if (!output->open(path, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, image.values.data()) || !output->close()) {
        refuse(path, "cannot write the height image: " + output->geterror());
    }
}

HeightImage resample(const HeightImage& image, double step_x, double step_y)
{
    const double width = std::max(1.0, std::floor(image.width / step_x + 1e-9)), height = std::max(1.0, std::floor(image.height / step_y + 1e-9));
    if (!(step_x > 0.0 && step_y > 0.0 && width * height <= kMaxSamples && width * image.height <= kMaxSamples)) {
        throw Error(ErrorKind::file,
                    Problem{{}, "resampled height image", "a step above 0 and at most 134217728 pixels", fmt::format("{} x {}", width, height), {}});
    }
    HeightImage across{static_cast<int>(width), image.height, 0.0, {}, {}};
    HeightImage result{static_cast<int>(width), static_cast<int>(height), 0.0, {}, image.place.of_pixels(0.0, 0.0, step_x, step_y)};
    across.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height));
    result.values.resize(static_cast<std::size_t>(width * height));
    const std::vector<Taps> columns = taps(step_x, across.width), rows = taps(step_y, result.height);
    for (int row = 0; row < across.height; ++row) {
        for (int column = 0; column < across.width; ++column) {
            const Taps& t = columns[static_cast<std::size_t>(column)];
            double sum = 0.0;
            for (std::size_t k = 0; k < t.weights.size(); ++k)
                sum += t.weights[k] * image.at(std::clamp(t.first + static_cast<int>(k), 0, image.width - 1), row);
            across.at(column, row) = static_cast<float>(sum);
        }
    }
    for (int row = 0; row < result.height; ++row) {
        const Taps& t = rows[static_cast<std::size_t>(row)];
        for (int column = 0; column < result.width; ++column) {
            double sum = 0.0;
            for (std::size_t k = 0; k < t.weights.size(); ++k)
                sum += t.weights[k] * across.at(column, std::clamp(t.first + static_cast<int>(k), 0, image.height - 1));
            result.at(column, row) = static_cast<float>(sum);
        }
    }
    return result;
}

}  // namespace hoodoo
