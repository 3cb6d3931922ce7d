// Colour management: one configuration answers what a colour in a file means, in which space light is added, and how it looks on a screen.
//
// The scene format's colour words (acescg, lin_rec709, srgb) are defined by the built-in configuration. Under another one they are carried over
// through ACES 2065-1, the space by which OpenColorIO configurations meet (role aces_interchange, or a space of one of its usual names). The
// primaries written into EXR headers are computed, not assumed: the rendering space's red, green, blue and white through ACES 2065-1 to XYZ, with the
// primaries and white point of SMPTE ST 2065-1.
//
// Missing: looks; a limit on which look-up tables a configuration named by a scene may open.
#include "renderer/film/color.h"

#include "builtin_config_ocio.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <sstream>

namespace OCIO = OCIO_NAMESPACE;

namespace hoodoo
{

namespace
{

void convert(const OCIO::ConstCPUProcessorRcPtr& processor, std::span<Vec3f> colours)
{
    if (colours.empty()) return;
    OCIO::PackedImageDesc pixels(colours.data(), static_cast<long>(colours.size()), 1, 3);
    processor->apply(pixels);
}

OCIO::ConstConfigRcPtr parse_built_in()
{
    std::istringstream text(builtin_config_ocio);
    return OCIO::Config::CreateFromStream(text);
}

/// The scene format's words -> spaces of the built-in configuration; other names unchanged.
std::string built_in_name(const std::string& word)
{
    if (word == "acescg") return "ACEScg";
    if (word == "srgb") return "sRGB - Texture";
    return word;  // lin_rec709 is an alias there
}

std::string find_interchange(const OCIO::Config& config)
{
    for (const char* name : {"aces_interchange", "ACES2065-1", "lin_ap0", "Linear ACES", "ACES - ACES2065-1", "aces"})
        if (config.getColorSpace(name)) return name;
    return {};
}

std::vector<std::string> displays_of(const OCIO::Config& config)
{
    std::vector<std::string> names;
    for (int i = 0; i < config.getNumDisplays(); ++i) names.emplace_back(config.getDisplay(i));
    return names;
}

std::vector<std::string> views_of(const OCIO::Config& config, const std::string& display)
{
    std::vector<std::string> names;
    for (int i = 0; i < config.getNumViews(display.c_str()); ++i) names.emplace_back(config.getView(display.c_str(), i));
    return names;
}

/// `name`, or `fallback` if it is empty; an error if it is none of `names`.
std::string chosen(const char* what, const std::string& name, const char* fallback, const std::vector<std::string>& names, const Source& where)
{
    if (name.empty()) return fallback;
    if (std::find(names.begin(), names.end(), name) != names.end()) return name;
    throw Error(ErrorKind::scene,
                Problem{where, fmt::format("the colour configuration has no such {}", what), fmt::format("one of \"{}\"", fmt::join(names, "\", \"")),
                        fmt::format("\"{}\"", name), nearest_name(name, names)});
}

/// CIE xy of a colour given in ACES 2065-1. The matrix has the primaries' XYZ as columns; SMPTE ST 2065-1: R (0.7347, 0.2653), G (0, 1),
/// B (0.0001, -0.077), white (0.32168, 0.33767).
std::array<double, 2> chromaticity(const Vec3f& ap0)
{
    const double X = 0.9525523959 * ap0.x + 0.0 * ap0.y + 0.0000936786 * ap0.z;
    const double Y = 0.3439664498 * ap0.x + 0.7281660966 * ap0.y - 0.0721325464 * ap0.z;
    const double Z = 0.0 * ap0.x + 0.0 * ap0.y + 1.0088251844 * ap0.z;
    const double sum = X + Y + Z;
    return {X / sum, Y / sum};
}

}  // namespace

struct ColorConfig::Implementation {
    OCIO::ConstConfigRcPtr config, built_in;
    std::string rendering;     // name of the space
    std::string interchange;   // name of ACES 2065-1 in `config`, or empty
    mutable std::mutex mutex;  // guards the cache
    mutable std::map<std::string, OCIO::ConstCPUProcessorRcPtr> cache;

    OCIO::ConstProcessorRcPtr make(const std::string& space) const;
    OCIO::ConstCPUProcessorRcPtr processor(const std::string& space) const;
    std::vector<std::string> names() const;
};

std::vector<std::string> ColorConfig::Implementation::names() const
{
    std::vector<std::string> names = {"acescg", "lin_rec709", "srgb"};
    for (int i = 0; i < config->getNumColorSpaces(); ++i) names.emplace_back(config->getColorSpaceNameByIndex(i));
    return names;
}

OCIO::ConstProcessorRcPtr ColorConfig::Implementation::make(const std::string& space) const
{
    const bool word = space == "acescg" || space == "lin_rec709" || space == "srgb";
    if (!word && config->getColorSpace(space.c_str())) return config->getProcessor(space.c_str(), rendering.c_str());
    const std::string name = built_in_name(space);
    if (!built_in->getColorSpace(name.c_str()))
        throw Error(ErrorKind::scene, Problem{{},
                                              "the colour configuration has no such colour space",
                                              fmt::format("one of \"{}\"", fmt::join(names(), "\", \"")),
                                              fmt::format("\"{}\"", space),
                                              nearest_name(space, names())});
    if (config == built_in) return config->getProcessor(name.c_str(), rendering.c_str());
    if (interchange.empty())
        throw Error(ErrorKind::scene, Problem{{},
                                              fmt::format("the colour configuration cannot be told what \"{}\" is", space),
                                              "a configuration with the role aces_interchange or a colour space ACES2065-1",
                                              {},
                                              {}});
    return OCIO::Config::GetProcessorFromConfigs(built_in, name.c_str(), "aces_interchange", config, rendering.c_str(), interchange.c_str());
}

OCIO::ConstCPUProcessorRcPtr ColorConfig::Implementation::processor(const std::string& space) const
{
    const std::scoped_lock lock(mutex);
    OCIO::ConstCPUProcessorRcPtr& cached = cache[space];
    if (!cached) cached = make(space)->getDefaultCPUProcessor();
    return cached;
}

ColorConfig::ColorConfig(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation))
{
    Implementation& i = *implementation_;
    for (const char* role : {"rendering", "scene_linear"})
        if (i.rendering.empty() && i.config->hasRole(role)) i.rendering = i.config->getColorSpace(role)->getName();
    if (i.rendering.empty())
        throw Error(
            ErrorKind::file,
            Problem{{}, "the colour configuration does not say in which space light is computed", "a role rendering or scene_linear", {}, {}});
    i.interchange = find_interchange(*i.config);
}

