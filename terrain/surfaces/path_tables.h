// Paths in the tables of a scene: points, whether they are smooth, and values that change along them.
#pragma once

#include "terrain/schema.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// `smooth`.
Parameter smooth_parameter();

/// The numbers of `name`: one for each point, or one for all of them. Throws Error (scene).
std::vector<double> one_a_point(const Values& table, const std::string& name, std::size_t points);

struct TablePath {
    std::vector<Vec3d> points;
    std::vector<double> values;  ///< interpolated along it
};

/// The path of `points`; where `smooth` says so a centripetal Catmull-Rom curve through them, flattened to pieces whose turn is small. `along` names
/// its values, or is empty: none. Throws Error (scene) at a point twice.
TablePath path_of(const Values& table, const std::string& along);

}  // namespace hoodoo
