// Triangles from a file.
#pragma once

#include "terrain/error.h"
#include "terrain/shape.h"

#include <string>

namespace hoodoo
{

struct MeshFileOptions {
    bool smooth = true;  ///< normals of the file, or made from the faces around a vertex; false: none, faces are flat
    bool y_up = false;   ///< the file's second axis is its vertical: (x, y, z) becomes (x, -z, y)
};

/// Reads PLY, OBJ or STL (chosen by the ending). Polygons are cut to triangles, points and lines left out, all parts joined into one mesh; vertices
/// keep the file's numbers in single precision (origin is 0, material empty). Only this one file is opened: material libraries an OBJ names are not.
/// Throws Error (file) at `where`: not readable, another format, larger than 2 GB, no triangle, an index or a coordinate that is not valid.
TriangleMesh read_mesh_file(const std::string& path, const MeshFileOptions& options, const Source& where);

}  // namespace hoodoo
