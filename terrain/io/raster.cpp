// Named float channels in an EXR through OpenImageIO. What a file promises is checked before memory is taken, as height_image.cpp has it.
// Missing: tiles on demand, other formats to write.
#include "terrain/io/raster.h"

#include "terrain/error.h"
#include "terrain/io/atomic_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hoodoo
{

namespace
{

constexpr double kMaxPixels = 134217728.0;
constexpr double kMaxExpansion = 2000.0;

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {}, std::string nearest = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), std::move(nearest)});
}

}  // namespace

void write_raster(const std::string& path, const Raster& raster)
{
    const auto channels = raster.channels.size();
    const auto pixels = static_cast<std::size_t>(raster.columns) * static_cast<std::size_t>(raster.rows);
    std::vector<float> interleaved(pixels * channels);
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t k = 0; k < pixels; ++k) interleaved[k * channels + c] = raster.channels[c][k];
    OIIO::ImageSpec spec(raster.columns, raster.rows, static_cast<int>(channels), OIIO::TypeDesc::FLOAT);
    spec.channelnames = raster.names;
    spec.attribute("compression", "zip");
    if (raster.cell > 0.0) spec.attribute("hoodoo:cell", static_cast<float>(raster.cell));
    if (raster.place.known()) {
        spec.attribute("hoodoo:crs", raster.place.system);
        spec.attribute("hoodoo:geoTransform", raster.place.map_text());
    }
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("openexr", &memory);
    if (!output || !output->open("memory.exr", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, interleaved.data()) || !output->close())
        refuse(path, "cannot make the EXR: " + (output ? output->geterror() : OIIO::geterror()));
    write_atomically(
        path, [&](ByteSink& sink) { sink.write(file.data(), file.size()); }, [](const std::string&) {});
}

Raster read_raster(const std::string& path, const std::string& channel)
{
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (failed || !std::filesystem::is_regular_file(path, failed))
        refuse(path, "cannot read the map", "a regular file", failed ? failed.message() : "none");
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) refuse(path, "cannot read the map: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    const double pixels = static_cast<double>(spec.width) * spec.height;
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || pixels > kMaxPixels)
        refuse(path, "the size of the map", "a flat image of at most 134217728 pixels",
               fmt::format("{} x {} x {}", spec.width, spec.height, spec.depth));
    if (pixels * spec.nchannels * static_cast<double>(spec.format.size()) > kMaxExpansion * static_cast<double>(bytes) + 65536.0)
        refuse(path, "the map promises more than its file can hold", fmt::format("at most 2000 bytes for each of its {}", bytes),
               fmt::format("{} x {}", spec.width, spec.height));
    const auto found = std::find_if(spec.channelnames.begin(), spec.channelnames.end(),
                                    [&](const std::string& name) { return name == channel || name.ends_with("." + channel); });
    if (found == spec.channelnames.end()) {
        refuse(path, "the map has no such channel", fmt::format("one of {}", fmt::join(spec.channelnames, ", ")), '"' + channel + '"',
               nearest_name(channel, spec.channelnames));
    }
    const auto index = static_cast<int>(found - spec.channelnames.begin());
    Raster raster;
    raster.columns = spec.width;
    raster.rows = spec.height;
    const double cell = spec.get_float_attribute("hoodoo:cell", 0.0f);
    raster.cell = std::isfinite(cell) && cell > 0.0 ? cell : 0.0;
    raster.names = {channel};
    raster.channels.emplace_back(static_cast<std::size_t>(pixels));
    if (!input->read_image(0, 0, index, index + 1, OIIO::TypeDesc::FLOAT, raster.channels[0].data()))
        refuse(path, "cannot read the map: " + input->geterror());
    return raster;
}

}  // namespace hoodoo
