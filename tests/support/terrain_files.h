// Files that small terrains of the laws are made of, each written once a process into the system's folder for temporary files.
#pragma once

#include <string>

namespace hoodoo::testing
{

/// A lumpy closed body of 320 triangles, as PLY.
const std::string& mesh_path();
/// 13 x 12 x 11 densities of a knotted body with a hole, one number in nine exactly at the surface's level, as .npy.
const std::string& voxel_path();
/// Rugged heights of 37 x 43 samples in 16 bits, with walls and a plateau, as TIFF.
const std::string& heights_path();
/// Bedrock with hills, drifts of sand and two ponds over 37 x 29 columns: an EXR for each of "bedrock", "sand", "water".
const std::string& layer_path(const std::string& layer);

}  // namespace hoodoo::testing
