// [[flow]] tables -> one Flow. Kinds and what they mean stand in terrain/fields/flow.h; here are their parameters.
#include "terrain/surfaces/flow_tables.h"

#include "terrain/error.h"
#include "terrain/math/hash.h"

#include <fmt/format.h>

namespace hoodoo
{

namespace
{

Parameter point(const std::string& name, const std::string& doc)
{
    return {.name = name,
            .type = ParameterType::vector,
            .doc = doc,
            .fallback = std::vector<double>{0, 0, 0},
            .unit = "m",
            .min_count = 3,
            .max_count = 3};
}

Parameter direction(const std::string& name, const std::string& doc, std::vector<double> fallback)
{
    return {.name = name, .type = ParameterType::vector, .doc = doc, .fallback = std::move(fallback), .min_count = 3, .max_count = 3};
}

Parameter metres(const std::string& name, const std::string& doc)
{
    return {.name = name, .type = ParameterType::length, .doc = doc, .required = true, .unit = "m", .minimum = 0, .above_minimum = true};
}

std::vector<Parameter> noise_parameters(bool sum)
{
    std::vector<Parameter> list{metres("wavelength", "Side of the noise's cells; of the first octave."),
                                point("origin", "A corner of the noise's lattice.")};
    if (!sum) return list;
    list.push_back(
        {.name = "octaves", .type = ParameterType::integer, .doc = "How many octaves.", .fallback = std::int64_t{1}, .minimum = 1, .maximum = 12});
    list.push_back({.name = "gain",
                    .type = ParameterType::number,
                    .doc = "Amplitude of each octave by that of the one before.",
                    .fallback = 0.4,
                    .minimum = 0,
                    .maximum = 1});
    return list;
}

/// What every kind accepts.
void add_shared(Schema& schema)
{
    const std::vector<Parameter> shared{
        {.name = "name", .type = ParameterType::text, .doc = "What its seed is hashed from; by default its number.", .fallback = std::string()},
        {.name = "strength", .type = ParameterType::number, .doc = "Factor of the velocity.", .fallback = 1.0},
        {.name = "drift",
         .type = ParameterType::vector,
         .doc = "How far the pattern moves while the intensity grows by one: a flow that depends on time.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "mask_min",
         .type = ParameterType::vector,
         .doc = "Lower corner of the box outside which the flow fades out.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "mask_max", .type = ParameterType::vector, .doc = "Upper corner of that box.", .unit = "m", .min_count = 3, .max_count = 3},
        {.name = "above", .type = ParameterType::length, .doc = "The flow fades out below this height.", .unit = "m"},
        {.name = "below", .type = ParameterType::length, .doc = "The flow fades out above this height.", .unit = "m"},
        {.name = "fade",
         .type = ParameterType::length,
         .doc = "Over how many metres.",
         .fallback = 1.0,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    schema.parameters.insert(schema.parameters.end(), shared.begin(), shared.end());
}

Vec3d unit_from(const Values& v, const std::string& name)
{
    const Vec3d d = v.vec3(name);
    if (!(d.length() > 0.0)) throw v.problem(name, "the direction of a flow", "a vector with a length");
    return d;
}

FlowPtr basic_flow(const Values& v, std::uint32_t seed, const std::optional<DetailView>& view)
{
    const std::string& kind = v.variant();
    if (kind == "rotation") return rotation_flow(v.vec3("centre"), unit_from(v, "axis"));
    if (kind == "vortex") return vortex_flow(v.vec3("centre"), unit_from(v, "axis"), v.number("radius"));
    if (kind == "bulge") return bulge_flow(v.vec3("centre"), v.number("radius"));
    if (kind == "shear") {
        const Vec3d normal = unit_from(v, "normal"), along = unit_from(v, "direction");
        if (!(normal.cross(along).length() > 1e-6 * normal.length() * along.length()))
            throw v.problem("direction", "a shear goes across its normal", "a direction that is not along `normal`");
        return shear_flow(v.vec3("centre"), normal, along);
    }
    const Vec3d origin = v.vec3("origin");
    const double wavelength = v.number("wavelength");
    if (kind == "noise") return noise_gradient_flow(origin, wavelength, seed, view);
    const int octaves = static_cast<int>(v.integer("octaves"));
    if (kind == "vertical") return vertical_flow(origin, wavelength, octaves, v.number("gain"), seed, view);
    return curl_flow(origin, wavelength, octaves, v.number("gain"), seed, view);
}

FlowPtr masked(const Values& v, FlowPtr flow)
{
    Box3d box(Vec3d(-kInfinity), Vec3d(kInfinity));
    if (v.has("mask_min")) box.min = v.vec3("mask_min");
    if (v.has("mask_max")) box.max = v.vec3("mask_max");
    if (v.has("above")) box.min.z = std::max(box.min.z, v.number("above"));
    if (v.has("below")) box.max.z = std::min(box.max.z, v.number("below"));
    if (!v.has("mask_min") && !v.has("mask_max") && !v.has("above") && !v.has("below")) return flow;
    for (int k = 0; k < 3; ++k)
        if (!(box.min[k] < box.max[k])) throw v.problem(v.has("mask_max") ? "mask_max" : "fade", "the mask of a flow is empty", "min below max");
    return masked_flow(std::move(flow), box, v.number("fade"));
}

}  // namespace

std::vector<Schema> flow_schemas()
{
    const Parameter centre = point("centre", "Its centre."), axis = direction("axis", "Its axis, right-handed.", {0, 0, 1});
    std::vector<Schema> list{
        {"rotation", "Everything turns about an axis, one radian a unit of intensity.", {centre, axis}},
        {"vortex",
         "Turns about an axis, slower with the distance from it: exp(-(r / radius)^2).",
         {centre, axis, metres("radius", "Where it is slower by e.")}},
        {"bulge", "Outwards from a centre, by the distance times 1 - (r / radius)^2.", {centre, metres("radius", "Beyond it there is no flow.")}},
        {"shear",
         "Along a direction, by the height above a plane.",
         {centre, direction("normal", "Of the plane.", {0, 0, 1}), direction("direction", "Made perpendicular to the normal.", {1, 0, 0})}},
        {"vertical", "Up and down by a sum of noise: a height field of a plane.", noise_parameters(true)},
        {"noise", "Along the gradient of a noise of x and y: walls that are its contour lines move at right angles to themselves.",
         noise_parameters(false)},
        {"curl", "The curl of three sums of 3-D noise: swirls that keep volumes.", noise_parameters(true)},
    };
    for (Schema& schema : list) add_shared(schema);
    return list;
}

FlowPtr make_flow(const std::vector<Values>& tables, std::uint64_t seed, const std::optional<DetailView>& view, double longest)
{
    std::vector<FlowPtr> flows;
    for (std::size_t k = 0; k < tables.size(); ++k) {
        const Values& v = tables[k];
        const std::string name = v.text("name").empty() ? fmt::format("flow {}", k) : v.text("name");
        // A pattern that drifts takes its distances along.
        std::optional<DetailView> own = view;
        if (own && v.has("drift")) own->slack += v.vec3("drift").length() * longest;
        FlowPtr flow = basic_flow(v, static_cast<std::uint32_t>(hash_name(seed, name) >> 32), own);
        if (v.number("strength") != 1.0) flow = scaled_flow(std::move(flow), v.number("strength"));
        if (v.has("drift")) flow = drifting_flow(std::move(flow), v.vec3("drift"));
        flows.push_back(masked(v, std::move(flow)));
    }
    return sum_flow(std::move(flows));
}

}  // namespace hoodoo
