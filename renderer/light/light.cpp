// Lights of a scene file: the sun, the clear sky with its sun, and a sky of one radiance.
//
// A disc of angular radius a and irradiance E on a facing plane has the radiance E / (pi sin^2 a): integral of cos over the cone of half-angle a.
// It is sampled evenly over its solid angle 2 pi (1 - cos a), written 4 pi sin^2(a / 2), which keeps its digits for small a.
// Missing: limb darkening, the moon, light maps.

#include "renderer/light/light.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

Parameter elevation_parameter()
{
    return {.name = "elevation",
            .type = ParameterType::angle,
            .doc = "Height of the sun above the horizon.",
            .fallback = 0.7853981633974483,
            .minimum = -0.5 * kPi,
            .maximum = 0.5 * kPi};
}
Parameter azimuth_parameter()
{
    return {.name = "azimuth",
            .type = ParameterType::angle,
            .doc = "Direction of the sun: from north (+y) over east (+x).",
            .fallback = 2.356194490192345};
}
Parameter aerosol_parameter()
{
    return {.name = "aerosol",
            .type = ParameterType::number,
            .doc = "Vertical optical depth of haze at 550 nm: 0.05 mountain air, 0.1 clear, 0.3 hazy.",
            .fallback = 0.1,
            .minimum = 0.0,
            .maximum = 2.0};
}
Parameter altitude_parameter()
{
    return {.name = "altitude",
            .type = ParameterType::length,
            .doc = "Height of the scene above sea level.",
            .fallback = 0.0,
            .unit = "m",
            .minimum = 0.0,
            .maximum = 9000.0};
}
Parameter diameter_parameter()
{
    return {.name = "diameter",
            .type = ParameterType::angle,
            .doc = "Angular diameter of a disc.",
            .fallback = 0.00925024503556995,
            .minimum = 1e-5,
            .maximum = 1.0};
}

std::vector<Schema> make_schemas()
{
    using T = ParameterType;
    return {
        {"sun",
         "The sun alone. Irradiance in W/m2 a channel.",
         {elevation_parameter(),
          azimuth_parameter(),
          {.name = "irradiance",
           .type = T::color,
           .doc = "On a plane that faces the sun. Without it: sunlight after its way through clear air.",
           .unit = "W/m2",
           .minimum = 0.0},
          {.name = "shape",
           .type = T::choice,
           .doc = "disc: soft shadows; delta: a single direction.",
           .fallback = std::string("disc"),
           .choices = {"disc", "delta"}},
          diameter_parameter(),
          aerosol_parameter(),
          altitude_parameter()}},
        {"sky",
         "A clear sky, computed from air, haze and ozone, and its sun. Radiance in W/m2/sr a channel, scaled so that the luminance of sunlight above "
         "the air is "
         "1361 W/m2.",
         {elevation_parameter(),
          azimuth_parameter(),
          {.name = "sun",
           .type = T::choice,
           .doc = "The sun that comes with the sky.",
           .fallback = std::string("disc"),
           .choices = {"disc", "delta", "none"}},
          diameter_parameter(),
          aerosol_parameter(),
          {.name = "ozone", .type = T::number, .doc = "Ozone, Dobson units.", .fallback = 300.0, .minimum = 0.0, .maximum = 1000.0},
          {.name = "ground_albedo", .type = T::number, .doc = "Of the planet around the scene.", .fallback = 0.2, .minimum = 0.0, .maximum = 1.0},
          altitude_parameter()}},
        {"constant",
         "A sky of one radiance, below the horizon too.",
         {{.name = "radiance", .type = T::color, .doc = "From every direction.", .required = true, .unit = "W/m2/sr", .minimum = 0.0}}},
    };
}

AtmosphereParameters air_of(const Values& values)
{
    AtmosphereParameters air;
    air.aerosol = values.number("aerosol");
    air.altitude = values.number("altitude");
    return air;
}

Light make_sun(const std::string& shape, const Values& values, const Vec3f& irradiance)
{
    const Vec3d direction = compass_direction(values.number("elevation"), values.number("azimuth"));
    if (shape == "delta") return DeltaSun(direction, irradiance);
    return DiscSun(direction, irradiance, values.number("diameter"));
}

}  // namespace

DiscSun::DiscSun(const Vec3d& direction, const Vec3f& irradiance, double diameter) : direction_(direction)
{
    const double half = 0.5 * diameter, quarter_sine = std::sin(0.5 * half);
    orthonormal_frame(direction_, tangent_, bitangent_);
    chord2_ = 4.0 * quarter_sine * quarter_sine;
    pdf_ = 1.0 / (kPi * chord2_);
    radiance_ = irradiance / static_cast<float>(kPi * std::sin(half) * std::sin(half));
}

LightSample DiscSun::sample(const Vec2d& u) const
{
    const double drop = 0.5 * chord2_ * u.x, sine = std::sqrt(drop * (2.0 - drop)), angle = 2.0 * kPi * u.y;  // 1 - cosine
    const Vec3d w = direction_ * (1.0 - drop) + tangent_ * (sine * std::cos(angle)) + bitangent_ * (sine * std::sin(angle));
    return {w, radiance_, pdf_, false};
}

LightSample ClearSky::sample(const Vec2d& u) const
{
    const Vec3d w = table_->sample(u);
    return {w, table_->radiance(w), table_->pdf(w), false};
}

Vec3d compass_direction(double elevation, double azimuth)
{
    return Vec3d(std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth), std::sin(elevation));
}

std::span<const Schema> light_schemas()
{
    static const std::vector<Schema> schemas = make_schemas();
    return schemas;
}

std::vector<Light> make_lights(const std::string& type, const Values& values, const std::function<Vec3f(const ColorValue&)>& to_rendering,
                               double haze)
{
    const auto color = [&](const ColorValue& value) {
        if (to_rendering) return to_rendering(value);
        if (value.space != "acescg") throw Error(ErrorKind::internal, "a colour in " + value.space + " and no colour management");
        return Vec3f(value.rgb);
    };
    const auto from_acescg = [&](const Vec3d& rgb) { return color(ColorValue{rgb, "acescg"}); };

    if (type == "constant") return {ConstantSky(color(values.color("radiance")))};
    const Vec3d sun = compass_direction(values.number("elevation"), values.number("azimuth"));
    AtmosphereParameters air = air_of(values);
    air.aerosol = std::max(0.0, air.aerosol - haze);
    if (type == "sun") {
        if (values.has("irradiance")) return {make_sun(values.text("shape"), values, color(values.color("irradiance")))};
        return {make_sun(values.text("shape"), values, from_acescg(to_acescg(Atmosphere(air, sun.z).sun_irradiance())))};
    }
    air.ozone = values.number("ozone");
    air.ground_albedo = values.number("ground_albedo");
    const auto table = std::make_shared<const SkyTable>(air, sun, from_acescg);
    std::vector<Light> lights;
    if (values.text("sun") != "none" && sun.z > 0.0) lights.push_back(make_sun(values.text("sun"), values, table->sun_irradiance()));
    lights.push_back(ClearSky(table));
    return lights;
}

}  // namespace hoodoo
