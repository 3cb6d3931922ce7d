// Vector graphics small enough to be read: neighbouring lines of one look become one SVG path; a PNG pixel is covered by a line as far as it lies
// within half the line's width of its middle, softened over one pixel. Missing: curves, polygons, words in PNG.
#include "terrain/io/drawing.h"

#include "terrain/error.h"
#include "terrain/io/atomic_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hoodoo
{

namespace
{

std::string hex(const Drawing::Colour& c)
{
    return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

/// Cuts a segment to a box; false if nothing is left.
bool clip(const Vec2d& low, const Vec2d& high, Vec2d& a, Vec2d& b)
{
    double s = 0.0, t = 1.0;
    const Vec2d along = b - a;
    for (int k = 0; k < 2; ++k) {
        if (along[k] == 0.0) {
            if (a[k] < low[k] || a[k] > high[k]) return false;
            continue;
        }
        const double u = (low[k] - a[k]) / along[k], v = (high[k] - a[k]) / along[k];
        s = std::max(s, std::min(u, v));
        t = std::min(t, std::max(u, v));
    }
    if (s > t) return false;
    b = a + along * t;
    a = a + along * s;
    return true;
}

std::string escaped(const std::string& words)
{
    std::string out;
    for (const char c : words) {
        if (c == '<')
            out += "&lt;";
        else if (c == '&')
            out += "&amp;";
        else
            out += c;
    }
    return out;
}

}  // namespace

void Drawing::rectangle(const Vec2d& low, const Vec2d& high, const Colour& colour)
{
    const Vec2d a(std::max(low.x, low_.x), std::max(low.y, low_.y)), b(std::min(high.x, high_.x), std::min(high.y, high_.y));
    if (a.x < b.x && a.y < b.y) items_.push_back({Item::Kind::rectangle, a, b, colour, 0.0, {}});
}

void Drawing::line(const Vec2d& from, const Vec2d& to, const Colour& colour, double width)
{
    Vec2d a = from, b = to;
    if (clip(low_, high_, a, b)) items_.push_back({Item::Kind::line, a, b, colour, width, {}});
}

void Drawing::text(const Vec2d& at, const std::string& words, double size)
{
    items_.push_back({Item::Kind::text, at, at, {0, 0, 0}, size, words});
}

std::string Drawing::svg() const
{
    std::string out = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.6g}\" height=\"{1:.6g}\" viewBox=\"0 0 {0:.6g} {1:.6g}\">\n",
                                  width_, height_);
    const auto to = std::back_inserter(out);
    fmt::format_to(to, "<rect width=\"{:.6g}\" height=\"{:.6g}\" fill=\"#ffffff\"/>\n", width_, height_);
    for (std::size_t k = 0; k < items_.size();) {
        const Item& item = items_[k];
        if (item.kind == Item::Kind::rectangle) {
            fmt::format_to(to, "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n", item.a.x, item.a.y,
                           item.b.x - item.a.x, item.b.y - item.a.y, hex(item.colour));
            ++k;
        } else if (item.kind == Item::Kind::text) {
            fmt::format_to(to, "<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" font-size=\"{:.6g}\">{}</text>\n", item.a.x, item.a.y,
                           item.width, escaped(item.words));
            ++k;
        } else {
            fmt::format_to(to, "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{:.6g}\" stroke-linecap=\"round\" d=\"", hex(item.colour),
                           item.width);
            for (; k < items_.size() && items_[k].kind == item.kind && items_[k].colour == item.colour && items_[k].width == item.width; ++k) {
                const Item& line = items_[k];
                if (k == 0 || &line == &item || items_[k - 1].b != line.a) fmt::format_to(to, "M{:.2f} {:.2f}", line.a.x, line.a.y);
                fmt::format_to(to, "L{:.2f} {:.2f}", line.b.x, line.b.y);
            }
            out += "\"/>\n";
        }
    }
    return out + "</svg>\n";
}

int Drawing::columns() const
{
    return std::max(1, static_cast<int>(std::ceil(width_)));
}
int Drawing::rows() const
{
    return std::max(1, static_cast<int>(std::ceil(height_)));
}

std::vector<std::uint8_t> Drawing::pixels() const
{
    const int columns = this->columns(), rows = this->rows();
    std::vector<std::uint8_t> out(3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 255);
    for (const Item& item : items_) {
        if (item.kind == Item::Kind::text) continue;
        const bool area = item.kind == Item::Kind::rectangle;
        const double reach = area ? 0.0 : 0.5 * item.width + 1.0;
        const auto first = [&](double x) { return std::max(0, static_cast<int>(std::floor(x - reach))); };
        const auto last = [&](double x, int n) { return std::min(n, static_cast<int>(std::ceil(x + reach))); };
        const Vec2d low(std::min(item.a.x, item.b.x), std::min(item.a.y, item.b.y)), high(std::max(item.a.x, item.b.x), std::max(item.a.y, item.b.y));
        const Vec2d along = item.b - item.a;
        for (int y = first(low.y); y < last(high.y, rows); ++y) {
            for (int x = first(low.x); x < last(high.x, columns); ++x) {
                const Vec2d p(x + 0.5, y + 0.5);
                double cover;
                if (area) {
                    const auto share = [](double from, double to, int cell) {
                        return std::clamp(std::min(to, cell + 1.0) - std::max(from, 1.0 * cell), 0.0, 1.0);
                    };
                    cover = share(low.x, high.x, x) * share(low.y, high.y, y);
                } else {
                    const double u = along.length2() > 0.0 ? std::clamp((p - item.a).dot(along) / along.length2(), 0.0, 1.0) : 0.0;
                    cover = std::clamp(0.5 * item.width + 0.5 - (p - item.a - along * u).length(), 0.0, std::min(1.0, item.width));
                }
                for (std::size_t c = 0; c < 3; ++c) {
                    std::uint8_t& value =
                        out[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)) + c];
                    value = static_cast<std::uint8_t>(std::lround(value + (item.colour[c] - value) * cover));
                }
            }
        }
    }
    return out;
}

void Drawing::write(const std::string& path) const
{
    if (path.ends_with(".svg")) {
        const std::string text = svg();
        write_atomically(
            path, [&](ByteSink& sink) { sink.write(text.data(), text.size()); }, [](const std::string&) {});
        return;
    }
    if (width_ * height_ > 268435456.0)
        throw Error(ErrorKind::file, fmt::format("{}: a drawing of {:.6g} x {:.6g} pixels is too large", path, width_, height_));
    write_png_bytes(path, columns(), rows(), 3, pixels());
}

void write_png_bytes(const std::string& path, int columns, int rows, int channels, const std::vector<std::uint8_t>& bytes)
{
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png", &memory);
    const OIIO::ImageSpec spec(columns, rows, channels, OIIO::TypeDesc::UINT8);
    if (!output || !output->open("memory.png", spec) || !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !output->close())
        throw Error(ErrorKind::file, fmt::format("{}: cannot make a PNG: {}", path, output ? output->geterror() : OIIO::geterror()));
    write_atomically(
        path, [&](ByteSink& sink) { sink.write(file.data(), file.size()); }, [](const std::string&) {});
}

}  // namespace hoodoo
