// Shapes of desert country as heights over the plane: hills and ridges from noise, table mountains, canyons along a line.
// Noise sums after Perlin2002 (math/noise.h); the domain is warped by noise (p + w (n1, n2)), which breaks the isotropy of plain sums.
//   fractal  h = height + relief * sum / bound, sum = fbm, ridged (crests) or billow (round hills).
//   mesa     the share m of a noise over its threshold becomes a flank of the width `flank`, from `low` up to `high`.
//   canyon   distance d to a polyline: the floor inside `floor_width`, then an even flank up to `rim` at `width`; +infinity beyond: nothing to cut.
// Each may be bedded (strata.h). Deviation: distances are to a warped line, so they are lengths only on average.
// Missing: drainage, erosion; these are operators, not functions of a point.
#include "terrain/fields/height_shapes.h"

#include "terrain/fields/strata.h"
#include "terrain/math/hash.h"
#include "terrain/math/noise.h"
#include "terrain/math/smoothstep.h"

#include <algorithm>
#include <memory>

namespace hoodoo
{

namespace
{

std::uint32_t low_bits(std::uint64_t seed)
{
    return static_cast<std::uint32_t>(mix64(seed));
}

/// Moves points by up to `amount` metres with noise of the wavelength `wavelength`.
struct Warp {
    double amount, wavelength;
    std::uint32_t seed;

