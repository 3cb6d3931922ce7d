// Tables -> media. Haze takes its wavelengths from the sky's own: extinction goes as wavelength^-angstrom_exponent (Angstrom1929) on sunlight, and
// each channel gets the rate at which it dims while kProbe of the optical depth at 550 nm is passed. A material is a body that light passes if its
// table has `ior`, or if it looks like water and its table gives it no colour and no film of its own.
#include "renderer/scene/media.h"

#include "renderer/light/spectrum.h"
#include "renderer/media/mist.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hoodoo
{
namespace
{

using T = ParameterType;

constexpr double kWaterIor = 1.333;  // Hale1973, the middle of the visible, 20 degrees
constexpr double kProbe = 0.5;

/// Bubbles and droplets absorb next to nothing and scatter forward, with a mean cosine of 0.85; without the peak that goes straight on (Joseph1976)
/// 0.46. CHOICE of the extinction: a few decimetres of the densest foam hide what is behind them.
constexpr double kFoamExtinction = 6.0, kFoamAlbedo = 0.999, kFoamAsymmetry = 0.46;

Parameter extinction_parameter(const Default& fallback)
{
    return {.name = "extinction",
            .type = T::number,
            .doc = "At full density. The mean free path is one over it.",
            .fallback = fallback,
            .required = std::holds_alternative<std::monostate>(fallback),
            .unit = "1/m",
            .minimum = 0.0};
}

Parameter albedo_parameter()
{
    return {.name = "albedo",
            .type = T::color,
            .doc = "Share of a collision that scatters.",
            .fallback = ColorValue{Vec3d(kFoamAlbedo), "acescg"},
            .minimum = 0.0,
            .maximum = 1.0};
}

Parameter asymmetry_parameter(const Default& fallback)
{
    return {.name = "asymmetry", .type = T::number, .doc = "Mean cosine of scattering.", .fallback = fallback, .minimum = -0.99, .maximum = 0.99};
}

std::vector<Schema> make_schemas()
{
    const std::vector<std::string> waters = water_names();
    return {
        {"homogeneous",
         "An even medium, for the inside of a body: a material names it.",
         {{.name = "preset", .type = T::choice, .doc = "Water to start from; without it: nothing.", .choices = waters},
          {.name = "absorption", .type = T::color, .doc = "Replaces the preset's. Not in srgb.", .unit = "1/m", .minimum = 0.0},
          {.name = "scattering", .type = T::color, .doc = "Replaces the preset's. Not in srgb.", .unit = "1/m", .minimum = 0.0},
          asymmetry_parameter({})}},
        {"mist",
         "A box of mist, even or in puffs.",
         {{.name = "min", .type = T::vector, .doc = "A corner.", .required = true, .unit = "m", .min_count = 3, .max_count = 3},
          {.name = "max", .type = T::vector, .doc = "The opposite corner.", .required = true, .unit = "m", .min_count = 3, .max_count = 3},
          extinction_parameter({}),
          albedo_parameter(),
          asymmetry_parameter(kFoamAsymmetry),
          {.name = "fade", .type = T::length, .doc = "It thins out over this distance from the faces.", .fallback = 0.0, .unit = "m", .minimum = 0.0},
          {.name = "wavelength", .type = T::length, .doc = "Of the largest puffs; 0: an even mist.", .fallback = 0.0, .unit = "m", .minimum = 0.0},
          {.name = "octaves", .type = T::number, .doc = "Of the puffs, each half as large.", .fallback = 4.0, .minimum = 1.0, .maximum = 12.0},
          {.name = "cover",
           .type = T::number,
           .doc = "Of the noise that makes puffs, the share that is mist.",
           .fallback = 0.5,
           .minimum = 0.0,
           .maximum = 1.0},
          {.name = "softness",
           .type = T::number,
           .doc = "Of a puff's edge, as a share of the noise.",
           .fallback = 0.2,
           .minimum = 0.0,
           .maximum = 2.0,
           .above_minimum = true}}},
        {"carried",
         "What foam and spray are made of that a terrain carries.",
         {{.name = "terrain", .type = T::text, .doc = "The terrain that carries it.", .required = true},
          extinction_parameter(kFoamExtinction),
          albedo_parameter(),
          asymmetry_parameter(kFoamAsymmetry)}},
    };
}

Vec3d converted(const ColorConversion& convert, const ColorValue& color)
{
    return convert ? Vec3d(convert(color)) : color.rgb;
}

RegionMaterial region_material(const Values& values, const ColorConversion& to_rendering)
{
    const Vec3d albedo = converted(to_rendering, values.color("albedo"));
    RegionMaterial made;
    made.extinction = values.number("extinction");
    for (int k = 0; k < 3; ++k) made.albedo[k] = static_cast<float>(std::clamp(albedo[k], 0.0, 1.0));
    made.asymmetry = values.number("asymmetry");
    return made;
}

const ColorValue& linear(const Values& values, const std::string& name)
{
    const ColorValue& color = values.color(name);
    if (color.space == "srgb") throw values.problem(name, name + " is a rate, not a colour to look at", "acescg, lin_rec709 or grey", "srgb");
    return color;
}

Coefficients homogeneous(const Values& values, const ColorConversion& to_rendering)
{
    Coefficients made;
    if (values.has("preset")) made = water_coefficients(values.text("preset"), to_rendering);
    if (values.has("absorption")) made.absorption = converted_absorption(linear(values, "absorption"), to_rendering);
    if (values.has("scattering")) made.scattering = converted(to_rendering, linear(values, "scattering"));
    for (int k = 0; k < 3; ++k) made.scattering[k] = std::max(0.0, made.scattering[k]);
    if (values.has("asymmetry")) made.asymmetry = values.number("asymmetry");
    return made;
}

std::shared_ptr<const Density> mist(const DescribedNode& node)
{
    const Values& v = node.values;
    const Vec3d a = v.vec3("min"), b = v.vec3("max");
    if (!(a.x < b.x && a.y < b.y && a.z < b.z))
        throw v.problem("max", "the corners of the mist are no box", fmt::format("each above {}, {}, {}", a.x, a.y, a.z),
                        fmt::format("{}, {}, {}", b.x, b.y, b.z));
    Puffs puffs;
    puffs.wavelength = v.number("wavelength");
    puffs.octaves = v.number("octaves");
    puffs.cover = v.number("cover");
    puffs.softness = v.number("softness");
    puffs.seed = static_cast<std::uint32_t>(node.seed);
    return std::make_shared<Mist>(Box3d(a, b), v.number("fade"), puffs);
}

/// Each channel's extinction over that at 550 nm.
Vec3d relative_extinction(double exponent, const ColorConversion& to_rendering)
{
    Spectrum sun{}, dimmed{};
    for (int i = 0; i < kWavelengths; ++i) {
        sun[static_cast<std::size_t>(i)] = solar_irradiance(wavelength(i));
        dimmed[static_cast<std::size_t>(i)] = sun[static_cast<std::size_t>(i)] * std::exp(-kProbe * std::pow(wavelength(i) / 550.0, -exponent));
    }
    const Vec3d before = converted(to_rendering, {to_acescg(sun), "acescg"}), after = converted(to_rendering, {to_acescg(dimmed), "acescg"});
    Vec3d relative;
    for (int k = 0; k < 3; ++k) relative[k] = -std::log(after[k] / before[k]) / kProbe;
    return relative;
}

Haze make_haze(const Values& values, const ColorConversion& to_rendering)
{
    const Vec3d extinction =
        relative_extinction(values.number("angstrom_exponent"), to_rendering) * extinction_of_visibility(values.number("visibility"));
    Vec3d albedo = converted(to_rendering, values.color("albedo"));
    for (int k = 0; k < 3; ++k) albedo[k] = std::clamp(albedo[k], 0.0, 1.0);
    Coefficients made;
    made.scattering = extinction * albedo;
    made.absorption = extinction - made.scattering;
    made.asymmetry = values.number("asymmetry");
    return Haze(made, values.number("base"), values.number("height"));
}

std::shared_ptr<const Density> lent(const Density* density)
{
    return std::shared_ptr<const Density>(std::shared_ptr<const Density>(), density);
}

std::vector<std::string> names_of(std::span<const DensityCarrier> carriers)
{
    std::vector<std::string> names;
    for (const DensityCarrier& c : carriers) names.push_back(c.name);
    return names;
}

/// The even medium of that name: a table's, or a water.
Coefficients medium_named(const Description& description, const Values& material, const ColorConversion& to_rendering)
{
    const std::string& name = material.text("medium");
    std::vector<std::string> names = water_names();
    const bool water = std::find(names.begin(), names.end(), name) != names.end();
    for (const DescribedNode& node : description.media) {
        if (node.name == name && node.type != "homogeneous")
            throw material.problem("medium", "a body is filled evenly", "a medium of type \"homogeneous\"",
                                   fmt::format("\"{}\" of type \"{}\"", name, node.type));
        if (node.name == name) return homogeneous(node.values, to_rendering);
        if (node.type == "homogeneous") names.push_back(node.name);
    }
    if (water) return water_coefficients(name, to_rendering);
    throw material.problem("medium", "there is no medium of this name", fmt::format("one of {}", fmt::join(names, ", ")), "\"" + name + "\"");
}

}  // namespace

std::span<const Schema> medium_schemas()
{
    static const std::vector<Schema> schemas = make_schemas();
    return schemas;
}

double haze_depth(const Values& haze)
{
    return haze.has("visibility") ? extinction_of_visibility(haze.number("visibility")) * haze.number("height") : 0.0;
}

Media make_media(const Description& description, std::span<const DensityCarrier> carriers, const ColorConversion& to_rendering)
{
    Media media;
    if (description.haze.has("visibility")) media.haze.emplace(make_haze(description.haze, to_rendering));

    std::vector<bool> told(carriers.size());
    for (const DescribedNode& node : description.media) {
        if (node.type == "mist") media.regions.emplace_back(mist(node), region_material(node.values, to_rendering));
        if (node.type != "carried") continue;
        const std::string& name = node.values.text("terrain");
        const auto carrier = std::find_if(carriers.begin(), carriers.end(), [&](const DensityCarrier& c) { return c.name == name; });
        if (carrier == carriers.end())
            throw node.values.problem("terrain", "there is no terrain of this name in the picture",
                                      fmt::format("one of {}", fmt::join(names_of(carriers), ", ")), "\"" + name + "\"");
        if (!carrier->surface || !carrier->surface->density())
            throw node.values.problem("terrain", fmt::format("the terrain \"{}\" carries no foam or spray", name), "one that does");
        told[static_cast<std::size_t>(carrier - carriers.begin())] = true;
        media.regions.emplace_back(lent(carrier->surface->density()), region_material(node.values, to_rendering));
    }

    // What a terrain carries and no table describes is foam.
    const RegionMaterial foam{kFoamExtinction, Vec3f(static_cast<float>(kFoamAlbedo)), kFoamAsymmetry};
    for (std::size_t i = 0; i < carriers.size(); ++i)
        if (!told[i] && carriers[i].surface && carriers[i].surface->density()) media.regions.emplace_back(lent(carriers[i].surface->density()), foam);
    return media;
}

std::map<std::string, Interior> make_interiors(const Description& description, const ColorConversion& to_rendering)
{
    std::map<std::string, Interior> made;
    for (const DescribedNode& node : description.materials) {
        const Values& v = node.values;
        const bool opaque = v.has("albedo") || v.has("albedo_texture") || v.has("coat");
        const bool water = (v.has("procedural") ? v.text("procedural") : node.name) == "water" && !opaque;
        if (v.has("ior") && opaque)
            throw v.problem("ior", "light passes this material, so it has no colour and no film of its own", "either ior, or albedo and coat");
        if (!v.has("ior") && !water) {
            if (v.has("medium"))
                throw v.problem("medium", "no light gets into this material", "ior beside it, or the look of water without albedo and coat");
            continue;
        }
        Interior body;
        body.ior = v.has("ior") ? v.number("ior") : kWaterIor;
        body.smooth = !(v.has("roughness") && v.number("roughness") > 0.0) && !v.has("roughness_texture");
        if (v.has("medium"))
            body.medium = medium_named(description, v, to_rendering);
        else if (water)
            body.medium = water_coefficients("clear", to_rendering);
        made[node.name] = body;
    }
    return made;
}

std::optional<Interior> default_interior(const std::string& material, const ColorConversion& to_rendering)
{
    if (material != "water") return std::nullopt;
    Interior body;
    body.ior = kWaterIor;
    body.medium = water_coefficients("clear", to_rendering);
    return body;
}

}  // namespace hoodoo
