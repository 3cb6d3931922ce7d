// Procedural looks: beds of sandstone with desert varnish, rippled sand, mottled rock and soil, trembling water, from hashed beds and gradient noise
// (Perlin2002).
//
// All detail is a sum of octaves of zero mean around a mean colour. An octave of wavelength L is weighted by kept_share(L, footprint), so that it
// is gone before it could alias (Nyquist: L = 2 footprint), and the mean remains. Steps (bed boundaries) are as wide as the footprint. Where a
// colour is a threshold of noise (varnish, lichen), the covered share goes to its own mean. Slopes of relief that are not shown are returned as
// a variance, which the look adds to the roughness: far ripples still scatter.
// Solid functions of texture_point need no projection. No function here has a period: octaves are hashed, their wavelengths no multiples.
// Deviations: the transition weights are box filters of constant width, not the exact integral over the footprint; colours of thresholds are
// filtered after the ramp, so means shift by less than a few percent when octaves vanish.

#include "renderer/shading/procedural.h"

#include "terrain/math/hash.h"
#include "terrain/math/noise.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

double smooth_step(double lo, double hi, double x)
{
    const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

Vec3f mix(const Vec3f& a, const Vec3f& b, double t)
{
    return a + (b - a) * static_cast<float>(t);
}

/// Noise of its own seed, shifted, since all octaves vanish at the points of their lattices.
Noise3 octave(std::uint64_t seed, const Vec3d& p)
{
    const std::uint64_t h = mix64(seed);
    constexpr double to_unit = 1.0 / 65536.0;
    const Vec3d shift(static_cast<double>(h & 0xffff) * to_unit, static_cast<double>((h >> 16) & 0xffff) * to_unit,
                      static_cast<double>((h >> 32) & 0xffff) * to_unit);
    return gradient_noise(p + shift, static_cast<std::uint32_t>(h >> 32));
}

/// A sum of octaves with its gradient, and the variance of the slopes that were left out.
struct Sum {
    double value = 0.0;
    Vec3d gradient{0.0};
    double lost = 0.0;

    /// Adds noise of amplitude `a` and the given wavelength; `slope` is how much of it is relief (0: colour only).
    void add(std::uint64_t seed, const Vec3d& p, double wavelength, double a, double slope, double footprint)
    {
        // Mean square of the gradient of our noise per unit amplitude and wavelength: measured 0.745 over 1e6 points.
        constexpr double slope_power = 0.745;
        const double kept = kept_share(wavelength, footprint);
        const double steepness = slope / wavelength;
        lost += (1.0 - kept * kept) * steepness * steepness * slope_power;
        if (kept == 0.0) return;
        const Noise3 n = octave(seed, p / wavelength);
        value += a * kept * n.value;
        gradient += n.gradient * (kept * steepness);
    }
};

// -- Beds ------------------------------------------------------------------------------------------------------------

/// One scale of bedding: beds of about `thickness`, each of a hashed tone, boundaries shifted by up to a third of it.
struct Bed {
    double tone = 0.0;   ///< in [-1, 1], mean 0
    double slope = 0.0;  ///< d(tone)/dh, per metre
};

Bed bed_at(std::uint64_t seed, double h, double thickness, double footprint)
{
    const double kept = kept_share(thickness, footprint);
    if (kept == 0.0) return {};
    const double x = h / thickness;
    const double cell = std::floor(x);
    const auto k = static_cast<std::int64_t>(cell);
    // One hash a bed: its high half shifts the bed's lower boundary, its low half is the tone.
    const auto bits = [&](std::int64_t i) { return hash_combine(seed, static_cast<std::uint64_t>(i)); };
    const auto boundary = [&](std::int64_t i) { return static_cast<double>(i) + 0.6 * (static_cast<double>(bits(i) >> 32) * 0x1p-32 - 0.5); };
    const auto tone = [&](std::int64_t i) { return static_cast<double>(bits(i) & 0xffffffffu) * 0x1p-31 - 1.0; };

    // The nearest boundary lies at one of three indices; only it can blend, since its half-width stays under half the least bed of 0.4.
    const std::int64_t nearest = x - cell < 0.5 ? k : k + 1;
    std::int64_t edge = nearest;
    for (const std::int64_t i : {nearest - 1, nearest + 1})
        if (std::abs(x - boundary(i)) < std::abs(x - boundary(edge))) edge = i;
    const double half_width = std::clamp(0.5 * footprint / thickness, 0.035, 0.2);
    const double d = x - boundary(edge);
    const double below = tone(edge - 1), above = tone(edge);
    const double t = std::clamp(0.5 + 0.5 * d / half_width, 0.0, 1.0);
    const double s = t * t * (3.0 - 2.0 * t);
    const double ds = 6.0 * t * (1.0 - t) * 0.5 / half_width;
    return {kept * (below + (above - below) * s), kept * (above - below) * ds / thickness};
}

// -- The procedures --------------------------------------------------------------------------------------------------

/// Layered sandstone. Palette: red-brown, orange-red, ochre, pale, varnish.
Pattern bedrock(const Palette& colors, std::uint64_t seed, const Interaction& at, double footprint)
{
    const Vec3d& p = at.texture_point;
    const double level = std::clamp(std::abs(at.shading_normal.z), 0.0, 1.0);
    const double steep = std::sqrt(1.0 - level * level);
    const double bed_footprint = footprint * std::max(steep, 0.3);  // a level face crosses few beds

    // The beds dip gently and undulate: the height that counts beds is z warped by low frequencies.
    Sum warp;
    warp.add(seed ^ 1, Vec3d(p.x, p.y, 0.4 * p.z), 97.0, 5.0, 0.0, footprint);
    warp.add(seed ^ 2, p, 19.0, 0.7, 0.0, footprint);
    warp.add(seed ^ 14, p, 2.3, 0.06, 0.0, footprint);
    const Vec3d dip(0.031, -0.022, 1.0);
    const double h = p.dot(dip) + warp.value;

    const Bed formation = bed_at(seed ^ 3, h, 23.0, bed_footprint);
    const Bed member = bed_at(seed ^ 4, h, 6.1, bed_footprint);
    const Bed bed = bed_at(seed ^ 5, h, 1.7, bed_footprint);
    const Bed lamina = bed_at(seed ^ 6, h, 0.41, bed_footprint);

    Sum mottle;
    mottle.add(seed ^ 7, p, 31.0, 0.45, 0.0, footprint);
    mottle.add(seed ^ 8, p, 8.3, 0.35, 0.25, footprint);
    mottle.add(seed ^ 9, p, 2.1, 0.3, 0.12, footprint);
    mottle.add(seed ^ 10, p, 0.57, 0.25, 0.04, footprint);
    mottle.add(seed ^ 11, p, 0.13, 0.2, 0.01, footprint);

    // Colour: a ramp over the tone, then pale beds, then grain.
    const double tone = 0.5 * formation.tone + 0.42 * member.tone + 0.3 * bed.tone + 0.16 * lamina.tone + 0.3 * mottle.value;
    Vec3f color = tone < 0.0 ? mix(colors[1], colors[0], std::min(-tone * 1.25, 1.0)) : mix(colors[1], colors[2], std::min(tone * 1.25, 1.0));
    color = mix(color, colors[3], 0.75 * smooth_step(0.45, 0.75, 0.75 * member.tone + 0.35 * bed.tone + 0.3 * mottle.value));
    color *= static_cast<float>(1.0 + 0.22 * mottle.value + 0.10 * lamina.tone);

    // Desert varnish runs down steep faces in streaks; dust lies on level ones.
    if (steep > 0.5) {
        const double wall = smooth_step(0.5, 0.95, steep);
        const double kept = kept_share(2.3, footprint);
        double cover = 0.22;
        if (kept > 0.0) {
            Sum streaks;
            streaks.add(seed ^ 12, Vec3d(p.x, p.y, p.z * 0.05), 2.3, 0.8, 0.0, footprint);
            streaks.add(seed ^ 13, Vec3d(p.x, p.y, p.z * 0.035), 0.61, 0.6, 0.0, footprint);
            cover += kept * (smooth_step(-0.08, 0.5, streaks.value + 0.8 * mottle.value - 0.12 * member.tone) - cover);
        }
        color = mix(color, colors[4], 0.62 * wall * cover);
    }
    color = mix(color, colors[3], 0.2 * smooth_step(0.75, 0.98, at.shading_normal.z));

    // Relief: hard beds stand out by a few centimetres, and the face is rough.
    Pattern result;
    result.albedo = color;
    const double ledges = std::clamp(0.5 * member.slope + 0.16 * bed.slope + 0.03 * lamina.slope, -0.8, 0.8);
    result.relief = mottle.gradient + dip * (ledges * steep);
    result.lost_variance = mottle.lost;
    return result;
}

/// Ripples of one wavelength, crests across a direction that wanders: slope along it and height in [-1, 1].
struct Ripples {
    double height = 0.0;
    Vec3d gradient{0.0};
    double lost = 0.0;
};

Ripples ripples(std::uint64_t seed, const Vec3d& p, double wavelength, double steepness, double angle, double footprint)
{
    const double kept = kept_share(wavelength, 1.5 * footprint);
    Ripples r;
    r.lost = (1.0 - kept * kept) * steepness * steepness * 0.56;  // mean square of cos + 0.35 cos 2x
    if (kept == 0.0) return r;

    // The phase is a distance across the crests, bent by noise: it stays a gradient field, so crests join and fork.
    const Vec3d flat(p.x, p.y, 0.0);
    Vec3d across(std::cos(angle), std::sin(angle), 0.0);
    const Noise3 bend = octave(seed ^ 65, flat / (11.0 * wavelength));
    const Noise3 fork = octave(seed ^ 66, flat / (3.1 * wavelength));
    const double phase = (across.dot(flat) / wavelength + 4.0 * bend.value + 0.7 * fork.value) * 6.283185307179586;
    across += bend.gradient * (4.0 / 11.0) + fork.gradient * (0.7 / 3.1);
    across.z = 0.0;

    // The lee side is steeper: a second harmonic (sin x + 0.35/2 sin 2x is the profile, its derivative the slope).
    const double s = std::sin(phase), c = std::cos(phase);
    r.height = kept * (s + 0.35 * s * c);
    r.gradient = across * (kept * steepness * (c + 0.35 * (2.0 * c * c - 1.0)));
    return r;
}

/// Wind-blown sand. Palette: mean, pale, reddish, (unused), (unused).
Pattern sand(const Palette& colors, std::uint64_t seed, const Interaction& at, double footprint)
{
    const Vec3d& p = at.texture_point;
    Sum tint;
    tint.add(seed ^ 1, p, 83.0, 1.3, 0.0, footprint);
    tint.add(seed ^ 2, p, 27.0, 1.1, 0.0, footprint);
    tint.add(seed ^ 3, p, 7.7, 0.8, 0.5, footprint);
    tint.add(seed ^ 4, p, 0.19, 0.3, 0.006, footprint);

    // Ripples die out on slopes near repose and in patches.
    const double lie = smooth_step(0.75, 0.95, at.shading_normal.z) * (0.65 + 0.5 * tint.value);
    const Ripples large = ripples(seed ^ 5, p, 3.7, 0.14 * lie, 0.7, footprint);
    const Ripples small = ripples(seed ^ 6, p, 0.43, 0.20 * lie, 0.45, footprint);

    Pattern result;
    const double t = tint.value + 0.10 * large.height + 0.12 * small.height;
    result.albedo = t > 0.0 ? mix(colors[0], colors[1], std::min(t, 1.0)) : mix(colors[0], colors[2], std::min(-t, 1.0));
    result.relief = large.gradient + small.gradient + tint.gradient;
    result.lost_variance = large.lost + small.lost + tint.lost;
    return result;
}

/// Loose blocks of grey-brown rock with lichen. Palette: mean, dark, light, pale lichen, orange lichen.
Pattern rock(const Palette& colors, std::uint64_t seed, const Interaction& at, double footprint)
{
    const Vec3d& p = at.texture_point;
    Sum mottle;
    mottle.add(seed ^ 1, p, 29.0, 0.5, 0.0, footprint);
    mottle.add(seed ^ 2, p, 5.3, 0.6, 0.2, footprint);
    mottle.add(seed ^ 3, p, 1.3, 0.6, 0.12, footprint);
    mottle.add(seed ^ 4, p, 0.37, 0.5, 0.04, footprint);
    mottle.add(seed ^ 5, p, 0.11, 0.4, 0.012, footprint);
    const double t = mottle.value;
    Vec3f color = t < 0.0 ? mix(colors[0], colors[1], std::min(-1.3 * t, 1.0)) : mix(colors[0], colors[2], std::min(1.3 * t, 1.0));

    // Lichen grows in rounded patches where light comes from above.
    const double open = smooth_step(-0.2, 0.6, at.shading_normal.z);
    const double kept = kept_share(0.83, footprint);
    double pale = 0.12, orange = 0.03;
    if (kept > 0.0 && open > 0.0) {
        Sum patch;
        patch.add(seed ^ 6, p, 0.83, 0.9, 0.0, footprint);
        patch.add(seed ^ 7, p, 0.21, 0.45, 0.0, footprint);
        pale += kept * (smooth_step(0.22, 0.42, patch.value + 0.2 * t) - pale);
        orange += kept * (smooth_step(0.38, 0.5, -patch.value + 0.1 * t) - orange);
    }
    color = mix(color, colors[3], 0.6 * open * pale);
    color = mix(color, colors[4], 0.55 * open * orange);
    return {color, mottle.gradient, mottle.lost};
}

/// Dark earth, crumbly. Palette: mean, dark, light, (unused), (unused).
Pattern soil(const Palette& colors, std::uint64_t seed, const Interaction& at, double footprint)
{
    const Vec3d& p = at.texture_point;
    Sum crumbs;
    crumbs.add(seed ^ 1, p, 37.0, 0.6, 0.0, footprint);
    crumbs.add(seed ^ 2, p, 9.1, 0.5, 0.0, footprint);
    crumbs.add(seed ^ 3, p, 2.3, 0.5, 0.1, footprint);
    crumbs.add(seed ^ 4, p, 0.61, 0.5, 0.06, footprint);
    crumbs.add(seed ^ 5, p, 0.14, 0.5, 0.025, footprint);
    const double t = crumbs.value;
    return {t < 0.0 ? mix(colors[0], colors[1], std::min(-t, 1.0)) : mix(colors[0], colors[2], std::min(t, 1.0)), crumbs.gradient, crumbs.lost};
}

/// Still water under a light breeze: what comes back from its depth is one blue-grey; waves are relief, in patches where the wind touches down.
/// Slopes of a hundredth or two: a mirror that trembles. Palette: depth, (unused) ...
Pattern water(const Palette& colors, std::uint64_t seed, const Interaction& at, double footprint)
{
    const Vec3d flat(at.texture_point.x, at.texture_point.y, 0.0);
    Sum wind, waves;
    wind.add(seed ^ 1, flat, 61.0, 1.0, 0.0, 0.0);
    wind.add(seed ^ 2, flat, 17.0, 0.4, 0.0, 0.0);
    waves.add(seed ^ 3, flat, 5.3, 0.0, 0.020, footprint);
    waves.add(seed ^ 4, flat, 1.7, 0.0, 0.011, footprint);
    waves.add(seed ^ 5, flat, 0.59, 0.0, 0.0055, footprint);
    waves.add(seed ^ 6, flat, 0.21, 0.0, 0.0022, footprint);
    const double touched = 0.25 + 0.75 * smooth_step(-0.3, 0.4, wind.value);
    Vec3d relief = waves.gradient * touched;
    relief.z = 0.0;
    return {colors[0], relief, waves.lost * touched * touched};
}

// Reflectances in linear Rec.709, chosen by eye within what is measured for such materials: sandstone 0.1 to 0.6, dry sand 0.3 to 0.5, soil 0.1 to
// 0.2.
constexpr std::size_t kProcedures = 6;
const std::array<Palette, kProcedures> kPalettes = {{
    {Vec3f(0.5f), Vec3f(0.5f), Vec3f(0.5f), Vec3f(0.5f), Vec3f(0.5f)},
    {Vec3f(0.46f, 0.315f, 0.185f), Vec3f(0.56f, 0.425f, 0.28f), Vec3f(0.37f, 0.215f, 0.112f), Vec3f(0.5f), Vec3f(0.5f)},
    {Vec3f(0.275f, 0.115f, 0.062f), Vec3f(0.43f, 0.205f, 0.108f), Vec3f(0.54f, 0.325f, 0.165f), Vec3f(0.60f, 0.445f, 0.285f),
     Vec3f(0.105f, 0.064f, 0.046f)},
    {Vec3f(0.265f, 0.235f, 0.20f), Vec3f(0.15f, 0.13f, 0.112f), Vec3f(0.40f, 0.365f, 0.315f), Vec3f(0.43f, 0.44f, 0.33f), Vec3f(0.45f, 0.25f, 0.07f)},
    {Vec3f(0.165f, 0.108f, 0.068f), Vec3f(0.10f, 0.064f, 0.04f), Vec3f(0.25f, 0.175f, 0.115f), Vec3f(0.5f), Vec3f(0.5f)},
    {Vec3f(0.022f, 0.045f, 0.056f), Vec3f(0.5f), Vec3f(0.5f), Vec3f(0.5f), Vec3f(0.5f)},
}};

}  // namespace