    Vec2d operator()(const Vec2d& p) const
    {
        if (amount == 0.0) return p;
        const Fractal fractal{4.0, 2.03, 0.5};
        const double scale = amount / fbm_bound(kNoise2Bound, fractal).value * 2.0;
        return p + Vec2d(fbm(p / wavelength, seed, fractal).value, fbm(p / wavelength, seed + 101u, fractal).value) * scale;
    }
};

Warp warp_of(const Values& v, std::uint64_t seed)
{
    return {v.number("warp"), v.number("warp_wavelength"), low_bits(hash_name(seed, "warp"))};
}

HeightFunction bedded(const Values& v, double low, double high, std::uint64_t seed, HeightFunction even)
{
    const std::function<double(double)> beds = make_beds(v, low, high, seed);
    if (!beds) return even;
    return [beds, even = std::move(even)](const Vec2d& p) { return beds(even(p)); };
}

HeightFunction make_fractal(const Values& v, std::uint64_t seed)
{
    const Fractal fractal{v.number("octaves"), 2.0, v.number("gain")};
    const std::string& kind = v.text("kind");
    const double height = v.number("height"), relief = v.number("relief"), wavelength = v.number("wavelength");
    const Warp warp = warp_of(v, seed);
    const std::uint32_t s = low_bits(hash_name(seed, "fractal"));
    const double bound = fbm_bound(kNoise2Bound, fractal).value, crests = ridged_bound(kNoise2Bound, fractal).value;
    HeightFunction even = [=](const Vec2d& p) {
        const Vec2d q = warp(p) / wavelength;
        if (kind == "ridged") return height + relief * (2.0 * ridged(q, s, fractal).value / crests - 1.0);
        const double n = fbm(q, s, fractal).value / bound;
        // The full bound is never met; twice the share makes `relief` what is seen.
        if (kind == "billow") return height + relief * (4.0 * std::abs(n) - 1.0);
        return height + relief * std::clamp(2.0 * n, -1.0, 1.0);
    };
    return bedded(v, height - relief, height + relief, seed, std::move(even));
}

HeightFunction make_mesa(const Values& v, std::uint64_t seed)
{
    const double low = v.number("low"), high = v.number("high"), wavelength = v.number("wavelength"), flank = v.number("flank");
    const double roughness = v.number("roughness");
    // Values of the noise sum are roughly normal with deviation 0.25; `cover` is the share of the plane that becomes table.
    const double threshold = 0.8 * (0.5 - v.number("cover"));
    const Warp warp = warp_of(v, seed);
    const std::uint32_t s = low_bits(hash_name(seed, "mesa"));
    HeightFunction even = [=](const Vec2d& p) {
        const Noise2 n = fbm(warp(p) / wavelength, s, {3.0, 2.0, 0.45});
        // Distance to the level line to first order: value over slope, the slope kept from vanishing on tops.
        const double slope = std::max(n.gradient.length(), 0.6) / wavelength;
        const double distance = (n.value - threshold) / slope;
        const double rough = roughness * fbm(p / (0.15 * wavelength), s + 7u, {5.0, 2.1, 0.5}).value;
        const double t = std::clamp(distance / flank + rough, 0.0, 1.0);
        return low + (high - low) * t;
    };
    return bedded(v, low, high, seed, std::move(even));
}

/// Distance to a polyline in the plane, and the height of the line at the nearest point.
struct Nearest {
    double distance, height;
};

Nearest nearest_on(const std::vector<Vec3d>& line, const Vec2d& p)
{
    Nearest best{kInfinity, 0.0};
    for (std::size_t k = 0; k + 1 < line.size() || k == 0; ++k) {
        const Vec3d a = line[k], b = line[std::min(k + 1, line.size() - 1)];
        const Vec2d step(b.x - a.x, b.y - a.y), from(p.x - a.x, p.y - a.y);
        const double length2 = step.length2();
        const double u = length2 > 0.0 ? std::clamp(from.dot(step) / length2, 0.0, 1.0) : 0.0;
        const double distance = (from - step * u).length();
        if (distance < best.distance) best = {distance, a.z + u * (b.z - a.z)};
        if (line.size() == 1) break;
    }
    return best;
}

HeightFunction make_canyon(const Values& v, std::uint64_t seed)
{
    const std::vector<Vec3d> line = v.points("points");
    const double floor_half = 0.5 * v.number("floor_width"), rim_half = 0.5 * v.number("width"), rim = v.number("rim"),
                 steepness = v.number("steepness");
    if (!(rim_half > floor_half)) throw v.problem("width", "the canyon is narrower than its floor", "more than floor_width");
    double lowest = kInfinity;
    for (const Vec3d& p : line) lowest = std::min(lowest, p.z);
    if (!(rim > lowest)) throw v.problem("rim", "the rim lies below the floor", "a height above the lowest point");
    const Warp warp = warp_of(v, seed);
    const double roughness = v.number("roughness"), wavelength = v.number("warp_wavelength");
    const std::uint32_t s = low_bits(hash_name(seed, "canyon"));
    HeightFunction even = [=](const Vec2d& p) {
        const Nearest n = nearest_on(line, warp(p));
        const double rough = 1.0 + roughness * fbm(p / (0.35 * wavelength), s, {5.0, 2.1, 0.5}).value;
        const double t = (n.distance - floor_half) / ((rim_half - floor_half) * rough);
        if (!(t < 1.0)) return kInfinity;
        // Steep below, leaning back above: t^(1/steepness).
        return n.height + (rim - n.height) * std::pow(smoothstep(std::max(0.0, t)), 1.0 / steepness);
    };
    HeightFunction beds = bedded(v, lowest, rim, seed, std::move(even));
    return beds;
}

Parameter length(std::string name, double fallback, std::string doc, bool positive = false)
{
    Parameter p{.name = std::move(name), .type = ParameterType::length, .doc = std::move(doc), .fallback = fallback, .unit = "m"};
    if (positive) p.minimum = 0.0, p.above_minimum = true;
    return p;
}

Parameter needed(std::string name, std::string doc, bool positive = false)
{
    Parameter p{.name = std::move(name), .type = ParameterType::length, .doc = std::move(doc), .required = true, .unit = "m"};
    if (positive) p.minimum = 0.0, p.above_minimum = true;
    return p;
}

Parameter number(std::string name, double fallback, double low, double high, std::string doc)
{
    return {.name = std::move(name), .type = ParameterType::number, .doc = std::move(doc), .fallback = fallback, .minimum = low, .maximum = high};
}

void add_common(Schema& schema)
{
    schema.parameters.push_back(length("warp", 0.0, "How far noise moves the shape sideways."));
    schema.parameters.push_back(length("warp_wavelength", 100.0, "Wavelength of that noise.", true));
    for (Parameter& p : bed_parameters()) schema.parameters.push_back(std::move(p));
}

}  // namespace

std::vector<Schema> height_shape_schemas()
{
    Schema fractal{"fractal", "Hills or ridges: a sum of noise.", {}};
    fractal.parameters = {
        length("height", 0.0, "Mean height."),
        needed("relief", "Height of the hills above and below the mean."),
        needed("wavelength", "Size of the largest hills.", true),
        {.name = "kind",
         .type = ParameterType::choice,
         .doc = "Even hills, sharp crests or round domes.",
         .fallback = std::string("fbm"),
         .choices = {"fbm", "ridged", "billow"}},
        number("octaves", 6.0, 1.0, 16.0, "How many sizes of hills; each half the last."),
        number("gain", 0.5, 0.1, 0.9, "Height of each octave relative to the last."),
    };
    Schema mesa{"mesa", "Table mountains: flat tops with steep flanks.", {}};
    mesa.parameters = {
        needed("low", "Height of the plain."),
        needed("high", "Height of the tables."),
        needed("wavelength", "Size of the tables.", true),
        needed("flank", "Horizontal width of the flanks.", true),
        number("cover", 0.4, 0.0, 1.0, "About the share of the ground that is table."),
        number("roughness", 0.15, 0.0, 2.0, "Small noise in the flanks."),
    };
    Schema canyon{"canyon", "A valley along a line, for measure = \"cut\".", {}};
    canyon.parameters = {
        {.name = "points",
         .type = ParameterType::points,
         .doc = "The line of the valley; its z is the floor.",
         .required = true,
         .unit = "m",
         .min_count = 2,
         .max_count = 10000},
        needed("rim", "Height where the flanks end."),
        needed("floor_width", "Width of the flat floor."),
        needed("width", "Width at the rim.", true),
        number("steepness", 1.5, 0.2, 8.0, "Above 1: steep below, leaning back above."),
        number("roughness", 0.35, 0.0, 2.0, "Noise in the flanks."),
    };
    std::vector<Schema> all = {fractal, mesa, canyon};
    for (Schema& schema : all) add_common(schema);
    return all;
}

std::vector<Parameter> bed_parameters()
{
    return {
        {.name = "beds",
         .type = ParameterType::length,
         .doc = "Mean thickness of hard and soft beds, which make ledges; absent: none.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        number("bed_contrast", 0.85, 0.0, 0.98, "0: beds do not show; near 1: walls and treads."),
        {.name = "bed_seed", .type = ParameterType::integer, .doc = "Layers with the same bed_seed and range share their beds."},
    };
}

std::function<double(double)> make_beds(const Values& values, double low, double high, std::uint64_t seed)
{
    if (!values.has("beds")) return {};
    const std::uint64_t bed_seed = values.has("bed_seed") ? static_cast<std::uint64_t>(values.integer("bed_seed")) : hash_name(seed, "beds");
    const auto strata = std::make_shared<Strata>(low, high, values.number("beds"), values.number("bed_contrast"), bed_seed);
    return [strata](double h) { return (*strata)(h); };
}

HeightFunction make_height_shape(const Values& values, std::uint64_t seed)
{
    if (values.variant() == "fractal") return make_fractal(values, seed);
    if (values.variant() == "mesa") return make_mesa(values, seed);
    return make_canyon(values, seed);
}

}  // namespace hoodoo
