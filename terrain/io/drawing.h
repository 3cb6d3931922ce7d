// Lines and areas on a page, written as SVG or PNG: what diagrams, sections and contour maps are drawn with.
#pragma once

#include "terrain/math/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

/// A page with y downwards, in units that are pixels of a PNG. What comes later lies on top.
class Drawing
{
public:
    using Colour = std::array<std::uint8_t, 3>;  ///< sRGB

    /// White, at least one unit each way.
    Drawing(double width, double height) : width_(width), height_(height), low_(0.0), high_(width, height) {}

    /// What follows is cut off at this rectangle.
    void clip_to(const Vec2d& low, const Vec2d& high) { low_ = low, high_ = high; }
    void rectangle(const Vec2d& low, const Vec2d& high, const Colour& colour);
    /// With round ends. From a point to itself: a dot.
    void line(const Vec2d& from, const Vec2d& to, const Colour& colour, double width);
    /// Words whose first letter stands there. SVG only: a PNG has no fonts.
    void text(const Vec2d& at, const std::string& words, double size);

    std::string svg() const;
    /// Red, green, blue of each pixel, row by row, row 0 on top.
    std::vector<std::uint8_t> pixels() const;
    int columns() const;
    int rows() const;

    /// By the name's ending: .svg or .png, replaced in one step. Throws Error (file); a PNG of over 2^28 pixels is one, too.
    void write(const std::string& path) const;

private:
    struct Item {
        enum class Kind : std::uint8_t { rectangle, line, text } kind;
        Vec2d a, b;
        Colour colour;
        double width;
        std::string words;
    };
    double width_, height_;
    Vec2d low_, high_;
    std::vector<Item> items_;
};

/// Rows from the top, `channels` of 8 bits (1: grey, 3: sRGB), replaced in one step. Throws Error (file).
void write_png_bytes(const std::string& path, int columns, int rows, int channels, const std::vector<std::uint8_t>& bytes);

}  // namespace hoodoo
