// The smallest interesting instance of every row of the catalogue. A row without one fails the laws: add it here.
#pragma once

#include "terrain/catalogue.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hoodoo::testing
{

struct RowInstance {
    std::string row;                                ///< name in the catalogue
    std::string name;                               ///< of this instance, for the reports
    std::function<std::string(const Vec3d&)> text;  ///< TOML of the row's parameters, the whole thing moved by a vector
    double trusted = 1.0;                           ///< middle share of the bounds where contains() knows where the surface ends
    std::optional<Viewpoint> view = {};             ///< where it is seen from; absent: full detail everywhere
};

/// Several instances a row where the row has several ways to be traced.
const std::vector<RowInstance>& row_instances();

/// Builds an instance. Throws Error, with the text of all problems, if the parameters do not check. A mesh comes as a MeshSurface.
struct BuiltRow {
    std::unique_ptr<Shape> shape;
    std::unique_ptr<TriangleMesh> flat;  ///< instances as one mesh
    std::unique_ptr<Surface> mesh;       ///< the adaptor, if the shape is a mesh or instances of meshes
    const Surface& surface() const;
};
/// All instances as one mesh in world space, around the first one's position.
TriangleMesh flattened(const Instances& instances);

BuiltRow build_row(const RowInstance& instance, const Vec3d& shift = Vec3d(0.0));

}  // namespace hoodoo::testing
