// The whole program on one page: read, build, trace, develop, write.
#pragma once

#include "renderer/film/color.h"
#include "renderer/film/film.h"
#include "renderer/film/image.h"
#include "renderer/scene/scene.h"

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hoodoo
{

/// What the command line, Python and the C ABI may say beside the scene. Unset members come from the scene.
struct RenderOptions {
    std::optional<int> width, height, spp;
    std::optional<int> replicates;
    std::optional<PixelBounds> pixel_bounds;           ///< half-open, y downwards
    std::optional<std::array<double, 4>> crop_window;  ///< x0, x1, y0, y1 in [0, 1]
    std::optional<std::uint64_t> seed;
    int threads = 0;                            ///< 0: all the process may use
    int tile_size = 32;                         ///< pixels; never changes the picture
    bool lock_seed = false;                     ///< the same noise in every frame; else it differs by the frame's number
    bool quick = false;                         ///< a quarter of the width, of the height and of the samples
    bool pin_date = true;                       ///< DateTime in the header is fixed, so that equal pictures are equal files
    bool measurements = true;                   ///< renderTime and memory in the header: the one thing that differs from run to run
    const std::atomic<bool>* cancel = nullptr;  ///< set it to stop
    std::function<void(double fraction, const std::string& what)> progress;  ///< from any thread, one at a time
};

/// A scene that is ready, and what its colours mean.
struct LoadedScene {
    Description description;
    std::shared_ptr<const ColorConfig> color;  ///< chosen by: command line > scene > $OCIO > ours
    std::unique_ptr<Scene> scene;
    double build_seconds = 0.0;
};

/// Scene file -> scene. `text_or_path`: a path, or the text itself if `is_text`. An `editable` one takes edits later; rays are then a little slower.
/// `colorconfig`: a path; empty: the scene's, else $OCIO's, else ours.
/// Throws Error (scene, file, memory): everything that can be wrong with a scene, its display and view too, is found here, before the first ray.
LoadedScene load_scene(const std::string& text_or_path, bool is_text, const SceneOverrides& overrides = {}, int threads = 0,
                       const std::string& colorconfig = {}, std::function<void(double, const std::string&)> progress = {}, bool editable = false);

/// Size, window and samples of the picture that `options` ask of a scene; the materials are left out. Throws Error (scene) on a size that cannot be.
FilmLayout picture_layout(const Description& description, const RenderOptions& options);

/// What makes the picture that `options` ask of a scene this one and no other, in one line: scene hash, frame, seed, samples, size, window, version.
/// It stands in the header of EXR and PNG as hoodoo:picture.
std::string picture_key(const Description& description, const RenderOptions& options);

/// Whether the file is there, can be read to its end, and has that key. Never throws for what is wrong with the file.
bool is_rendered(const std::string& path, const std::string& key);

/// Scene -> picture with its metadata. Returns an empty image if cancelled. Throws Error (scene) on options that the picture cannot have.
Image render(const LoadedScene& loaded, const RenderOptions& options);

/// Picture -> file, by its ending: .exr (linear, all channels) or .png (through the scene's display, view and exposure). Atomic and verified.
/// Throws Error (scene) on another ending, Error (file).
void write_picture(const Image& image, const std::string& path, const LoadedScene& loaded);

/// Throws what write_picture would throw for the name alone, so that a wrong ending is found before an hour of light.
void check_picture_name(const std::string& path);

}  // namespace hoodoo
