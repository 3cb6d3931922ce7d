// A mask is a smooth step of one number at a place: how steep it is, how high, or what a map says there (`hoodoo analyse` makes maps). Appearances
// are mixed by it: "sand where it is flat and wet" are two masks into sand, which multiply. Maps are read once, sampled bilinearly, and hold their
// edge beyond it. Missing: filtering by the footprint (a map is as coarse as an elevation model).
#include "renderer/shading/mask.h"

#include "terrain/error.h"
#include "terrain/io/raster.h"
#include "terrain/math/smoothstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

struct Map {
    Raster raster;
    Vec2d origin;
    double cell;  ///< of a pixel, metres; of the whole image where uv
    bool uv;      ///< looked up by the surface's own coordinates, in which it repeats

    double at(const Interaction& where) const { return uv ? repeated(where.uv) : clamped({where.position.x, where.position.y}); }

    double clamped(const Vec2d& p) const
    {
        const auto place = [](double x, int n) { return std::clamp(x, 0.0, n - 1.0); };
        const double x = place((p.x - origin.x) / cell - 0.5, raster.columns), y = place((p.y - origin.y) / cell - 0.5, raster.rows);
        return between(static_cast<int>(x), static_cast<int>(y), x - std::floor(x), y - std::floor(y));
    }

    double repeated(const Vec2d& p) const
    {
        const auto place = [](double x, int n) { return (x - std::floor(x)) * n - 0.5; };
        const double x = place((p.x - origin.x) / cell, raster.columns), y = place((p.y - origin.y) / cell, raster.rows);
        return between(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), x - std::floor(x), y - std::floor(y));
    }

    /// Between the pixels (i, j) and (i + 1, j + 1), row 0 at the bottom.
    double between(int i, int j, double u, double v) const
    {
        const auto index = [&](int k, int n) { return uv ? (k % n + n) % n : std::clamp(k, 0, n - 1); };
        const auto value = [&](int column, int row) {
            const int c = index(column, raster.columns), r = raster.rows - 1 - index(row, raster.rows);
            return static_cast<double>(
                raster.channels[0][static_cast<std::size_t>(r) * static_cast<std::size_t>(raster.columns) + static_cast<std::size_t>(c)]);
        };
        return (value(i, j) * (1 - u) + value(i + 1, j) * u) * (1 - v) + (value(i, j + 1) * (1 - u) + value(i + 1, j + 1) * u) * v;
    }
};

struct Mask {
    enum class By : std::uint8_t { slope, altitude, map } by;
    double from, to;
    std::shared_ptr<const Map> map;

    /// 0 at `from`, 1 at `to`, whichever is larger.
    double share(const Interaction& at) const
    {
        const double x = by == By::slope ? std::acos(std::clamp(at.geometric_normal.z, -1.0, 1.0)) : by == By::altitude ? at.position.z : map->at(at);
        return smoothstep((x - from) / (to - from));
    }
};

class MaskedLook final : public Look
{
public:
    struct Cover {
        std::string name;
        std::vector<Mask> masks;
        std::unique_ptr<Look> look;
    };
    MaskedLook(std::unique_ptr<Look> ground, std::vector<Cover> covers) : ground_(std::move(ground)), covers_(std::move(covers)) {}

    Appearance appearance(const Interaction& at, double footprint) const override
    {
        Appearance a = ground_->appearance(at, footprint);
        for (const Cover& cover : covers_) {
            double share = 1.0;
            for (const Mask& mask : cover.masks) share *= mask.share(at);
            if (!(share > 0.0)) continue;
            const Appearance b = cover.look->appearance(at, footprint);
            const auto s = static_cast<float>(share);
            a.albedo += (b.albedo - a.albedo) * s;
            a.roughness += (b.roughness - a.roughness) * s;
            a.coat += (b.coat - a.coat) * s;
            // Both lie in the hemisphere of the geometric normal, so their sum is not 0 and does too.
            a.normal = (a.normal + (b.normal - a.normal) * share).normalized();
        }
        return a;
    }

private:
    std::unique_ptr<Look> ground_;
    std::vector<Cover> covers_;
};

