// The terrains of a description, built in the order in which they stand on each other.
#pragma once

#include "renderer/scene/description.h"
#include "renderer/scene/scene.h"
#include "terrain/shape.h"

#include <vector>

namespace hoodoo
{

struct BuiltTerrains {
    std::vector<SceneObject> objects;  ///< name and type
    std::vector<Shape> shapes;
};

/// One object for each terrain that is rendered: all but those that others stand on and that do not say `visible = true`, and those that say
/// `visible = false`. Level of detail goes by the camera's eye and the file's own size of picture. Throws Error (scene) for an unknown base, a base
/// without a surface, and terrains that stand on each other in a circle.
BuiltTerrains build_terrains(const Description& description, const SceneOptions& options, const Camera& camera);

}  // namespace hoodoo
