// The branching path a tool is swept along: a graph, its smooth arcs, and a frame at every step.
#pragma once

#include "terrain/math/vec.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hoodoo
{

/// Nodes are places in the world; an arc visits one or more of them, by number. Arcs meet where they share a node.
struct Skeleton {
    std::vector<Vec3d> nodes;
    std::vector<std::vector<std::size_t>> arcs;
};

/// A step of an arc.
struct SkeletonStep {
    Vec3d at{0.0};
    double node = 0.0;   ///< place along the arc, counted in its nodes: 1.5 is half way (in parameter) between its second and third
    Vec3d tangent{0.0};  ///< unit, forwards
    Vec3d normal{0.0};   ///< unit, across the tangent
    Vec3d across() const { return tangent.cross(normal); }  ///< to the right for one who looks along the tangent with the normal up
};

using SkeletonPath = std::vector<SkeletonStep>;

/// The arc's places, at most about `step` apart: a curve through its nodes, or straight pieces between them. No frames yet. Repeated nodes are
/// allowed only if they lie apart along the arc. An arc of one node is one step.
SkeletonPath arc_steps(const Skeleton& skeleton, std::size_t arc, double step, bool smooth);

/// Tangents, and normals that turn about the tangent as little as possible, starting from the part of `first` across the first tangent.
void frame_minimally(SkeletonPath& path, const Vec3d& first);

/// Normals as near as possible to `wanted` (one a step); where a tangent is parallel to it, the last normal is carried on.
void frame_towards(SkeletonPath& path, const std::vector<Vec3d>& wanted);

/// Where two pieces of the skeleton meet that share no node.
struct Crossing2 {
    std::size_t arc, other;
    Vec3d at;
};

/// The first place where arcs come nearer than `tolerance` to one another or to themselves without a common node. With `along` (unit) distances are
/// measured across that direction only, as for a skeleton that is projected along it.
std::optional<Crossing2> find_crossing(const Skeleton& skeleton, bool smooth, double tolerance, const std::optional<Vec3d>& along);

}  // namespace hoodoo
