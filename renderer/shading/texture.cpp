// Images as textures: OpenImageIO caches and MIP-maps them, hex tiling hides their repetition.
//
// Tiling (Mikkelsen2022, Heitz2018): the plane is cut into triangles; each corner shifts the image by a hashed offset; a lookup blends the three
// shifted images with weights w (barycentric, cubed, normalised) and keeps the image's variance:
//     c = mean + sum_i w_i (c_i - mean) / sqrt(sum_i w_i^2).
// Deviations: no histogram transform (Heitz2018), so that a blend of very skewed colours can leave [0, 1] (the look clamps); no rotation of tiles,
// since rock and ripples have a direction. Filtering: the width of the footprint is given as explicit derivatives; MIP levels are those of the file,
// or made by the cache. Averages must be of linear numbers, so an sRGB image is read through an adaptor that undoes the curve (IEC 61966-2-1) and
// shows the cache the finest level alone. Safety: formats are whitelisted, sizes checked against the file's own bytes before anything is allocated,
// and every pixel is read once here, so that a truncated file is an error before the first ray and not a hole in the picture.

#include "renderer/shading/texture.h"

#include "terrain/math/hash.h"

#include <Imath/half.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

namespace hoodoo
{

namespace
{

constexpr int kLargestSide = 16384;
constexpr int kMostChannels = 8;
/// No coder of the whitelisted formats packs better than this: zlib reaches 1032.
constexpr double kBestCompression = 4000.0;
constexpr int kRowsAtOnce = 64;
const std::vector<std::string> kEndings = {".exr", ".tif", ".tiff", ".tx", ".png", ".jpg", ".jpeg", ".hdr"};
const std::vector<std::string> kFormats = {"openexr", "tiff", "png", "jpeg", "hdr"};

float linear_from_srgb(float v)
{
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// The file as half floats with the sRGB curve undone. The cache makes one, by name, whenever it opens the file.
class LinearInput final : public OIIO::ImageInput
{
public:
    const char* format_name() const override { return "linear"; }

    bool open(const std::string& name, OIIO::ImageSpec& spec) override
    {
        file_ = OIIO::ImageInput::open(name);
        if (!file_) return false;
        file_->threads(1);
        return seek_subimage(0, 0) && (spec = m_spec, true);
    }
    bool open(const std::string& name, OIIO::ImageSpec& spec, const OIIO::ImageSpec&) override { return open(name, spec); }

    bool seek_subimage(int subimage, int miplevel) override
    {
        // Only the finest level: the others of a file in sRGB are averages of codes, so the cache makes its own.
        if (subimage != 0 || miplevel != 0 || !file_ || !file_->seek_subimage(0, 0)) return false;
        m_spec = file_->spec();
        m_spec.set_format(OIIO::TypeDesc::HALF);
        m_spec.channelformats.clear();
        m_spec.erase_attribute("textureformat");  // with it the cache would take the one level for all there is to want
        return true;
    }
    int current_subimage() const override { return 0; }
    int current_miplevel() const override { return 0; }

    bool read_native_scanline(int subimage, int miplevel, int y, int, void* data) override
    {
        if (!seek_subimage(subimage, miplevel)) return false;
        std::vector<float> row(static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(m_spec.nchannels));
        if (!file_->read_scanlines(0, miplevel, y, y + 1, 0, 0, m_spec.nchannels, OIIO::TypeDesc::FLOAT, row.data())) return false;
        store(row, data);
        return true;
    }
    bool read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) override
    {
        if (!seek_subimage(subimage, miplevel)) return false;
        std::vector<float> tile(static_cast<std::size_t>(m_spec.tile_pixels()) * static_cast<std::size_t>(m_spec.nchannels));
        const auto end = [](int from, int size, int begin, int extent) { return std::min(from + size, begin + extent); };
        const int x1 = end(x, m_spec.tile_width, m_spec.x, m_spec.width), y1 = end(y, m_spec.tile_height, m_spec.y, m_spec.height);
        const auto pixel = static_cast<OIIO::stride_t>(sizeof(float)) * m_spec.nchannels;
        if (!file_->read_tiles(0, miplevel, x, x1, y, y1, z, z + 1, 0, m_spec.nchannels, OIIO::TypeDesc::FLOAT, tile.data(), pixel,
                               pixel * m_spec.tile_width))
            return false;
        store(tile, data);
        return true;
    }
    bool close() override { return !file_ || file_->close(); }

private:
    static void store(const std::vector<float>& from, void* data)
    {
        auto* to = static_cast<half*>(data);
        for (const float v : from) *to++ = half(linear_from_srgb(v));
    }

    std::unique_ptr<OIIO::ImageInput> file_;
};

[[noreturn]] void fail(const std::string& path, const Source& where, const std::string& what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{where, "image \"" + path + "\" " + what, std::move(expected), std::move(got), {}});
}

std::unique_ptr<OIIO::ImageInput> open_checked(const std::string& path, const Source& where)
{
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
        fail(path, where, "has an unknown format", ".exr, .tif, .tx, .png, .jpg or .hdr", "\"" + ending + "\"");
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) fail(path, where, "cannot be read", "a regular file");
    const auto bytes = static_cast<double>(std::filesystem::file_size(path, failed));

