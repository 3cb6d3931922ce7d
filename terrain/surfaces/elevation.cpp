// Hills to the horizon from a sum of noise: the terrain that needs no data.
// GalinCourse, Musgrave1989; fields/elevation.h has the function and its bounds, height_surface.h the tracing. There is no grid and no mesh: rays
// meet the function itself, with as many octaves as a pixel resolves where they arrive. Missing: erosion; `convolution` has operators for that.
#include "terrain/fields/elevation.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/height_surface.h"
#include "terrain/surfaces/rows.h"

namespace hoodoo
{

namespace
{

Shape make_elevation(const Values& values, const BuildContext& context)
{
    ElevationShape shape;
    const std::string& kind = values.text("kind");
    shape.kind = kind == "ridged"         ? ElevationKind::ridged
                 : kind == "billow"       ? ElevationKind::billow
                 : kind == "multifractal" ? ElevationKind::multifractal
                                          : ElevationKind::fbm;
    const Vec3d origin = values.vec3("origin");
    shape.origin = {origin.x, origin.y};
    shape.height = origin.z + values.number("height");
    shape.relief = values.number("relief");
    shape.wavelength = values.number("wavelength");
    shape.fractal = {values.number("octaves"), values.number("lacunarity"), values.number("gain")};
    shape.seed = static_cast<std::uint32_t>(hash_name(context.seed, "elevation") >> 32);
    const Viewpoint* view = context.view ? &*context.view : nullptr;
    if (values.boolean("lod") && view && view->spread > 0.0) {
        // Nearer than the ground below can be, all octaves are there anyway.
        shape.limit = OctaveLimit{view->eye, view->spread, std::max(1.0, std::abs(view->eye.z - shape.height) - shape.relief)};
    }
    HeightSurfaceSettings settings = read_height_surface(values, view, shape.origin, shape.wavelength / 100.0);
    settings.texture = shape.wavelength;
    return make_height_surface(std::make_unique<ElevationHeight>(shape), settings);
}

Parameter plain_number(const std::string& name, double fallback, double least, double most, const std::string& doc)
{
    return {.name = name, .type = ParameterType::number, .doc = doc, .fallback = fallback, .minimum = least, .maximum = most};
}

}  // namespace

CatalogueEntry elevation_row()
{
    Schema schema{"elevation", "Hills and mountains without end: a sum of noise, traced as the function it is.", {}};
    schema.parameters = {
        {.name = "kind",
         .type = ParameterType::choice,
         .doc = "Even hills, creased crests, round domes, or plains that rise to rugged heights.",
         .fallback = std::string("fbm"),
         .choices = {"fbm", "ridged", "billow", "multifractal"}},
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "Where the noise begins; moves the whole terrain.",
         .fallback = std::vector<double>{0, 0, 0},
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "height", .type = ParameterType::length, .doc = "Mean height above the origin.", .fallback = 0.0, .unit = "m"},
        {.name = "relief",
         .type = ParameterType::length,
         .doc = "How far all octaves together could rise above the mean or fall below it.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "wavelength",
         .type = ParameterType::length,
         .doc = "Size of the largest hills.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        plain_number("octaves", 10.0, 1.0, 24.0, "How many sizes of hills."),
        plain_number("lacunarity", 2.0, 1.1, 8.0, "How much finer each is than the last."),
        plain_number("gain", 0.5, 0.05, 0.95, "How high each is against the last."),
        {.name = "lod",
         .type = ParameterType::boolean,
         .doc = "Leaves out octaves that a pixel does not resolve, by the distance from the eye.",
         .fallback = true},
    };
    for (Parameter& p : height_surface_parameters(200000.0)) schema.parameters.push_back(std::move(p));
    return {"elevation", "GalinCourse", std::move(schema), make_elevation};
}

}  // namespace hoodoo
