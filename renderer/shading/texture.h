// An image as a function of the plane: periodic, without visible repetition, filtered by the footprint of the lookup.
#pragma once

#include "terrain/error.h"
#include "terrain/math/vec.h"

#include <memory>
#include <string>

namespace hoodoo
{

/// What the numbers of the file mean before anything averages them.
enum class TextureEncoding : std::uint8_t {
    linear,  ///< as they are
    srgb,    ///< the sRGB curve is undone before filtering; the primaries stay those of the file
};

struct TextureOptions {
    TextureEncoding encoding = TextureEncoding::linear;
    bool stochastic = true;  ///< break up the repetition (hex tiling); off: the plain periodic image
    std::uint64_t seed = 0;
};

/// Immutable, thread-safe; lookups neither throw nor touch the disk's errors: all that can be wrong with the file is found when it is opened.
class Texture
{
public:
    /// Throws Error (file) at `where`: absent, not EXR, TIFF, PNG, JPEG or HDR, more than 16384 pixels wide or high, claiming far more pixels than
    /// its bytes can hold, truncated, corrupt.
    Texture(const std::string& path, const TextureOptions& options, const Source& where);
    ~Texture();
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    /// The image averaged over a square of width `footprint` around `at`; both in repeats: (0, 0) to (1, 1) is the image, `at.y` upwards, so (0, 1)
    /// is its upper left corner. A grey image fills three channels.
    Vec3f lookup(const Vec2d& at, double footprint) const;

    /// The mean of the whole image.
    const Vec3f& mean() const { return mean_; }

private:
    struct Files;
    Vec3f filtered(const Vec2d& at, double footprint) const;

    std::unique_ptr<Files> files_;
    TextureOptions options_;
    Vec3f mean_{0.0f};
};

}  // namespace hoodoo
