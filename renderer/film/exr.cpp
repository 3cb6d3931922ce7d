// OpenEXR files, written so that a reader finds what was meant or nothing.
//
// OpenEXR itself is used, not OpenImageIO: every attribute is ours, equal pictures make equal bytes, and errors are thrown. The pixels go out in
// bands of rows, because converting whole planes to half would double the memory of a large picture; the check reads the file in the same bands.
// Ids are floats, not the format's integers: a float holds every id below 2^24 exactly, and programs that read integers as floats scale them to [0,
// 1]. Attribute names and conventions: OpenEXR's list of standard attributes; capDate is what other programs call DateTime.
//
// Missing: parts, tiles, deep data, compression other than zip.
#include "terrain/io/atomic_file.h"
#include "renderer/film/write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>

namespace hoodoo
{

namespace
{

constexpr int band_rows = 64;  // a multiple of the 16 rows of a zip chunk
constexpr float largest_half = 65504.0f;
constexpr std::int64_t max_read_pixels = 1ll << 28;

/// OpenEXR's stream on top of our sink.
class SinkStream : public Imf::OStream
{
public:
    explicit SinkStream(ByteSink& sink) : OStream("picture"), sink_(sink) {}
    void write(const char bytes[], int count) override { sink_.write(bytes, static_cast<std::size_t>(count)); }
    std::uint64_t tellp() override { return sink_.tell(); }
    void seekp(std::uint64_t position) override { sink_.seek(position); }

private:
    ByteSink& sink_;
};

bool starts_with_one_of(const std::string& name, std::initializer_list<const char*> prefixes)
{
    return std::any_of(prefixes.begin(), prefixes.end(), [&](const char* prefix) { return name.rfind(prefix, 0) == 0; });
}

Imf::PixelType pixel_type(const std::string& name, bool radiance_fits_half)
{
    if (name == "R" || name == "G" || name == "B") return radiance_fits_half ? Imf::HALF : Imf::FLOAT;
    if (name == "A" || starts_with_one_of(name, {"N.", "Ng.", "albedo.", "material."})) return Imf::HALF;
    return Imf::FLOAT;
}

bool fits_half(const Image& image)
{
    for (const char* name : {"R", "G", "B"})
        if (const Channel* channel = image.find(name))
            for (const float value : channel->pixels)
                if (std::abs(value) > largest_half) return false;
    return true;
}

/// The values in the type of the file.
std::vector<char> encode(std::span<const float> values, Imf::PixelType type)
{
    std::vector<char> bytes(values.size() * (type == Imf::HALF ? 2 : 4));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float value = values[i];
        if (type == Imf::HALF) {
            const half h(value);
            std::memcpy(&bytes[2 * i], &h, 2);
        } else {
            std::memcpy(&bytes[4 * i], &value, 4);
        }
    }
    return bytes;
}

struct Band {
    int y0, y1;  // half-open
};

std::vector<Band> bands_of(const PixelBounds& data)
{
    std::vector<Band> bands;
    for (int y = data.y0; y < data.y1; y += band_rows) bands.push_back({y, std::min(y + band_rows, data.y1)});
    return bands;
}

std::span<const float> rows(const Channel& channel, const PixelBounds& data, const Band& band)
{
    const std::size_t width = static_cast<std::size_t>(data.width());
    return std::span(channel.pixels).subspan((band.y0 - data.y0) * width, (band.y1 - band.y0) * width);
}

Imf::Slice slice(Imf::PixelType type, void* bytes, const PixelBounds& data, const Band& band)
{
    return Imf::Slice::Make(type, bytes, Imath::V2i(data.x0, band.y0), data.width(), band.y1 - band.y0);
}

struct AttributeWriter {
    Imf::Header& header;
    const std::string& name;

