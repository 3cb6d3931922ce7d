// One table of names and limits for every terrain that is a sum of noise (fields/elevation.h).
#include "terrain/surfaces/noise_parameters.h"

namespace hoodoo
{

namespace
{

Parameter plain_number(const std::string& name, double fallback, double least, double most, const std::string& doc)
{
    return {.name = name, .type = ParameterType::number, .doc = doc, .fallback = fallback, .minimum = least, .maximum = most};
}

}  // namespace

std::vector<Parameter> noise_parameters(const std::string& kind_name, double octaves)
{
    return {
        {.name = kind_name,
         .type = ParameterType::choice,
         .doc = "Even hills, creased crests, round domes, or plains that rise to rugged heights.",
         .fallback = std::string("fbm"),
         .choices = {"fbm", "ridged", "billow", "multifractal"}},
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
        plain_number("octaves", octaves, 1.0, 24.0, "How many sizes of hills."),
        plain_number("lacunarity", 2.0, 1.1, 8.0, "How much finer each is than the last."),
        plain_number("gain", 0.5, 0.05, 0.95, "How high each is against the last."),
    };
}

ElevationShape read_noise(const Values& values, const std::string& kind_name)
{
    ElevationShape shape;
    const std::string& kind = values.text(kind_name);
    shape.kind = kind == "ridged"         ? ElevationKind::ridged
                 : kind == "billow"       ? ElevationKind::billow
                 : kind == "multifractal" ? ElevationKind::multifractal
                                          : ElevationKind::fbm;
    shape.relief = values.number("relief");
    shape.wavelength = values.number("wavelength");
    shape.fractal = {values.number("octaves"), values.number("lacunarity"), values.number("gain")};
    return shape;
}

}  // namespace hoodoo
