// Triangles to a file, part by part: a mesh of any size needs no more memory than one part.
#pragma once

#include "terrain/io/polygonise.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// Takes a part and, for each of its vertices, one weight a material (row by row). Indices of triangles count all vertices given so far.
using MeshSink = std::function<void(const MeshPart& part, std::span<const float> weights)>;

/// Writes what `produce` hands to its sink, by the ending of `path`. PLY, binary: x y z nx ny nz and material_NAME, the visible share of each
/// material, as floats. OBJ: positions and normals; each triangle is of the material (usemtl) that has most of it. Atomic. Throws Error (scene) on
/// another ending, Error (file), and what `produce` throws.
void write_mesh_file(const std::string& path, const std::vector<std::string>& materials, const std::function<void(const MeshSink&)>& produce);

}  // namespace hoodoo
