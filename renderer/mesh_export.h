// A terrain of a scene as triangles in a file, for other programs.
#pragma once

#include "renderer/render.h"
#include "terrain/io/polygonise.h"

#include <string>

namespace hoodoo
{

struct MeshExportOptions {
    std::string terrain;   ///< its name; may be empty where there is only one
    double spacing = 0.0;  ///< metres between samples; 0: a column of a layer stack, else a 512th of the longest side
    std::function<void(double fraction, const std::string& what)> progress;
};

struct MeshExportReport : PolygoniseReport {
    double spacing = 0.0;                ///< metres, as used
    std::uint64_t without_material = 0;  ///< vertices at which no material was found: all their weights are 0
};

/// Polygonises every field of the terrain (a body of rocks beside its ground is one of its own) and writes .ply or .obj (terrain/io/mesh_writer.h).
/// Weights of materials are what the surface itself says of the place. Throws Error (scene): no such terrain, or one without a field; Error (file).
MeshExportReport export_mesh(const LoadedScene& loaded, const std::string& path, const MeshExportOptions& options);

}  // namespace hoodoo
