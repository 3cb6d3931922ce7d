// A wave is drawn once, in the paper's own numbers (Gamito2001, section 4.2: R1, R2, alpha, T), and scaled as a whole; its life is told in seconds.
// Deviations: R1 and R2 are called outer and core, since they are swapped in print; the depth of the water below the centre, which the paper leaves
// out, must keep the core in air; an amount of deformation T is metres that the rim of an unscaled core has turned. Swells are trains by length,
// height and direction; a train without a phase takes one from the seed.
#include "terrain/surfaces/sea_parameters.h"

#include "terrain/math/hash.h"

#include <fmt/format.h>

#include <numbers>

namespace hoodoo
{

namespace
{

constexpr double kGravity = 9.81;

Parameter number(const std::string& name, const std::string& doc, double fallback, double least, double most, const std::string& unit = {})
{
    return {.name = name, .type = ParameterType::number, .doc = doc, .fallback = fallback, .unit = unit, .minimum = least, .maximum = most};
}

Parameter metres(const std::string& name, const std::string& doc, double fallback, bool zero = false)
{
    return {.name = name, .type = ParameterType::length, .doc = doc, .fallback = fallback, .unit = "m", .minimum = 0, .above_minimum = !zero};
}

Parameter seconds(const std::string& name, const std::string& doc, double fallback, bool positive = true)
{
    Parameter p{.name = name, .type = ParameterType::duration, .doc = doc, .fallback = fallback, .unit = "s"};
    if (positive) p.minimum = 0, p.above_minimum = true;
    return p;
}

Parameter heading(const std::string& doc)
{
    return {.name = "heading", .type = ParameterType::angle, .doc = doc, .fallback = std::numbers::pi};
}

Schema wave_schema()
{
    return {"wave",
            "A wave that breaks.",
            {
                {.name = "centre",
                 .type = ParameterType::vector,
                 .doc = "Where the middle of its crest is at time 0, from the origin.",
                 .fallback = std::vector<double>{0, 0},
                 .unit = "m",
                 .min_count = 2,
                 .max_count = 2},
                heading("The way it runs, from the x axis towards y."),
                number("scale", "Of the whole wave: outer, core, depth, bore and intensity are told for a scale of 1.", 1.0, 0.01, 100.0),
                metres("outer", "R1 of the paper: farther from the centre nothing turns.", 6.0),
                metres("core", "R2: up to here everything turns as one; the hollow becomes about as large.", 0.75),
                number("alpha", "How fast the turning fades from core to outer.", 2.0, 2.0, 16.0),
                metres("depth", "Of the water at rest below the centre; at least the core.", 0.8),
                metres("intensity", "T at the height of its life: how far the core's rim turns. 1: a swell, 2.8: it throws, 4.6: it lands.", 5.0),
                {.name = "speed", .type = ParameterType::number, .doc = "Of the crest.", .fallback = 5.0, .unit = "m/s", .minimum = 0},
                seconds("start", "When the middle of the crest begins to rise.", 0.0, false),
                seconds("steepening", "From there until it has its full intensity and collapses.", 4.0),
                {.name = "peel",
                 .type = ParameterType::number,
                 .doc = "How fast the break runs along the crest, to both sides of its middle.",
                 .fallback = 6.0,
                 .unit = "m/s",
                 .minimum = 0,
                 .above_minimum = true},
                metres("peel_width", "Length of the crest, to either side of the middle, that breaks about at once.", 4.0),
                seconds("collapse", "How long the fallen wave takes to become white water.", 1.5),
                seconds("decay", "How long the white water takes to fall to 1/e of its height.", 6.0),
                metres("bore", "Height of the white water.", 0.9, true),
            }};
}

Schema swell_schema()
{
    return {"swell",
            "A train of long waves that does not break.",
            {
                {.name = "wavelength", .type = ParameterType::length, .doc = "From crest to crest.", .required = true, .unit = "m", .minimum = 0.1},
                {.name = "height", .type = ParameterType::length, .doc = "From trough to crest.", .required = true, .unit = "m", .minimum = 0},
                heading("The way it runs, from the x axis towards y."),
                {.name = "phase", .type = ParameterType::angle, .doc = "Of the cosine at the origin at time 0; by default from the seed."},
            }};
}

Breaker read_wave(const Values& v)
{
    Breaker b;
    const double scale = v.number("scale"), turn = v.number("heading");
    b.shape = {v.number("outer") * scale, v.number("core") * scale, v.number("alpha"), v.number("depth") * scale};
    if (!(b.shape.core < b.shape.outer))
        throw v.problem("core", "the core of a wave", fmt::format("less than outer, {:.6g} m", v.number("outer")),
                        fmt::format("{:.6g}", v.number("core")));
    if (!(b.shape.depth >= b.shape.core))
        throw v.problem("depth", "the core of a wave must lie in air", fmt::format("at least the core, {:.6g} m", v.number("core")),
                        fmt::format("{:.6g}", v.number("depth")));
    b.centre = v.vec2("centre");
    b.heading = {std::cos(turn), std::sin(turn)};
    b.speed = v.number("speed");
    b.intensity = v.number("intensity") * scale;
    b.start = v.number("start");
    b.steepening = v.number("steepening");
    b.peel = v.number("peel");
    b.peel_width = v.number("peel_width");
    b.collapse = v.number("collapse");
    b.decay = v.number("decay");
    b.bore = v.number("bore") * scale;
    return b;
}

}  // namespace

std::vector<Parameter> sea_parameters()
{
    const auto list = [](const std::string& name, const std::string& doc, int most, Schema item) {
        return Parameter{.name = name, .type = ParameterType::tables, .doc = doc, .min_count = 0, .max_count = most, .items = {std::move(item)}};
    };
    return {
        list("wave", "The waves that break.", 8, wave_schema()),
        list("swell", "What else moves the sea.", 16, swell_schema()),
        metres("swell_extent", "Where the swell has faded out half, from the origin, along x and along y.", 1500.0),
        number("ripples", "Root mean square of the slope of the small waves; sqrt(0.003 + 0.005 wind in m/s).", 0.1, 0.0, 0.5),
        metres("ripple_length", "Wavelength of the longest of them.", 1.2),
        {.name = "wind", .type = ParameterType::angle, .doc = "Where they run, from the x axis towards y.", .fallback = std::numbers::pi},
        number("foam", "How much of the water foam covers where waves break; 0: none.", 1.0, 0.0, 4.0),
        metres("foam_length", "Size of the meshes of the foam's lace.", 1.5),
        number("spray", "Density of the spray over lip, seam and white water; 0: none.", 1.0, 0.0, 1.0),
        metres("spray_height", "How high it hangs over the water.", 0.6),
        metres("spray_length", "Size of its largest puffs.", 0.8),
    };
}

SeaDescription read_sea(const Values& values, std::uint64_t seed)
{
    SeaDescription sea;
    for (const Values& wave : values.tables("wave")) sea.breakers.push_back(read_wave(wave));
    std::vector<Swell> trains;
    for (const Values& v : values.tables("swell")) {
        Swell s;
        const double k = 2.0 * std::numbers::pi / v.number("wavelength"), turn = v.number("heading");
        s.amplitude = 0.5 * v.number("height");
        s.wave_number = Vec2d(std::cos(turn), std::sin(turn)) * k;
        s.frequency = std::sqrt(kGravity * k);
        const std::uint64_t bits = hash_combine(hash_name(seed, "swell"), trains.size());
        s.phase = v.has("phase") ? v.number("phase") : 2.0 * std::numbers::pi * unit_real(bits);
        trains.push_back(s);
    }
    const double extent = values.number("swell_extent");
    sea.swell = Swells(std::move(trains), {0.6 * extent, 1.4 * extent, Vec2d(0.0)});
    const double wind = values.number("wind");
    sea.ripples = {values.number("ripples"), values.number("ripple_length"), Vec2d(std::cos(wind), std::sin(wind)),
                   static_cast<std::uint32_t>(hash_name(seed, "ripples") >> 32)};
    sea.foam.cover = values.number("foam");
    sea.foam.lace = values.number("foam_length");
    sea.foam.spray = values.number("spray");
    sea.foam.height = values.number("spray_height");
    sea.foam.puff = values.number("spray_length");
    sea.foam.seed = static_cast<std::uint32_t>(hash_name(seed, "foam") >> 32);
    return sea;
}

}  // namespace hoodoo