ColorConfig::~ColorConfig() = default;

std::shared_ptr<const ColorConfig> ColorConfig::built_in()
{
    auto implementation = std::make_unique<Implementation>();
    implementation->config = implementation->built_in = parse_built_in();
    return std::shared_ptr<const ColorConfig>(new ColorConfig(std::move(implementation)));
}

std::shared_ptr<const ColorConfig> ColorConfig::open(const std::string& path)
{
    auto implementation = std::make_unique<Implementation>();
    implementation->built_in = parse_built_in();
    try {
        implementation->config = OCIO::Config::CreateFromFile(path.c_str());
        implementation->config->validate();
    } catch (const OCIO::Exception& failure) {
        throw Error(
            ErrorKind::file,
            Problem{
                {}, fmt::format("the colour configuration \"{}\" cannot be read", path), "a valid OpenColorIO configuration", failure.what(), {}});
    }
    return std::shared_ptr<const ColorConfig>(new ColorConfig(std::move(implementation)));
}

std::shared_ptr<const ColorConfig> ColorConfig::choose(const std::string& command_line, const std::string& scene)
{
    if (!command_line.empty()) return open(command_line);
    if (!scene.empty()) return open(scene);
    const char* environment = std::getenv("OCIO");
    if (environment && *environment) return open(environment);
    return built_in();
}

Vec3f ColorConfig::to_rendering(const std::string& space, const Vec3f& rgb) const
{
    Vec3f converted = rgb;
    convert(implementation_->processor(space), {&converted, 1});
    return converted;
}

ColorTransform ColorConfig::to_rendering(const std::string& space) const
{
    return [processor = implementation_->processor(space)](std::span<Vec3f> colours) { convert(processor, colours); };
}

bool ColorConfig::knows(const std::string& space) const
{
    const Implementation& i = *implementation_;
    return i.config->getColorSpace(space.c_str()) || (i.built_in->getColorSpace(built_in_name(space).c_str()) && !i.interchange.empty());
}

ColorTransform ColorConfig::to_display(const std::string& display, const std::string& view, const Source& where) const
{
    const OCIO::Config& config = *implementation_->config;
    const std::string on = chosen("display", display, config.getDefaultDisplay(), displays_of(config), where);
    const std::string as = chosen("view", view, config.getDefaultView(on.c_str()), views_of(config, on), where);
    const OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(implementation_->rendering.c_str());
    transform->setDisplay(on.c_str());
    transform->setView(as.c_str());
    try {
        return [processor = config.getProcessor(transform)->getDefaultCPUProcessor()](std::span<Vec3f> colours) { convert(processor, colours); };
    } catch (const OCIO::Exception& failure) {
        throw Error(ErrorKind::file,
                    Problem{where, fmt::format("the view \"{}\" of the display \"{}\" cannot be used", as, on), {}, failure.what(), {}});
    }
}

std::string ColorConfig::display_name(const std::string& display) const
{
    return display.empty() ? implementation_->config->getDefaultDisplay() : display;
}

std::string ColorConfig::rendering_space() const
{
    return implementation_->rendering;
}

std::vector<float> ColorConfig::chromaticities() const
{
    const Implementation& i = *implementation_;
    if (i.interchange.empty()) return {};
    std::array<Vec3f, 4> colours = {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(1, 1, 1)};
    convert(i.config->getProcessor(i.rendering.c_str(), i.interchange.c_str())->getDefaultCPUProcessor(), colours);
    std::vector<float> xy;
    for (const Vec3f& colour : colours)
        for (const double coordinate : chromaticity(colour))
            xy.push_back(static_cast<float>(std::round(coordinate * 1e5) * 1e-5));  // five decimals, as the standards print them
    return xy;
}

std::string ColorConfig::interop_id() const
{
    struct Known {
        const char* id;
        std::array<float, 6> primaries;
    };
    static constexpr std::array<Known, 3> known = {{{"lin_ap1_scene", {0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f}},
                                                    {"lin_ap0_scene", {0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.077f}},
                                                    {"lin_rec709_scene", {0.640f, 0.330f, 0.300f, 0.600f, 0.150f, 0.060f}}}};
    const std::vector<float> xy = chromaticities();
    for (const Known& space : known) {
        bool same = !xy.empty();
        for (std::size_t i = 0; same && i < space.primaries.size(); ++i) same = std::abs(xy[i] - space.primaries[i]) < 2e-4f;
        if (same) return space.id;
    }
    return {};
}

}  // namespace hoodoo