const std::vector<std::string>& procedure_names()
{
    static const std::vector<std::string> names = {"plain", "sand", "bedrock", "rock", "soil", "water"};
    return names;
}

const Palette& procedure_palette(Procedure procedure)
{
    return kPalettes[static_cast<std::size_t>(procedure)];
}

double kept_share(double wavelength, double footprint)
{
    return smooth_step(2.0, 4.0, wavelength / std::max(footprint, 1e-12));
}

Pattern evaluate_procedure(Procedure procedure, const Palette& palette, std::uint64_t seed, const Interaction& at, double footprint)
{
    switch (procedure) {
        case Procedure::sand:
            return sand(palette, seed, at, footprint);
        case Procedure::bedrock:
            return bedrock(palette, seed, at, footprint);
        case Procedure::rock:
            return rock(palette, seed, at, footprint);
        case Procedure::soil:
            return soil(palette, seed, at, footprint);
        case Procedure::water:
            return water(palette, seed, at, footprint);
        case Procedure::plain:
            break;
    }
    return {palette[0], Vec3d(0.0), 0.0};
}

double large_scale_variation(std::uint64_t seed, const Vec3d& p, double footprint)
{
    Sum sum;
    sum.add(seed ^ 21, p, 89.0, 0.6, 0.0, footprint);
    sum.add(seed ^ 22, p, 34.0, 0.5, 0.0, footprint);
    sum.add(seed ^ 23, p, 12.7, 0.4, 0.0, footprint);
    return std::clamp(sum.value, -1.0, 1.0);
}

}  // namespace hoodoo
