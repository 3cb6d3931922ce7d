// From what a scene says about rocks to lengths, shapes and seed points.
//
// Level of detail: a rock n pixels wide shows half its triangles on n^2 pi / 4 pixels. Measured (tests/laws/rebuild_rocks_test.cpp), with triangles
// as large as a pixel a mesh leaves its rock by up to 1.5 pixels, at the rims of worn faces; at a quarter of the width by less than half a pixel.

#include "terrain/rocks/corner_cubes.h"
#include "terrain/rocks/placement.h"
#include "terrain/rocks/poisson_spheres.h"
#include "terrain/rocks/rock_mesh.h"

#include "terrain/math/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kDefaultShare = 0.93;  // of the saturated radius: reached within milliseconds up to hundreds of rocks
constexpr double kTriangles = 18.0;     // of a rock's mesh on a pixel, from where on a coarser one will do: then it is off by less than half a pixel
constexpr double kSaturatedShare = 0.97;  // of corner cubes, which are filled up: then they hold about as many as asked

}  // namespace

int rocks_per_tile(const RockOptions& options)
{
    if (!options.sites.empty()) return static_cast<int>(options.sites.size());
    return options.per_tile > 0 ? options.per_tile : options.corner_cubes ? 150 : 50;
}

double tile_length(const RockOptions& options)
{
    return options.size * std::cbrt(rocks_per_tile(options) * kPi / 6.0);
}

Vec3d shape_stretch(const RockOptions& options)
{
    return options.shape / std::cbrt(options.shape.x * options.shape.y * options.shape.z);
}

Weathering weathering_for(const RockOptions& options)
{
    // At most 0.3 + ln(40) / 5.5 + 0.1 < 1.1 at a place that sees 40 faces alike, and about 0.9 at a cell's middle, which is 1 r deep at least.
    Weathering w;
    w.depth = 0.16 + 0.14 * options.roundness;
    w.sharpness = 16.0 - 10.5 * options.roundness;
    w.roughness = options.roughness;
    return w;
}

std::unique_ptr<SiteArrangement> make_sites(const RockOptions& options)
{
    const double length = tile_length(options);
    const int count = rocks_per_tile(options);
    const double fits = (options.corner_cubes ? kSaturatedShare : kDefaultShare) * random_packing_radius(count, length);
    const double radius = options.radius.value_or(fits);
    const auto problem = [&](const std::string& what, const std::string& expected) {
        return Error(ErrorKind::scene, Problem{options.where, what, expected, {}, {}});
    };
    if (options.corner_cubes) {
        if (!(length >= CornerCubes::least_length * radius))
            throw problem(fmt::format("corner cubes of {:.4g} m are too small for rocks with a radius of {:.4g} m", length, radius),
                          fmt::format("a radius of at most {:.4g} m, or more rocks a tile", length / CornerCubes::least_length));
        return std::make_unique<CornerCubes>(length, radius, hash_name(options.seed, "sites"));
    }
    std::vector<Vec3d> points;
    if (!options.sites.empty()) {
        for (const Vec3d& p : options.sites) points.push_back(p * length);
    } else {
        points = poisson_spheres(count, length, radius, hash_name(options.seed, "sites"));
        if (static_cast<int>(points.size()) < count)
            throw problem(
                fmt::format("{} rocks with a radius of {:.4g} m do not fit into a tile of {:.4g} m", count, radius, length),
                fmt::format("a radius of at most {:.4g} m, or at most {} rocks a tile", fits, random_packing_count(radius / kDefaultShare, length)));
    }
    return std::make_unique<PeriodicSites>(std::move(points), length, radius, hash_name(options.seed, "keys"));
}

int rock_level(const RockOptions& options, double distance)
{
    if (!options.view) return options.level;
    const Vec3d stretch = shape_stretch(options);
    const double size = options.size * std::max({stretch.x, stretch.y, stretch.z}), pixel = options.view->spread * std::max(0.0, distance - size);
    int level = options.level;
    while (level + 1 < kRockLevels) {
        const double pixels = std::sqrt(2.0 * static_cast<double>(rock_triangles(level + 1)) / (kPi * kTriangles));
        if (!(size <= pixels * pixel)) break;
        ++level;
    }
    return level;
}

}  // namespace hoodoo
