// Tunnels, ravines and fractures: cross sections swept along a branching skeleton (Peytavie2009, section 4.2).
#pragma once

#include "terrain/edit/profile_curve.h"
#include "terrain/edit/skeleton.h"
#include "terrain/edit/swept.h"
#include "terrain/stack/convolution.h"

namespace hoodoo
{

/// What a node of the skeleton says about the tool there.
struct SweepNode {
    std::size_t profile = 0;  ///< into SweepTool::profiles
    double scale = 1.0;       ///< of the profile
    double roll = 0.0;        ///< radians about the tangent, from the normal towards the right
};

/// A tool in the world, metres. Between nodes profile, scale and roll change evenly.
struct SweepTool {
    Skeleton skeleton;
    std::vector<SweepNode> nodes;  ///< one a node of the skeleton
    std::vector<Profile2> profiles;
    bool smooth = true;      ///< arcs are curves, not straight pieces
    bool carried = true;     ///< frames turn as little as possible; otherwise the normal is up, or the surface's, everywhere
    bool round_ends = true;  ///< free ends are round, not cut off; where arcs meet they always are
    double roughness = 0.0;  ///< share of its distance from the skeleton by which noise moves the wall, in [0, 1)
    double wavelength = 1.0;
    double bedding = 1.0;  ///< how many times flatter than wide the noise is: ledges
    std::uint32_t seed = 0;
};

/// Moves a place onto a surface.
using Projection = std::function<Vec3d(const Vec3d&)>;

/// The tubes of the tool, arc by arc. With `projection` the skeleton is laid onto the surface of `field` first and its normals are that surface's;
/// without, normals begin upwards. `cell` says how fine is fine enough. Throws Error (scene) if it would take more than 1e6 rings.
std::vector<std::vector<Ring>> sweep_rings(const SweepTool& tool, double cell, const ConvolutionField* field, const Projection& projection);

}  // namespace hoodoo
