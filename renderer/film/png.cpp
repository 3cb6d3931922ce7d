// PNG files: eight bits a channel, as the colour configuration wants a screen to show the light.
//
// OpenImageIO encodes into memory, where no full disk can make it lie; the bytes take the same verified way to the disk as every file of ours.
// It works in the calling thread: its own thread pool would belong to the whole process, and to no child of it.
// Its colour space must be said: left alone, the encoder marks the file as linear (gAMA 1.0) and viewers show it far too bright.
#include "terrain/io/atomic_file.h"
#include "renderer/film/write.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace hoodoo
{

namespace
{

std::uint8_t quantise(float value)
{
    return static_cast<std::uint8_t>(std::floor(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f));
}

std::vector<unsigned char> encode(const std::vector<std::uint8_t>& pixels, const PixelBounds& data, bool is_srgb, const std::string& key)
{
    OIIO::ImageSpec spec(data.width(), data.height(), 3, OIIO::TypeDesc::UINT8);
    if (is_srgb) spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("Software", "Hoodoo " HOODOO_VERSION);
    if (!key.empty()) spec.attribute("hoodoo:picture", key);
    std::vector<unsigned char> encoded;
    OIIO::Filesystem::IOVecOutput memory(encoded);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (output) output->threads(1);
    if (!output || !output->set_ioproxy(&memory) || !output->open("picture.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !output->close())
        throw std::runtime_error(output ? output->geterror() : OIIO::geterror());
    return encoded;
}

std::vector<unsigned char> bytes_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("it cannot be opened");
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Throws if the file's bytes do not decode to the pixels.
void verify(const std::vector<std::uint8_t>& pixels, const PixelBounds& data, const std::string& path)
{
    std::vector<unsigned char> bytes = bytes_of(path);
    OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open("picture.png", nullptr, &memory);
    if (!input) throw std::runtime_error(OIIO::geterror());
    input->threads(1);
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width != data.width() || spec.height != data.height() || spec.nchannels != 3) throw std::runtime_error("its size differs");
    std::vector<std::uint8_t> found(pixels.size());
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, found.data())) throw std::runtime_error(input->geterror());
    if (found != pixels) throw std::runtime_error("the pixels differ");
}

}  // namespace

std::vector<std::uint8_t> display_bytes(const Image& image, const ColorTransform& to_display, double exposure_stops)
{
    const Channel *red = image.find("R"), *green = image.find("G"), *blue = image.find("B");
    if (!red || !green || !blue) throw Error(ErrorKind::internal, "a picture needs the channels R, G and B to be shown");
    const float scale = static_cast<float>(std::exp2(exposure_stops));
    const std::size_t width = static_cast<std::size_t>(image.data.width());
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * red->pixels.size());
    std::vector<Vec3f> row(width);
    for (std::size_t first = 0; first < red->pixels.size(); first += width) {
        for (std::size_t x = 0; x < width; ++x) row[x] = Vec3f(red->pixels[first + x], green->pixels[first + x], blue->pixels[first + x]) * scale;
        to_display(row);
        for (std::size_t x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                if (!std::isfinite(row[x][c]))
                    throw Error(ErrorKind::file,
                                fmt::format("the pixel ({}, {}) is not a finite number", image.data.x0 + x, image.data.y0 + first / width));
                bytes.push_back(quantise(row[x][c]));
            }
    }
    return bytes;
}

void write_png(const Image& image, const std::string& path, const ColorTransform& to_display, double exposure_stops, bool is_srgb)
{
    std::vector<std::uint8_t> pixels;
    try {
        pixels = display_bytes(image, to_display, exposure_stops);
    } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("the file \"{}\" cannot be written: {}", path, error.what()));
    }
    const auto found = image.metadata.find("hoodoo:picture");
    const std::string* key = found == image.metadata.end() ? nullptr : std::get_if<std::string>(&found->second);
    write_atomically(
        path,
        [&](ByteSink& sink) {
            const std::vector<unsigned char> encoded = encode(pixels, image.data, is_srgb, key ? *key : std::string());
            sink.write(encoded.data(), encoded.size());
        },
        [&](const std::string& temporary) { verify(pixels, image.data, temporary); });
}

std::string read_png_text(const std::string& path, const std::string& name)
{
    const auto refuse = [&](const std::string& why) -> std::string {
        throw Error(ErrorKind::file, fmt::format("the file \"{}\" cannot be read: {}", path, why));
    };
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) return refuse(OIIO::geterror());
    input->threads(1);
    std::vector<std::uint8_t> pixels(input->spec().image_pixels() * static_cast<std::size_t>(input->spec().nchannels));
    if (!input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::UINT8, pixels.data())) return refuse(input->geterror());
    return std::string(input->spec().get_string_attribute(name));
}

}  // namespace hoodoo
