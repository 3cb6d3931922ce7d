// The header of a picture, one line a fact.
//
// Standard names: OpenEXR's list of attributes; colorInteropID and its values as the Color Interop Forum has them. Matrices are for row vectors, as
// OpenEXR stores them. Integers of 64 bits are texts, because no attribute holds them.
#include "renderer/provenance.h"

#include "renderer/build_info.h"
#include "terrain/io/georeference.h"
#include "terrain/isa.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <sys/resource.h>

namespace hoodoo
{

namespace
{

std::vector<float> numbers(const Imath::M44f& matrix)
{
    return {&matrix[0][0], &matrix[0][0] + 16};
}

std::string date(bool pinned)
{
    if (pinned) return "1970:01:01 00:00:00";
    return fmt::format("{:%Y:%m:%d %H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

/// Largest resident size of the process so far, in MB (1e6 bytes).
float peak_memory()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<float>(static_cast<double>(usage.ru_maxrss) * 1024e-6);
}

std::string variance_kind(const FilmLayout& layout)
{
    if (layout.replicates > 1) return fmt::format("between {} replicates", layout.replicates);
    return layout.samples < 2 * PixelSums::block_size ? "between samples" : "between blocks of 16 samples";
}

std::string object_names(const Scene& scene)
{
    std::string names;
    for (std::size_t i = 0; i < scene.objects().size(); ++i) names += fmt::format("{}{}={}", i ? ", " : "", i + 1, scene.objects()[i].name);
    return names;
}

std::string libraries()
{
    std::string text;
    for (const auto& [name, number] : library_versions()) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, number);
    return text;
}

void add_colors(const ColorConfig& color, std::map<std::string, Attribute>& facts)
{
    facts["hoodoo:renderingSpace"] = color.rendering_space();
    if (const std::string id = color.interop_id(); !id.empty()) facts["colorInteropID"] = id;
    if (const std::vector<float> xy = color.chromaticities(); !xy.empty()) {
        facts["chromaticities"] = xy;
        facts["adoptedNeutral"] = std::vector<float>{xy[6], xy[7]};
    }
}

/// Where on the earth terrains lie: hoodoo:crs, and hoodoo:worldToMap (from the world's x and y). Those that differ from the first have their name
/// behind the key.
void add_places(const Scene& scene, std::map<std::string, Attribute>& facts)
{
    GeoReference first;
    for (std::size_t k = 0; k < scene.shapes().size(); ++k) {
        const auto* surface = std::get_if<std::unique_ptr<Surface>>(&scene.shapes()[k]);
        const auto* placed = surface ? dynamic_cast<const Georeferenced*>(surface->get()) : nullptr;
        if (!placed || !placed->world_to_earth().known()) continue;
        const GeoReference place = placed->world_to_earth();
        if (first.known() && place.system == first.system && place.map == first.map) continue;
        const std::string behind = first.known() ? ":" + scene.objects()[k].name : "";
        if (!first.known()) first = place;
        facts["hoodoo:crs" + behind] = place.system;
        facts["hoodoo:worldToMap" + behind] = place.map_text();
    }
}

}  // namespace

std::map<std::string, Attribute> provenance(const LoadedScene& loaded, const RenderOptions& options, const Film& film, std::uint64_t seed,
                                            double render_seconds)
{
    const FilmLayout& layout = film.layout();
    const Description& scene = loaded.description;
    const Camera& camera = loaded.scene->camera();
    std::map<std::string, Attribute> facts;
    facts["Software"] = "Hoodoo " + version();
    facts["DateTime"] = date(options.pin_date);
    add_colors(*loaded.color, facts);
    facts["worldToCamera"] = numbers(camera.world_to_camera());
    facts["worldToNDC"] = numbers(camera.world_to_ndc(Vec2i(layout.width, layout.height)));
    facts["hoodoo:cameraConvention"] = std::string("x right, y up, z forward; Z is the distance along the view axis in metres, +inf on a miss");
    facts["hoodoo:version"] = version();
    facts["hoodoo:libraries"] = libraries();
    facts["hoodoo:processor"] = processor_name();
    facts["hoodoo:instructionSet"] = isa_name(selected_isa());
    facts["hoodoo:sceneHash"] = fmt::format("{:016x}", scene.hash);
    facts["hoodoo:picture"] = picture_key(scene, options);
    facts["hoodoo:seed"] = fmt::format("{}", seed);
    facts["hoodoo:spp"] = layout.samples;
    facts["hoodoo:frame"] = static_cast<int>(scene.frame);
    facts["hoodoo:lockedSeed"] = options.lock_seed ? 1 : 0;
    facts["hoodoo:fps"] = static_cast<float>(scene.film.number("fps"));
    facts["hoodoo:exposure"] = static_cast<float>(scene.film.number("exposure"));
    facts["hoodoo:replicates"] = layout.replicates;
    facts["hoodoo:maxDepth"] = static_cast<int>(scene.render.integer("max_depth"));
    facts["hoodoo:filter"] = scene.film.text("filter");
    facts["hoodoo:variance"] = variance_kind(layout);
    add_places(*loaded.scene, facts);
    facts["hoodoo:objects"] = object_names(*loaded.scene);
    facts["hoodoo:droppedSamples"] = fmt::format("{}", film.dropped_samples());
    if (const Vec2i pixel = film.first_dropped_pixel(); pixel.x >= 0) facts["hoodoo:firstDroppedPixel"] = fmt::format("{},{}", pixel.x, pixel.y);
    if (!loaded.scene->is_plain()) {
        facts["hoodoo:caustics"] =
            std::string("the sun by one refraction at a smooth surface to points in water; reflected and longer ones left out");
        facts["hoodoo:samplesAboveBound"] = fmt::format("{}", loaded.scene->media().samples_above_bound());
    }
    facts["hoodoo:refusedRays"] = fmt::format("{}", loaded.scene->tracer().refused_rays());
    if (options.measurements) {
        facts["hoodoo:renderTime"] = static_cast<float>(render_seconds);
        facts["hoodoo:buildTime"] = static_cast<float>(loaded.build_seconds);
        facts["hoodoo:memory"] = peak_memory();
    }
    return facts;
}

}  // namespace hoodoo
