// A picture in memory: named float channels in a data window inside a display window, and what is written in its header.
#pragma once

#include "terrain/math/vec.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hoodoo
{

/// Half-open pixel rectangle, y downwards, row 0 on top.
struct PixelBounds {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
};

/// One plane of pixels, row by row from the top of the data window.
struct Channel {
    std::string name;  ///< as in the EXR: "R", "N.X", "variance.G"
    std::vector<float> pixels;
};

using Attribute = std::variant<int, float, std::string, std::vector<float>>;  ///< 16 floats: a matrix; 8 floats: chromaticities

struct Image {
    int width = 0, height = 0;  ///< display window
    PixelBounds data;
    std::vector<Channel> channels;
    std::map<std::string, Attribute> metadata;

    const Channel* find(const std::string& name) const
    {
        for (const Channel& c : channels)
            if (c.name == name) return &c;
        return nullptr;
    }
};

}  // namespace hoodoo
