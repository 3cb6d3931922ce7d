// Voxels from files: NumPy's arrays and OpenVDB's grids.
#pragma once

#include "terrain/error.h"
#include "terrain/fields/voxel_grid.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hoodoo
{

/// What a file's numbers mean.
enum class VoxelMeaning {
    automatic,  ///< what a VDB grid says of itself (a level set: distance); else density
    density,    ///< matter where the number is above `iso`
    distance,   ///< metres from the surface, matter where it is below `iso`
};

struct VoxelFileOptions {
    std::string array;  ///< of an .npz or .vdb; empty: the only one
    VoxelMeaning meaning = VoxelMeaning::automatic;
    std::optional<double> iso;    ///< 1/2 for densities, 0 for distances
    std::optional<double> cell;   ///< metres between samples; a VDB grid has its own, of which this is a change
    std::optional<Vec3d> origin;  ///< where sample (0, 0, 0) of the file stands; a VDB grid has its own
    std::string material_array;   ///< of an .npz: indices into `materials`; empty: none
    std::vector<std::string> materials{"bedrock"};
};

/// Reads .npy, .npz (arrays [i, j, k], i along x, k upwards) or .vdb (float or double), trimmed to what the surface needs. An .npy is read slice by
/// slice. Around the samples there is air. Throws Error (file) for what is wrong with the file (not three axes, numbers that are not finite, a
/// transform that turns, a name it does not have), Error (scene) at `where` for what the options cannot be.
VoxelGrid read_voxel_file(const std::string& path, const VoxelFileOptions& options, const Source& where);

/// The same for .vdb only; defined where OpenVDB is included. Throws Error (internal) in a build without it.
VoxelGrid read_vdb_voxels(const std::string& path, const VoxelFileOptions& options, const Source& where);

/// A sampled solid from numbers in C order; what read_voxel_file does with an array. `numbers` gives the next slice of constant i.
VoxelGrid voxels_from_slices(const Index3& size, const VoxelFileOptions& options, const std::string& path, const Source& where,
                             const std::function<void(std::vector<double>&)>& next_slice);

}  // namespace hoodoo
