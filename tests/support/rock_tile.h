// A tile of rocks with everything known about it, for the laws of rocks.
#pragma once

#include "terrain/rocks/placement.h"
#include "tests/support/surface_laws.h"

#include <memory>
#include <vector>

namespace hoodoo::testing
{

struct RockTile {
    RockOptions options;
    double length = 0.0, radius = 0.0;  ///< before stretching
    Vec3d stretch{1.0};
    std::vector<Vec3d> points;  ///< before stretching
    std::vector<VoronoiCell> cells;
    std::vector<std::vector<Contact>> contacts;
    std::vector<std::unique_ptr<RockField>> fields;
    std::vector<TriangleMesh> meshes;

    /// Where the rock across a face or contact lies, relative to rock i.
    Vec3d offset(std::size_t i, const SiteId& neighbour) const
    {
        return (points[neighbour.index] + Vec3d(neighbour.tile) * length - points[i]) * stretch;
    }
};
RockTile make_rock_tile(const RockOptions& options);

/// Cells fill the tile.
Verdict volumes_fill_the_tile(const RockTile& tile);
/// No two points, copies in the 26 tiles around included, are nearer than two radii.
Verdict points_keep_their_distance(const RockTile& tile);
/// A face has its twin in the neighbour's list: the same area, the opposite normal.
Verdict faces_have_twins(const RockTile& tile);
/// Phi is 0 at a contact for the rock and for its neighbour, which knows the same point.
Verdict contacts_are_shared(const RockTile& tile);
/// At random points at most one rock is there; vertices and points on triangles lie outside of every neighbour.
Verdict rocks_keep_out(const RockTile& tile, int samples);
/// Each edge twice, in opposite directions; Euler characteristic 2; positive volume.
Verdict meshes_are_closed(const RockTile& tile);
/// At least 90% of the contacts have both meshes within 0.02 r.
Verdict contacts_are_reached(const RockTile& tile);

/// Distance of a point to a mesh, metres.
double distance_to(const TriangleMesh& mesh, const Vec3d& p);

}  // namespace hoodoo::testing