    auto file = OIIO::ImageInput::open(path);
    if (!file) fail(path, where, "cannot be read", {}, OIIO::geterror());
    if (std::find(kFormats.begin(), kFormats.end(), file->format_name()) == kFormats.end())
        fail(path, where, "is not what its ending says", "EXR, TIFF, PNG, JPEG or HDR", file->format_name());
    const OIIO::ImageSpec& spec = file->spec();
    const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height) + " x " + std::to_string(spec.depth) + " pixels, " +
                             std::to_string(spec.nchannels) + " channels";
    if (spec.width < 1 || spec.height < 1 || spec.depth != 1 || spec.deep || spec.width > kLargestSide || spec.height > kLargestSide ||
        spec.nchannels < 1 || spec.nchannels > kMostChannels)
        fail(path, where, "has a size that is not allowed", "a flat image of at most 16384 x 16384 pixels and 8 channels", size);
    if (static_cast<double>(spec.image_bytes(true)) > kBestCompression * bytes)
        fail(path, where, "claims more pixels than its bytes can hold", {}, size);
    file->threads(1);
    return file;
}

/// Reads rows [y0, y1) of the current level, tiled or not, as floats.
bool read_rows(OIIO::ImageInput& file, const OIIO::ImageSpec& spec, int level, int y0, int y1, std::vector<float>& rows)
{
    rows.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(y1 - y0) * static_cast<std::size_t>(spec.nchannels));
    if (spec.tile_width)
        return file.read_tiles(0, level, spec.x, spec.x + spec.width, y0, y1, spec.z, spec.z + 1, 0, spec.nchannels, OIIO::TypeDesc::FLOAT,
                               rows.data());
    return file.read_scanlines(0, level, y0, y1, spec.z, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, rows.data());
}

/// Reads every pixel of every level once; returns the mean of the finest in the linear numbers that lookups see.
Vec3f verified_mean(OIIO::ImageInput& file, const std::string& path, TextureEncoding encoding, const Source& where)
{
    Vec3d sum(0.0);
    double pixels = 0.0;
    std::vector<float> rows;
    for (int level = 0; level < 16 && file.seek_subimage(0, level); ++level) {
        const OIIO::ImageSpec spec = file.spec();
        const int step = spec.tile_height ? spec.tile_height : kRowsAtOnce;
        for (int y = spec.y; y < spec.y + spec.height; y += step) {
            if (!read_rows(file, spec, level, y, std::min(y + step, spec.y + spec.height), rows))
                fail(path, where, "cannot be read to its end", {}, file.geterror());
            const auto channels = static_cast<std::size_t>(spec.nchannels);
            for (std::size_t i = 0; i < rows.size(); i += channels)
                for (unsigned c = 0; c < 3; ++c) {
                    const float v = rows[i + (channels < 3 ? 0 : c)];
                    if (!std::isfinite(v)) fail(path, where, "has a pixel that is not finite");
                    if (level == 0) sum[c] += encoding == TextureEncoding::srgb ? linear_from_srgb(v) : v;
                }
            if (level == 0) pixels += static_cast<double>(rows.size() / channels);
        }
    }
    static_cast<void>(file.geterror());  // the level after the last was refused, as it should
    return Vec3f(sum / pixels);
}

}  // namespace