Mask mask_from(const Values& values, const PathResolver& resolve)
{
    const std::string& by = values.variant();
    Mask mask{by == "slope"      ? Mask::By::slope
              : by == "altitude" ? Mask::By::altitude
                                 : Mask::By::map,
              values.number("from"),
              values.number("to"),
              {}};
    if (mask.from == mask.to)
        throw values.problem("to", "a mask that goes from a value to itself", "two values that differ", fmt::format("{:.6g} twice", mask.to));
    if (mask.by != Mask::By::map) return mask;
    const std::string path = resolve ? resolve(values.text("map"), values.where("map")) : values.text("map");
    Map map{read_raster(path, values.text("channel")), values.vec2("origin"), 0.0, values.text("projection") == "uv"};
    map.cell = map.uv ? values.number("span") : values.has("cell") ? values.number("cell") : map.raster.cell;
    if (!(map.cell > 0.0))
        throw values.problem("map", "the map does not say how large its pixels are", "a `cell` in the mask, or an image with hoodoo:cell");
    for (const float x : map.raster.channels[0])
        if (!std::isfinite(x)) throw values.problem("map", "a sample of the map is no number", "finite samples", fmt::format("{}", x));
    mask.map = std::make_shared<Map>(std::move(map));
    return mask;
}

}  // namespace

std::vector<Schema> mask_schemas()
{
    const Parameter into{.name = "into", .type = ParameterType::text, .doc = "The material that shows where the mask is 1.", .required = true};
    const auto limit = [](const char* name, ParameterType type, const char* doc, const char* unit) {
        return Parameter{.name = name, .type = type, .doc = doc, .required = true, .unit = unit};
    };
    const char *low = "Here the mask is 0; larger than `to` turns it round.", *high = "Here it is 1.";
    return {
        {"slope",
         "By the angle between the surface and the horizontal; above 90 degrees for ceilings.",
         {into, limit("from", ParameterType::angle, low, ""), limit("to", ParameterType::angle, high, "")}},
        {"altitude", "By the height above 0.", {into, limit("from", ParameterType::length, low, "m"), limit("to", ParameterType::length, high, "m")}},
        {"map",
         "By a channel of an image over the ground, such as those of `hoodoo analyse`.",
         {into,
          limit("from", ParameterType::number, low, ""),
          limit("to", ParameterType::number, high, ""),
          {.name = "map", .type = ParameterType::path, .doc = "The image.", .required = true},
          {.name = "channel", .type = ParameterType::text, .doc = "Its channel.", .fallback = std::string("wetness")},
          {.name = "origin",
           .type = ParameterType::vector,
           .doc = "World x and y of the image's lower left corner.",
           .fallback = std::vector<double>{0, 0},
           .unit = "m",
           .min_count = 2,
           .max_count = 2},
          {.name = "cell",
           .type = ParameterType::length,
           .doc = "Size of its pixels; by default what the file says.",
           .unit = "m",
           .minimum = 0,
           .above_minimum = true},
          {.name = "projection",
           .type = ParameterType::choice,
           .doc = "plan: the image lies over the ground; uv: it follows the surface's own coordinates, which a warp carries along, and repeats.",
           .fallback = std::string("plan"),
           .choices = {"plan", "uv"}},
          {.name = "span",
           .type = ParameterType::number,
           .doc = "uv: side of the square that the image covers, in units of u and v (on a canyon: cells).",
           .fallback = 1.0,
           .minimum = 0,
           .above_minimum = true}}},
    };
}

std::unique_ptr<Look> with_masks(std::unique_ptr<Look> look, const Values& material, const PathResolver& resolve, const PlainLook& plain)
{
    std::vector<MaskedLook::Cover> covers;
    for (const Values& values : material.tables("mask")) {
        const std::string& into = values.text("into");
        auto cover = std::find_if(covers.begin(), covers.end(), [&](const MaskedLook::Cover& c) { return c.name == into; });
        if (cover == covers.end()) cover = covers.insert(covers.end(), {into, {}, plain(into)});
        cover->masks.push_back(mask_from(values, resolve));
    }
    if (covers.empty()) return look;
    return std::make_unique<MaskedLook>(std::move(look), std::move(covers));
}

}  // namespace hoodoo
