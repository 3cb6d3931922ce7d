// A vertical line meets a convex shape in one interval, and a convex shape moved along a straight line is convex: so a column sees one interval for
// each part of the line, found from shapes placed close to one another.
// Peytavie2009, sections 4.3 and 4.4, characterise tools by their region of influence R and leave its shapes open: here balls, boxes and capsules.
// Places stand at most an eighth of the shape's width apart (and no closer than an eighth of a cell): the union of balls of radius r at the distance
// h falls short of the tube by h^2 / (8 r), so by less than 1% of r. Roughness: the wall's distance from the middle is multiplied by 1 + roughness
// n(p / wavelength), n the noise sum over its bound, p the wall point above (below) the middle. Deviation: a column belongs to the region as its
// middle line does. Missing: free meshes as tools.
#include "terrain/edit/region.h"

#include "terrain/math/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace hoodoo
{

namespace
{

struct Chord {
    double low, high, distance;  ///< heights relative to the shape's middle; distance as in ColumnSpan
};

std::optional<Chord> ball_chord(const Vec2d& d, double radius)
{
    const double rho2 = d.length2();
    if (rho2 >= radius * radius) return std::nullopt;
    const double half = std::sqrt(radius * radius - rho2);
    return Chord{-half, half, std::sqrt(rho2) / radius};
}

std::optional<Chord> box_chord(const Vec2d& d, const Vec3d& half_size, double heading)
{
    const double c = std::cos(heading), s = std::sin(heading);
    const double out = std::max(std::abs(c * d.x + s * d.y) / half_size.x, std::abs(c * d.y - s * d.x) / half_size.y);
    if (out >= 1.0) return std::nullopt;
    return Chord{-half_size.z, half_size.z, out};
}

/// The capsule is a ball moved along its core from -axis/2 to axis/2: the hull of the chords of its two end balls and of the cylinder between.
std::optional<Chord> capsule_chord(const Vec2d& d, double radius, const Vec3d& axis)
{
    // The distance of the vertical line from the core's line is least at u in [-1/2, 1/2]; heights follow from the quadratic |p - core| = radius.
    const Vec2d flat(axis.x, axis.y);
    const double flat2 = flat.length2();
    const double nearest = flat2 > 0.0 ? std::clamp((d ^ flat) / flat2, -0.5, 0.5) : 0.0;
    const double rho2 = (d - flat * nearest).length2();
    if (rho2 >= radius * radius) return std::nullopt;
    Chord chord{kInfinity, -kInfinity, std::sqrt(rho2) / radius};
    for (const double u : {-0.5, 0.5}) {
        if (const auto end = ball_chord(d - flat * u, radius)) {
            chord.low = std::min(chord.low, axis.z * u + end->low);
            chord.high = std::max(chord.high, axis.z * u + end->high);
        }
    }
    // Points of the cylinder: |w|^2 - (w.axis)^2 / |axis|^2 = radius^2 with w = (d, z), as far as they lie beside the core.
    const double length2 = axis.length2(), side = d ^ flat;
    const double a = 1.0 - axis.z * axis.z / length2, b = -side * axis.z / length2, c = d.length2() - side * side / length2 - radius * radius;
    const double root2 = b * b - a * c;
    if (length2 > 0.0 && a > 1e-12 && root2 >= 0.0) {
        for (const double z : {(-b - std::sqrt(root2)) / a, (-b + std::sqrt(root2)) / a}) {
            if (std::abs(side + z * axis.z) > 0.5 * length2) continue;
            chord.low = std::min(chord.low, z);
            chord.high = std::max(chord.high, z);
        }
    }
    return chord.low < chord.high ? std::optional(chord) : std::nullopt;
}

/// One place of the shape on its way.
struct Placed {
    Vec3d middle;
    double radius;
};

class Rasteriser
{
public:
    Rasteriser(const MaterialStack& stack, const Region& region) : stack_(stack), region_(region) {}

    std::vector<ColumnSpan> spans()
    {
        for (std::size_t k = 0; k < region_.points.size(); ++k) {
            if (k + 1 < region_.points.size() || region_.points.size() == 1) part(k, std::min(k + 1, region_.points.size() - 1));
        }
        std::sort(all_.begin(), all_.end(), [](const ColumnSpan& a, const ColumnSpan& b) {
            return std::tie(a.column.y, a.column.x, a.low, a.high) < std::tie(b.column.y, b.column.x, b.low, b.high);
        });
        std::vector<ColumnSpan> joined;
        for (const ColumnSpan& span : all_) {
            if (joined.empty() || joined.back().column != span.column || span.low > joined.back().high) {
                joined.push_back(span);
                continue;
            }
            joined.back().high = std::max(joined.back().high, span.high);
            joined.back().distance = std::min(joined.back().distance, span.distance);
        }
        return joined;
    }

private:
    double radius(std::size_t k) const
    {
        if (region_.shape == Region::Shape::box) return 1.0;
        return region_.radii.size() == 1 ? region_.radii[0] : region_.radii[k];
    }
    double width(double radius) const { return region_.shape == Region::Shape::box ? std::min(region_.half_size.x, region_.half_size.y) : radius; }
    Vec2d reach(double radius) const
    {
        const double grown = 1.0 + region_.roughness;
        if (region_.shape == Region::Shape::box) return Vec2d(std::hypot(region_.half_size.x, region_.half_size.y)) * grown;
        if (region_.shape == Region::Shape::ball) return Vec2d(radius) * grown;
        return (Vec2d(radius) + Vec2d(std::abs(region_.axis.x), std::abs(region_.axis.y)) / 2.0) * grown;
    }

    void part(std::size_t from, std::size_t to)
    {
        const Vec3d way = region_.points[to] - region_.points[from];
        const double step = std::max(std::min(width(radius(from)), width(radius(to))) / 4.0, stack_.cell() / 8.0);
        const double count = std::max(1.0, std::ceil(way.length() / step));
        if (!(count < 1e6)) throw Error(ErrorKind::scene, "a tool's way takes more than 1e6 steps");
        std::vector<ColumnSpan> of_part;
        for (int n = 0; n <= (from == to ? 0 : static_cast<int>(count)); ++n) {
            const double u = n / count;
            place({region_.points[from] + way * u, radius(from) + (radius(to) - radius(from)) * u}, of_part);
        }
        // The hull of what one straight part leaves in a column: sorted, then merged column by column.
        std::sort(of_part.begin(), of_part.end(),
                  [](const ColumnSpan& a, const ColumnSpan& b) { return std::tie(a.column.y, a.column.x) < std::tie(b.column.y, b.column.x); });
        for (std::size_t a = 0; a < of_part.size();) {
            ColumnSpan hull = of_part[a];
            for (++a; a < of_part.size() && of_part[a].column == hull.column; ++a) {
                hull.low = std::min(hull.low, of_part[a].low);
                hull.high = std::max(hull.high, of_part[a].high);
                hull.distance = std::min(hull.distance, of_part[a].distance);
            }
            all_.push_back(hull);
        }
    }

    void place(const Placed& shape, std::vector<ColumnSpan>& spans) const
    {
        const double cell = stack_.cell();
        const Vec3d c = shape.middle - stack_.origin();
        const Vec2d r = reach(shape.radius);
        const auto first = [cell](double x, int n) { return static_cast<int>(std::clamp(std::ceil(x / cell - 0.5), 0.0, static_cast<double>(n))); };
        for (int j = first(c.y - r.y, stack_.size().y); j < stack_.size().y && (j + 0.5) * cell <= c.y + r.y; ++j) {
            for (int i = first(c.x - r.x, stack_.size().x); i < stack_.size().x && (i + 0.5) * cell <= c.x + r.x; ++i) {
                const Vec2d d((i + 0.5) * cell - c.x, (j + 0.5) * cell - c.y);
                if (const auto chord = rough_chord(shape, d))
                    spans.push_back({{i, j}, shape.middle.z + chord->low, shape.middle.z + chord->high, chord->distance});
            }
        }
    }

    std::optional<Chord> chord(double radius, const Vec2d& d) const
    {
        switch (region_.shape) {
            case Region::Shape::box:
                return box_chord(d, region_.half_size, region_.heading);
            case Region::Shape::capsule:
                return capsule_chord(d, radius, region_.axis);
            default:
                return ball_chord(d, radius);
        }
    }

    /// Noise scales the shape, once for the wall above and once for the one below.
    std::optional<Chord> rough_chord(const Placed& shape, const Vec2d& d) const
    {
        if (!(region_.roughness > 0.0)) return chord(shape.radius, d);
        const Fractal fractal{4.0, 2.0, 0.5};
        const double scale = 2.0 * region_.roughness / fbm_bound(kNoise3Bound, fractal).value;
        const auto scaled = [&](bool up) -> std::optional<Chord> {
            const std::optional<Chord> even = chord(shape.radius, d);
            const double z = even ? (up ? even->high : even->low) : 0.0;
            const Vec3d wall = shape.middle + Vec3d(d.x, d.y, z);
            const double n = scale * fbm(wall / region_.wavelength, region_.seed, fractal).value;
            const double grown = 1.0 + std::clamp(n, -region_.roughness, region_.roughness);
            auto rough = chord(shape.radius, d / grown);
            if (rough) *rough = {rough->low * grown, rough->high * grown, rough->distance};
            return rough;
        };
        const auto above = scaled(true), below = scaled(false);
        if (!above && !below) return std::nullopt;
        const double middle = above ? (above->low + above->high) / 2.0 : (below->low + below->high) / 2.0;
        const Chord both{below ? below->low : middle, above ? above->high : middle,
                         std::min(above ? above->distance : 1.0, below ? below->distance : 1.0)};
        return both.low < both.high ? std::optional(both) : std::nullopt;
    }

    const MaterialStack& stack_;
    const Region& region_;
    std::vector<ColumnSpan> all_;
};

}  // namespace

std::vector<ColumnSpan> column_spans(const MaterialStack& stack, const Region& region)
{
    return Rasteriser(stack, region).spans();
}

std::vector<Parameter> region_parameters()
{
    return {
        {.name = "points",
         .type = ParameterType::points,
         .doc = "Where the region's middle is; several points are a line along which it moves.",
         .required = true,
         .unit = "m",
         .min_count = 1,
         .max_count = 100000},
        {.name = "drape",
         .type = ParameterType::boolean,
         .doc = "Whether the heights of the points count from the top of the ground below them, all along the line.",
         .fallback = false},
        {.name = "region",
         .type = ParameterType::choice,
         .doc = "Its shape.",
         .fallback = std::string("ball"),
         .choices = {"ball", "box", "capsule"}},
        {.name = "radius",
         .type = ParameterType::vector,
         .doc = "Of a ball or capsule: one, or one for each point.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 100000},
        {.name = "half_size",
         .type = ParameterType::vector,
         .doc = "Of a box: half its lengths along x, y, z.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 3,
         .max_count = 3},
        {.name = "heading",
         .type = ParameterType::angle,
         .doc = "Turns a box about the vertical, counter-clockwise.",
         .fallback = 0.0,
         .unit = "rad"},
        {.name = "axis",
         .type = ParameterType::vector,
         .doc = "Of a capsule: from the middle of one of its round ends to that of the other.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "roughness",
         .type = ParameterType::number,
         .doc = "Share of the region's size by which noise moves its wall.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 0.95},
        {.name = "wavelength",
         .type = ParameterType::length,
         .doc = "Size of that noise; the region's own by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
}

namespace
{

/// The line with its heights counted from the top of the stack (water left out) below it, in steps of two cells at most.
void drape(const MaterialStack& stack, Region& region)
{
    const auto top = [&](const Vec3d& p) {
        const auto place = [&](double x, int n) { return static_cast<int>(std::clamp(std::floor(x / stack.cell()), 0.0, n - 1.0)); };
        const Vec3d local = p - stack.origin();
        const auto words = stack.words(place(local.x, stack.size().x), place(local.y, stack.size().y));
        std::int32_t units = 0;
        for (const std::uint16_t word : words) {
            if (MaterialStack::material_of(word) != Material::water) units = MaterialStack::top_of(word);
        }
        return stack.origin().z + units * stack.unit();
    };
    Region draped = region;
    draped.points.clear();
    draped.radii.clear();
    const auto add = [&](std::size_t from, std::size_t to, double u) {
        const Vec3d p = region.points[from] + (region.points[to] - region.points[from]) * u;
        draped.points.push_back(p + Vec3d(0, 0, top(p)));
        if (region.radii.size() > 1) draped.radii.push_back(region.radii[from] + (region.radii[to] - region.radii[from]) * u);
    };
    add(0, 0, 0.0);
    for (std::size_t k = 0; k + 1 < region.points.size(); ++k) {
        const Vec3d way = region.points[k + 1] - region.points[k];
        const double count = std::max(1.0, std::ceil(std::hypot(way.x, way.y) / (2.0 * stack.cell())));
        if (!(count + static_cast<double>(draped.points.size()) < 1e6)) throw Error(ErrorKind::scene, "a tool's way takes more than 1e6 steps");
        for (int n = 1; n <= count; ++n) add(k, k + 1, n / count);
    }
    if (region.radii.size() == 1) draped.radii = region.radii;
    region = std::move(draped);
}

}  // namespace

Region region_of(const MaterialStack& stack, const Values& edit, std::uint64_t seed)
{
    Region region;
    const std::string& shape = edit.text("region");
    region.shape = shape == "box" ? Region::Shape::box : shape == "capsule" ? Region::Shape::capsule : Region::Shape::ball;
    const auto belongs = [&](const char* key, bool wanted) {
        if (edit.has(key) == wanted) return;
        throw edit.problem(key, fmt::format("a region of shape \"{}\"", shape), fmt::format("{} `{}`", wanted ? "its" : "no", key));
    };
    const bool box = region.shape == Region::Shape::box;
    belongs("radius", !box);
    belongs("half_size", box);
    belongs("axis", region.shape == Region::Shape::capsule);
    region.points = edit.points("points");
    if (box) region.half_size = edit.vec3("half_size");
    if (!box) region.radii = edit.vector("radius");
    if (edit.has("axis")) region.axis = edit.vec3("axis");
    if (!box && region.radii.size() != 1 && region.radii.size() != region.points.size()) {
        throw edit.problem("radius", "radii of a region", fmt::format("one, or one for each of the {} points", region.points.size()),
                           fmt::to_string(region.radii.size()));
    }
    region.heading = edit.number("heading");
    region.roughness = edit.number("roughness");
    region.wavelength = edit.has("wavelength") ? edit.number("wavelength") : box ? region.half_size.x : region.radii[0];
    region.seed = static_cast<std::uint32_t>(seed);
    if (edit.boolean("drape")) drape(stack, region);
    return region;
}

Error outside_the_terrain(const MaterialStack& stack, const Values& edit, const std::string& key)
{
    const Vec3d low = stack.origin(), high = low + Vec3d(stack.size().x, stack.size().y, 0) * stack.cell();
    return edit.problem(key, "the tool lies outside the terrain", fmt::format("x in [{}, {}] m and y in [{}, {}] m", low.x, high.x, low.y, high.y));
}

}  // namespace hoodoo
