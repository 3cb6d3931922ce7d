// Hills to the horizon from a sum of noise: the terrain that needs no data.
// GalinCourse, Musgrave1989; fields/elevation.h has the function and its bounds, height_surface.h the tracing. There is no grid and no mesh: rays
// meet the function itself, with as many octaves as a pixel resolves where they arrive. Missing: erosion; `convolution` has operators for that.
#include "terrain/fields/elevation.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/height_surface.h"
#include "terrain/surfaces/noise_parameters.h"
#include "terrain/surfaces/rows.h"

namespace hoodoo
{

namespace
{

Shape make_elevation(const Values& values, const BuildContext& context)
{
    ElevationShape shape = read_noise(values, "kind");
    const Vec3d origin = values.vec3("origin");
    shape.origin = {origin.x, origin.y};
    shape.height = origin.z + values.number("height");
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

}  // namespace

CatalogueEntry elevation_row()
{
    Schema schema{"elevation", "Hills and mountains without end: a sum of noise, traced as the function it is.", {}};
    schema.parameters = noise_parameters("kind", 10.0);
    schema.parameters.insert(
        schema.parameters.begin() + 1,
        {{.name = "origin",
          .type = ParameterType::vector,
          .doc = "Where the noise begins; moves the whole terrain.",
          .fallback = std::vector<double>{0, 0, 0},
          .unit = "m",
          .min_count = 3,
          .max_count = 3},
         {.name = "height", .type = ParameterType::length, .doc = "Mean height above the origin.", .fallback = 0.0, .unit = "m"}});
    schema.parameters.push_back({.name = "lod",
                                 .type = ParameterType::boolean,
                                 .doc = "Leaves out octaves that a pixel does not resolve, by the distance from the eye.",
                                 .fallback = true});
    for (Parameter& p : height_surface_parameters(200000.0)) schema.parameters.push_back(std::move(p));
    return {"elevation", "GalinCourse", std::move(schema), make_elevation};
}

}  // namespace hoodoo
