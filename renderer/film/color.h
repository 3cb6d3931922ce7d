// Colours between the spaces that files name, the space light is computed in, and the screen. OpenColorIO does it; nobody else includes it.
#pragma once

#include "terrain/error.h"
#include "terrain/math/vec.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// Converts colours in place.
using ColorTransform = std::function<void(std::span<Vec3f>)>;

/// A colour configuration. Light is computed in its role `rendering` (or `scene_linear`, where it has no such role). Immutable, thread-safe.
class ColorConfig
{
public:
    /// The configuration built into the library: ACES views, rendering in ACEScg. It needs no file.
    static std::shared_ptr<const ColorConfig> built_in();
    /// From a file. Throws Error (file) if it cannot be read, or if it has no rendering space.
    static std::shared_ptr<const ColorConfig> open(const std::string& path);
    /// The first that is not empty of: the command line's, the scene's, the environment variable OCIO; else the built-in one.
    static std::shared_ptr<const ColorConfig> choose(const std::string& command_line, const std::string& scene);
    ~ColorConfig();

    /// Linear colour in `space` -> rendering space. `space` is one of the scene format's words (acescg, lin_rec709, srgb), which mean the same under
    /// every configuration; or a colour space, alias or role of this configuration; or one of the built-in configuration. Data spaces are left as
    /// they are. Throws Error (scene) on an unknown name, and where this configuration has no ACES 2065-1 space to go through.
    Vec3f to_rendering(const std::string& space, const Vec3f& rgb) const;
    /// The same, to be kept and called many times.
    ColorTransform to_rendering(const std::string& space) const;
    bool knows(const std::string& space) const;

    /// Rendering space -> values of a screen, nominally in [0, 1] and not clamped. Empty names: the configuration's defaults. Throws Error (scene),
    /// standing at `where`, on a name the configuration does not have.
    ColorTransform to_display(const std::string& display, const std::string& view, const Source& where = {}) const;

    /// `display`, or the configuration's default if it is empty.
    std::string display_name(const std::string& display) const;

    /// Name of the rendering space in this configuration.
    std::string rendering_space() const;
    /// CIE xy of red, green, blue and white of the rendering space, as in an EXR header; empty if the configuration has no ACES 2065-1 space.
    std::vector<float> chromaticities() const;
    /// The name under which other programs know the rendering space (Color Interop Forum): "lin_ap1_scene", "lin_ap0_scene", "lin_rec709_scene"; or
    /// empty.
    std::string interop_id() const;

private:
    struct Implementation;
    explicit ColorConfig(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace hoodoo
