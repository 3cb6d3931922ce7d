// Skeletons with flesh, and what can be done with them: a tree of implicit solids to build with and to carve with.
#pragma once

#include "terrain/fields/blob_node.h"
#include "terrain/fields/warp.h"

#include <span>

namespace hoodoo
{

// -- Skeletal primitives: the signed distance from a skeleton less a radius, metres; 1-Lipschitz
// ------------------------------------------------------ `material` is a number for BlobShares, or kNoSource.

/// A path of straight pieces along which the radius changes evenly; one point is a ball. As many radii (above 0) as points.
BlobPtr blob_curve(std::vector<Vec3d> points, std::vector<double> radii, std::int32_t material);

/// A flat round disc of radius `extent`, with rounded rim: all within `radius` of it. `normal` has a length.
BlobPtr blob_disc(const Vec3d& centre, const Vec3d& normal, double extent, double radius, std::int32_t material);

/// All within `radius` of a plane polygon, convex or not, without crossings of its own. Corners in one plane.
BlobPtr blob_polygon(std::vector<Vec3d> corners, double radius, std::int32_t material);

/// A cross section moved along a path of straight pieces, mitred where they meet and cut off flat at the ends. `profile`: corners of a polygon
/// without crossings, x to the right when one looks along the path, y up (+z as far as possible at the start, then turning as little as it can);
/// `scales` one a point, above 0. At least 2 points, neighbours apart; no turn of more than 120 degrees. The slope is at most sqrt(1 + (profile's
/// reach * change of scale a metre)^2).
BlobPtr blob_sweep(std::vector<Vec3d> points, std::vector<double> scales, std::vector<Vec2d> profile, std::int32_t material);

// -- Operators ---------------------------------------------------------------------------------------------------------

enum class BlobOperator { unite, intersect, subtract };

/// min, max, or max(first, -others). With a width above 0 (metres) the edge where two values are nearer than it to each other is filled by a
/// parabola: the minimum of two comes out at most width / 4 lower, and is smooth. Nothing has influence beyond the width. At least one node.
BlobPtr blob_combine(BlobOperator what, std::vector<BlobPtr> nodes, double width);

/// A node carried along a flow (Gamito2001; Wyvill1999 calls it a warp).
BlobPtr blob_warp(BlobPtr node, Warp warp, double duration);

/// A node whose surface is moved by noise: F + amplitude n(p / wavelength), n a sum of octaves scaled to [-1, 1]. No point of it moves farther than
/// the amplitude where the node's own slope is 1.
struct BlobNoise {
    double amplitude = 0.1, wavelength = 1.0, octaves = 4.0, gain = 0.5;
    std::uint32_t seed = 0;
    Vec3d origin{0.0};
};
BlobPtr blob_noise(BlobPtr node, const BlobNoise& noise);

/// Another terrain: its field times `scale` (metres a unit of it), found in `bounds`. `number` counts the tree's terrains.
BlobPtr blob_terrain(std::shared_ptr<const Field> field, const Box3d& bounds, double scale, std::int32_t number);

}  // namespace hoodoo
