// Terrains to test and to measure on: procedural stacks with everything a height map cannot hold. The same for tests and benchmarks.
#pragma once

#include "terrain/stack/material_stack.h"

#include <memory>
#include <string>
#include <vector>

namespace hoodoo::testing
{

struct TerrainRecipe {
    Vec2i size{1024, 768};
    double cell = 1.0;
    Vec3d origin{0.0};
    std::uint64_t seed = 1;
    double relief = 226.0;    ///< cells, at most 250: heights are whole 32nds of a cell
    bool rugged = true;       ///< false: gentle slopes, fewer overhangs and tunnels
    double overhangs = -1.0;  ///< how far 3-D noise moves the ground, as a share of the relief; -1: 0.12 if rugged, else 0.04
    double gain = -1.0;       ///< of the ground's noise, octave to octave; -1: 0.5 if rugged, else 0.35
    int tunnels = -1;         ///< swept spheres; -1: one to 8700 columns (90 on 1024 x 768)
};

/// fBm, ridges, terraces and canyons for the ground; overhangs where 3-D noise carves or adds matter near it; tunnels of swept spheres. Bedrock with
/// sand on flat ground. Heights are whole multiples of cell / 32.
std::shared_ptr<MaterialStack> make_terrain(const TerrainRecipe& recipe);

/// A square perspective view: `half_width` is the tangent of half its angle.
struct View {
    std::string name;
    Vec3d eye, target;
    double half_width = 0.6;
};

struct BenchTerrain {
    std::shared_ptr<MaterialStack> stack;
    std::vector<View> views;  ///< aerial, canyon, tunnel
};

/// The terrain that intersectors are measured on, cells of 1 m; smaller sizes have less relief, so that slopes stay the same. The rugged
/// one has 5.4 M triangles at a spacing of one cell, and 84% of its columns one run of matter, as in the measurements that the ratios stand against.
BenchTerrain bench_terrain(bool rugged, Vec2i size);

}  // namespace hoodoo::testing
