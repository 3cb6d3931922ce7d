// Rocks wherever a volume holds them: which seed points lie in it, which of those can be seen, and the mesh of each.
#pragma once

#include "terrain/error.h"
#include "terrain/math/interval.h"
#include "terrain/rocks/contacts.h"
#include "terrain/rocks/weathering.h"
#include "terrain/shape.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hoodoo
{

/// Where rocks lie. Pure, thread-safe.
class RockVolume
{
public:
    virtual ~RockVolume() = default;
    virtual Box3d bounds() const = 0;  ///< of all that it holds; empty if nothing
    /// Of all that it may come to hold while it is edited.
    virtual Box3d room() const { return bounds(); }
    /// Encloses the heights that hold rocks over the rectangle; lo > hi if none do. Metres.
    virtual Interval heights(const Vec2d& lo, const Vec2d& hi) const = 0;
    virtual bool holds(const Vec3d& p) const = 0;
    /// Whether air (or water) lies nearer than `distance`, metres, in any direction.
    virtual bool air_within(const Vec3d& p, double distance) const = 0;
    /// Whether the point lies in matter that rocks rest on.
    virtual bool ground(const Vec3d& p) const = 0;
};

/// Where rocks are seen from: far ones need fewer triangles.
struct RockView {
    Vec3d eye{0.0};
    double spread = 0.0;  ///< width of a pixel a metre of distance
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
    std::optional<RockView> view;  ///< rocks far from it are coarser than `level`, by rock_level(); absent: none is
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

/// The level of detail of a rock at `distance` from the eye, metres: the coarsest with 18 triangles or more a pixel, but no finer than
/// options.level. Where it changes no eye can tell: the two meshes differ by less than half a pixel (tests measure it).
int rock_level(const RockOptions& options, double distance);

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

/// A part of the plane, metres.
struct Rectangle {
    Vec2d lo{0.0}, hi{0.0};
};

/// The rocks of a volume that changes. Not while other threads use them.
class RockPlacement
{
public:
    /// `volume` is asked again whenever it changed. Throws as place_rocks.
    RockPlacement(RockOptions options, std::shared_ptr<const RockVolume> volume, const Vec3d& anchor);
    ~RockPlacement();
    RockPlacement(const RockPlacement&) = delete;
    RockPlacement& operator=(const RockPlacement&) = delete;

    /// All of them. To be called once.
    Instances place();

    /// Makes `rocks`, which place() or follow() made, what place() would make now that the volume changed over `changed` and nowhere else: bit by
    /// bit, but for the seconds it took. Its cost follows the rectangles, but for a copy of the list; corner cubes are placed anew, all of them.
    /// Throws Error (scene) if there are more than 5e6 now: `rocks` is then as it was.
    InstanceChange follow(std::span<const Rectangle> changed, Instances& rocks);

    /// How far from its seed point, horizontally, a rock of the periodic tile depends on the volume, metres.
    double reach() const;

    /// How far rocks may stick out of what holds them, metres.
    double overhang() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hoodoo