struct Texture::Files {
    OIIO::TextureSystem* system = OIIO::TextureSystem::create(false);  // ours alone: a host may use the shared one
    OIIO::TextureSystem::TextureHandle* handle = nullptr;
    int channels = 3;
    ~Files() { OIIO::TextureSystem::destroy(system, true); }
};

Texture::Texture(const std::string& path, const TextureOptions& options, const Source& where) : options_(options)
{
    const auto file = open_checked(path, where);
    const int channels = file->spec().nchannels;
    mean_ = verified_mean(*file, path, options.encoding, where);

    files_ = std::make_unique<Files>();
    files_->channels = channels < 3 ? 1 : 3;
    files_->system->attribute("automip", 1);
    files_->system->attribute("autotile", 64);
    files_->system->attribute("max_memory_MB", 1024.0f);
    const OIIO::ustring name(path);
    if (options.encoding == TextureEncoding::srgb) {
        const auto creator = []() -> OIIO::ImageInput* { return new LinearInput; };
        files_->system->imagecache()->add_file(name, creator);
    }
    files_->handle = files_->system->get_texture_handle(name);
    if (!files_->handle || !files_->system->good(files_->handle)) fail(path, where, "cannot be used as a texture", {}, files_->system->geterror());
}

Texture::~Texture() = default;

Vec3f Texture::filtered(const Vec2d& at, double footprint) const
{
    OIIO::TextureOpt how;
    how.swrap = how.twrap = OIIO::TextureOpt::WrapPeriodic;
    how.mipmode = OIIO::TextureOpt::MipModeTrilinear;
    how.interpmode = OIIO::TextureOpt::InterpBilinear;
    // The whole repeats are taken off in double precision: a float has no fraction left at 4000 km.
    const auto s = static_cast<float>(at.x - std::floor(at.x)), t = static_cast<float>(1.0 - (at.y - std::floor(at.y)));
    const auto width = static_cast<float>(footprint);
    Vec3f color(0.0f);
    if (!files_->system->texture(files_->handle, files_->system->get_perthread_info(), how, s, t, width, 0.0f, 0.0f, width, files_->channels,
                                 &color.x))
        return mean_;
    return files_->channels == 1 ? Vec3f(color.x) : color;
}

Vec3f Texture::lookup(const Vec2d& at, double footprint) const
{
    if (footprint >= 1.0) return mean_;  // one repeat or more: its coarsest level
    if (!options_.stochastic) return filtered(at, footprint);

    // Triangles with two to a repeat along each axis: barycentric coordinates in the skewed lattice.
    const Vec2d p = at * 2.0;
    const Vec2d skewed(p.x - p.y / std::sqrt(3.0), p.y * 2.0 / std::sqrt(3.0));
    const double bx = std::floor(skewed.x), by = std::floor(skewed.y);
    const double fx = skewed.x - bx, fy = skewed.y - by, rest = 1.0 - fx - fy;
    const int far = rest < 0.0 ? 1 : 0;
    const std::array<std::array<int, 2>, 3> corners = {{{far, far}, {1 - far, far}, {far, 1 - far}}};
    std::array<double, 3> w = far ? std::array<double, 3>{-rest, 1.0 - fy, 1.0 - fx} : std::array<double, 3>{rest, fx, fy};

    // Cubed weights blur less; those that cannot be seen are not looked up.
    double sum = 0.0, squares = 0.0;
    for (double& v : w) sum += v = std::max(v * v * v - 0.002, 0.0);
    for (double& v : w) squares += (v / sum) * (v / sum);
    Vec3f deviation(0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
        if (w[k] == 0.0) continue;
        const std::uint64_t h =
            hash_cell(options_.seed, static_cast<std::int64_t>(bx) + corners[k][0], static_cast<std::int64_t>(by) + corners[k][1]);
        const Vec2d offset(unit_real(h), unit_real(mix64(h)));
        deviation += (filtered(at + offset, footprint) - mean_) * static_cast<float>(w[k] / sum);
    }
    const Vec3f color = mean_ + deviation / static_cast<float>(std::sqrt(squares));
    return Vec3f(std::max(color.x, 0.0f), std::max(color.y, 0.0f), std::max(color.z, 0.0f));
}

}  // namespace hoodoo
