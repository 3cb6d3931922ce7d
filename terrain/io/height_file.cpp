// Height images of any size through OpenImageIO, a row of tiles at a time, straight into the blocks of a grid.
// What a file promises is checked before memory is taken, as for the smaller images (height_image.cpp). Numbers stay as they are stored: OpenImageIO
// is asked for the file's own type wherever a grid can hold it. The place on the earth comes from our own attributes (what import-dem writes), or
// from the tags of a GeoTIFF. Deviation: doubles and integers of 32 bits become floats, which hold 24 bits.
#include "terrain/io/height_file.h"

#include "terrain/error.h"

#include <OpenImageIO/imageio.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace hoodoo
{

namespace
{

constexpr double kMaxSamples = 0x1p31;
constexpr double kMaxExpansion = 2000.0;  // deflate cannot pass 1032
constexpr int kRows = 64;                 // of pixels, where a file has no tiles

[[noreturn]] void refuse(const std::string& path, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), std::move(expected), std::move(got), {}});
}

/// The grid's type for a file's, and the type to ask the reader for.
std::pair<SampleType, OIIO::TypeDesc> types_of(const OIIO::TypeDesc& stored)
{
    switch (stored.basetype) {
        case OIIO::TypeDesc::UINT8:
            return {SampleType::u8, OIIO::TypeDesc::UINT8};
        case OIIO::TypeDesc::UINT16:
            return {SampleType::u16, OIIO::TypeDesc::UINT16};
        case OIIO::TypeDesc::INT16:
            return {SampleType::i16, OIIO::TypeDesc::INT16};
        default:
            return {SampleType::f32, OIIO::TypeDesc::FLOAT};
    }
}

}  // namespace

struct HeightFile::Open {
    std::string path;
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::TypeDesc ask;
    HeightFileInfo info;

    void check_size(const OIIO::ImageSpec& spec) const;
    void find_place(const OIIO::ImageSpec& spec);
    void read_piece(HeightGrid& grid, int y0, int y1, std::vector<unsigned char>& buffer) const;
};

void HeightFile::Open::check_size(const OIIO::ImageSpec& spec) const
{
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    const std::string size = fmt::format("{} x {}", spec.width, spec.height);
    if (spec.depth > 1 || spec.nchannels < 1 || spec.nchannels > 64)
        refuse(path, "size of the height image", "a flat image of 1 to 64 channels",
               fmt::format("{} x {}, {} channels", size, spec.depth, spec.nchannels));
    if (spec.width < 2 || spec.height < 2) refuse(path, "the height image is too small", "at least 2 x 2 samples, which make one cell", size);
    const double samples = static_cast<double>(spec.width) * spec.height;
    if (samples > kMaxSamples) refuse(path, "the height image is too large", "at most 2^31 samples", size);
    if (failed || samples * spec.nchannels * static_cast<double>(std::max<std::size_t>(1, spec.format.size())) >
                      kMaxExpansion * static_cast<double>(bytes) + 65536.0)
        refuse(path, "the height image promises more than its file can hold", fmt::format("at most 2000 bytes for each of its {}", bytes), size);
}

void HeightFile::Open::find_place(const OIIO::ImageSpec& spec)
{
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0 ? x : 0.0; };
    info.cell = Vec2d(positive(spec.get_float_attribute("hoodoo:cell", 0.0f)));
    info.height_scale = positive(spec.get_float_attribute("hoodoo:heightScale", 0.0f));
    if (const auto map = parse_map(std::string(spec.get_string_attribute("hoodoo:geoTransform")))) {
        info.place = {std::string(spec.get_string_attribute("hoodoo:crs")), *map};
    }
    if (input->format_name() != std::string("tiff")) return;
    const GeoTiffTags tags = read_geotiff_tags(path);
    if (tags.no_data) info.no_data = tags.no_data;
    if (!tags.place.known()) return;
    info.place = tags.place;
    if (tags.metres && info.cell.x == 0.0) info.cell = {tags.place.map[1], -tags.place.map[5]};
}

HeightFile::HeightFile(const std::string& path) : open_(std::make_unique<Open>())
{
    open_->path = path;
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed))
        refuse(path, "cannot read the height image", "a regular file", failed ? failed.message() : "none");
    open_->input = OIIO::ImageInput::open(path);
    if (!open_->input) refuse(path, "cannot read the height image: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = open_->input->spec();
    open_->check_size(spec);
    HeightFileInfo& info = open_->info;
    info.columns = spec.width;
    info.rows = spec.height;
    std::tie(info.type, open_->ask) = types_of(spec.format);
    info.is_unsigned = spec.format.basetype == OIIO::TypeDesc::UINT8 || spec.format.basetype == OIIO::TypeDesc::UINT16;
    info.largest = info.type == SampleType::u8 ? 255.0 : info.type == SampleType::u16 ? 65535.0 : 1.0;
    info.tile_width = spec.tile_width;
    info.tile_height = spec.tile_height;
    open_->find_place(spec);
}

HeightFile::~HeightFile() = default;

const HeightFileInfo& HeightFile::info() const
{
    return open_->info;
}

void HeightFile::Open::read_piece(HeightGrid& grid, int y0, int y1, std::vector<unsigned char>& buffer) const
{
    const OIIO::ImageSpec& spec = input->spec();
    const std::size_t sample = ask.size();
    const int top = grid.rows() - 1 - y0;
    if (spec.tile_width > 0) {
        for (int x = 0; x < spec.width; x += spec.tile_width) {
            const int x1 = std::min(x + spec.tile_width, spec.width);
            if (!input->read_tiles(0, 0, spec.x + x, spec.x + x1, spec.y + y0, spec.y + y1, spec.z, spec.z + 1, 0, 1, ask, buffer.data(), sample,
                                   sample * static_cast<std::size_t>(x1 - x)))
                refuse(path, "cannot read the height image: " + input->geterror());
            grid.fill(x, top, x1 - x, y1 - y0, buffer.data(), -static_cast<std::ptrdiff_t>(sample) * (x1 - x));
        }
        return;
    }
    if (!input->read_scanlines(0, 0, spec.y + y0, spec.y + y1, spec.z, 0, 1, ask, buffer.data(), sample))
        refuse(path, "cannot read the height image: " + input->geterror());
    grid.fill(0, top, spec.width, y1 - y0, buffer.data(), -static_cast<std::ptrdiff_t>(sample) * spec.width);
}

void HeightFile::read(HeightGrid& grid, const std::function<void(double)>& progress) const
{
    const HeightFileInfo& info = open_->info;
    if (grid.columns() != info.columns || grid.rows() != info.rows || grid.type() != info.type)
        throw Error(ErrorKind::internal, "a grid that was not made for this file");
    const int step = info.tile_height > 0 ? info.tile_height : kRows;
    const std::size_t width = info.tile_width > 0 ? static_cast<std::size_t>(info.tile_width) : static_cast<std::size_t>(info.columns);
    std::vector<unsigned char> buffer(width * static_cast<std::size_t>(step) * open_->ask.size());
    for (int y = 0; y < info.rows; y += step) {
        open_->read_piece(grid, y, std::min(y + step, info.rows), buffer);
        if (progress) progress(std::min(1.0, static_cast<double>(y + step) / info.rows));
    }
    grid.summarise();
}

}  // namespace hoodoo