    void operator()(int value) const { header.insert(name, Imf::IntAttribute(value)); }
    void operator()(float value) const { header.insert(name, Imf::FloatAttribute(value)); }
    void operator()(const std::string& value) const { header.insert(name == "DateTime" ? "capDate" : name, Imf::StringAttribute(value)); }
    void operator()(const std::vector<float>& v) const
    {
        if (name == "chromaticities" && v.size() == 8)
            Imf::addChromaticities(header, Imf::Chromaticities({v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}));
        else if (v.size() == 2)
            header.insert(name, Imf::V2fAttribute({v[0], v[1]}));
        else if (v.size() == 3)
            header.insert(name, Imf::V3fAttribute({v[0], v[1], v[2]}));
        else if (v.size() == 16) {
            Imath::M44f matrix;
            std::copy(v.begin(), v.end(), &matrix[0][0]);
            header.insert(name, Imf::M44fAttribute(matrix));
        } else
            header.insert(name, Imf::FloatVectorAttribute(v));
    }
};

Imf::Header make_header(const Image& image, ExrPrecision precision)
{
    const PixelBounds& d = image.data;
    Imf::Header header(Imath::Box2i({0, 0}, {image.width - 1, image.height - 1}), Imath::Box2i({d.x0, d.y0}, {d.x1 - 1, d.y1 - 1}));
    header.compression() = Imf::ZIP_COMPRESSION;
    const bool radiance_fits_half = fits_half(image);
    for (const Channel& channel : image.channels) {
        const Imf::PixelType type = precision == ExrPrecision::full ? Imf::FLOAT : pixel_type(channel.name, radiance_fits_half);
        header.channels().insert(channel.name, Imf::Channel(type));
    }
    for (const auto& [name, value] : image.metadata) std::visit(AttributeWriter{header, name}, value);
    return header;
}

void write_pixels(const Image& image, const Imf::Header& header, ByteSink& sink)
{
    SinkStream stream(sink);
    Imf::OutputFile file(stream, header);
    for (const Band& band : bands_of(image.data)) {
        std::vector<std::vector<char>> encoded;
        Imf::FrameBuffer buffer;
        for (const Channel& channel : image.channels) {
            const Imf::PixelType type = header.channels()[channel.name].type;
            encoded.push_back(encode(rows(channel, image.data, band), type));
            buffer.insert(channel.name, slice(type, encoded.back().data(), image.data, band));
        }
        file.setFrameBuffer(buffer);
        file.writePixels(band.y1 - band.y0);
    }
}

/// Throws if the file's windows, channels or pixels are not those of the image.
void verify(const Image& image, const Imf::Header& expected, const std::string& path)
{
    Imf::InputFile file(path.c_str());
    if (file.header().dataWindow() != expected.dataWindow() || file.header().displayWindow() != expected.displayWindow() ||
        !(file.header().channels() == expected.channels()))
        throw std::runtime_error("the header differs");
    for (const Band& band : bands_of(image.data)) {
        std::vector<std::vector<char>> meant, found;
        Imf::FrameBuffer buffer;
        for (const Channel& channel : image.channels) {
            const Imf::PixelType type = expected.channels()[channel.name].type;
            meant.push_back(encode(rows(channel, image.data, band), type));
            found.emplace_back(meant.back().size());
            buffer.insert(channel.name, slice(type, found.back().data(), image.data, band));
        }
        file.setFrameBuffer(buffer);
        file.readPixels(band.y0, band.y1 - 1);
        if (meant != found) throw std::runtime_error(fmt::format("the pixels of rows {} to {} differ", band.y0, band.y1 - 1));
    }
}

void check_shape(const Image& image)
{
    const PixelBounds& d = image.data;
    const std::size_t pixels = static_cast<std::size_t>(std::max(d.width(), 0)) * static_cast<std::size_t>(std::max(d.height(), 0));
    const bool whole = pixels > 0 && !image.channels.empty() &&
                       std::all_of(image.channels.begin(), image.channels.end(), [&](const Channel& c) { return c.pixels.size() == pixels; });
    if (!whole) throw Error(ErrorKind::internal, "an image without pixels, or with channels of another size than its data window, cannot be written");
}

void read_metadata(const Imf::Header& header, Image& image)
{
    for (auto it = header.begin(); it != header.end(); ++it) {
        const std::string name = std::string(it.name()) == "capDate" ? "DateTime" : it.name();
        const Imf::Attribute& attribute = it.attribute();
        if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(&attribute)) image.metadata[name] = i->value();
        if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) image.metadata[name] = f->value();
        if (const auto* s = dynamic_cast<const Imf::StringAttribute*>(&attribute)) image.metadata[name] = s->value();
        if (const auto* v = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute)) image.metadata[name] = v->value();
        if (const auto* v = dynamic_cast<const Imf::V2fAttribute*>(&attribute)) image.metadata[name] = std::vector{v->value().x, v->value().y};
        if (const auto* v = dynamic_cast<const Imf::V3fAttribute*>(&attribute))
            image.metadata[name] = std::vector{v->value().x, v->value().y, v->value().z};
        if (const auto* m = dynamic_cast<const Imf::M44fAttribute*>(&attribute)) {
            const float* first = &m->value()[0][0];
            image.metadata[name] = std::vector<float>(first, first + 16);
        }
        if (const auto* c = dynamic_cast<const Imf::ChromaticitiesAttribute*>(&attribute)) {
            const Imf::Chromaticities& p = c->value();
            image.metadata[name] = std::vector{p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y, p.white.x, p.white.y};
        }
    }
}

}  // namespace

void write_exr(const Image& image, const std::string& path, ExrPrecision precision)
{
    check_shape(image);
    const Imf::Header header = make_header(image, precision);
    write_atomically(
        path, [&](ByteSink& sink) { write_pixels(image, header, sink); }, [&](const std::string& temporary) { verify(image, header, temporary); });
}

Image read_exr(const std::string& path)
{
    try {
        Imf::InputFile file(path.c_str());
        const Imath::Box2i display = file.header().displayWindow(), window = file.header().dataWindow();
        Image image;
        image.width = display.max.x + 1;
        image.height = display.max.y + 1;
        image.data = {window.min.x, window.max.x + 1, window.min.y, window.max.y + 1};
        const std::int64_t pixels = static_cast<std::int64_t>(image.data.width()) * image.data.height();
        if (pixels > max_read_pixels) throw std::runtime_error("it claims too many pixels");
        for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it)
            image.channels.push_back({it.name(), std::vector<float>(static_cast<std::size_t>(pixels))});
        Imf::FrameBuffer buffer;
        for (Channel& channel : image.channels)
            buffer.insert(channel.name, slice(Imf::FLOAT, channel.pixels.data(), image.data, {image.data.y0, image.data.y1}));
        file.setFrameBuffer(buffer);
        file.readPixels(image.data.y0, image.data.y1 - 1);
        read_metadata(file.header(), image);
        return image;
    } catch (const std::exception& failure) {
        throw Error(ErrorKind::file, fmt::format("the picture \"{}\" cannot be read: {}", path, failure.what()));
    }
}

}  // namespace hoodoo
