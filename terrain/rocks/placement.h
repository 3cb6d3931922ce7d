// Rocks wherever a volume holds them: which seed points lie in it, which of those can be seen, and the mesh of each.
#pragma once

#include "terrain/error.h"
#include "terrain/math/interval.h"
#include "terrain/rocks/contacts.h"
#include "terrain/rocks/weathering.h"
#include "terrain/shape.h"

#include <memory>
#include <optional>
#include <vector>

namespace hoodoo
{

/// Where rocks lie. Pure, thread-safe.
class RockVolume
{
public:
    virtual ~RockVolume() = default;
    virtual Box3d bounds() const = 0;  ///< of all that it holds; empty if nothing
    /// Encloses the heights that hold rocks over the rectangle; lo > hi if none do. Metres.
    virtual Interval heights(const Vec2d& lo, const Vec2d& hi) const = 0;
    virtual bool holds(const Vec3d& p) const = 0;
    /// Whether air (or water) lies nearer than `distance`, metres, in any direction.
    virtual bool air_within(const Vec3d& p, double distance) const = 0;
    /// Whether the point lies in matter that rocks rest on.
    virtual bool ground(const Vec3d& p) const = 0;
};

struct RockOptions {
    int per_tile = 0;              ///< 0: 50, or 150 in corner cubes, whose corners would otherwise be most of them
    double size = 1.0;             ///< mean diameter: of the ball with a cell's mean volume, metres
    std::optional<double> radius;  ///< of the Poisson spheres, metres; default 0.93 of what random placing reaches
    int contacts = 6;              ///< about how many a rock has
    double roundness = 0.3;        ///< 0 broken, 1 pebble
    double roughness = 0.05;       ///< amplitude of the detail over `radius`, at most 0.1
    Vec3d shape{1.0};              ///< relative lengths of a mean rock along the axes; only their ratios count
    bool corner_cubes = false;     ///< instead of one tile repeated
    int level = 0;                 ///< of detail, 0 = finest
    std::uint64_t seed = 0;
    std::vector<Vec3d> sites;           ///< given instead, shares of the tile in [0, 1)
    std::vector<Vec3d> contact_points;  ///< given instead, shares of the tile
    Source where;                       ///< for errors
};

/// Rocks a tile is asked to hold.
int rocks_per_tile(const RockOptions& options);
/// Edge of a tile before stretching, metres: its rocks have the asked mean volume.
double tile_length(const RockOptions& options);
/// The factors on x, y, z, product 1.
Vec3d shape_stretch(const RockOptions& options);
/// Depth, rounding and detail for a roundness and a roughness.
Weathering weathering_for(const RockOptions& options);

/// The seed points that the options describe. Throws Error (scene) if they do not fit, and says what does.
std::unique_ptr<SiteArrangement> make_sites(const RockOptions& options);

/// A rock of the arrangement: its field and its mesh, in its own space (the seed point is the origin).
struct Rock {
    std::unique_ptr<RockField> field;
    TriangleMesh mesh;
};
Rock make_rock(const VoronoiCell& cell, const std::vector<Contact>& contacts, double radius, const RockOptions& options);

/// All rocks of one periodic tile, in the order of its sites: what tests and statistics look at.
std::vector<Rock> make_tile(const RockOptions& options);

/// The rocks that `volume` holds and that air can see, of material `rock`. The arrangement is anchored at `anchor`. Rocks that would touch neither
/// another rock nor the ground are left out. Throws Error (scene) as make_sites, and if there would be more than 5e6.
Instances place_rocks(const RockOptions& options, const RockVolume& volume, const Vec3d& anchor);

}  // namespace hoodoo
