// A terrain of a scene looked at as a researcher does: samples of its field, heights from above, sections, contours, the error of a mesh.
#pragma once

#include "renderer/render.h"
#include "terrain/field.h"
#include "terrain/io/drawing.h"
#include "terrain/io/grid_file.h"
#include "terrain/io/height_image.h"
#include "terrain/shape.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// A terrain that is shown. Valid as long as the scene.
struct SurveyedTerrain {
    const Shape* shape = nullptr;
    const Surface* surface = nullptr;  ///< nullptr: triangles
    std::string name;
    Source where;
    Box3d bounds;  ///< of what can be hit; sides may be infinite

    /// Least of the fields of all its bodies: negative in matter. Throws Error (scene) where there is none.
    std::vector<const Field*> fields() const;
};

/// The terrain called `name`; without a name the only one. Throws Error (scene): no such terrain, or one that is not shown because another stands on
/// it.
SurveyedTerrain survey(const LoadedScene& loaded, const std::string& name);

/// The field at count[k] nodes along each axis, those at the ends on the sides of the box (with 1: in its middle).
SampledGrid sample_field(const SurveyedTerrain& terrain, const Box3d& box, const std::array<int, 3>& count);

/// The highest point of the terrain at pixel centres over an area, row 0 = north, NaN where there is none: what a ray from above meets. Pixels of
/// `cell` metres from the lower left corner, as many as fit, at least one each way. Throws Error (scene) on over 2^27 of them.
HeightImage heights_from_above(const SurveyedTerrain& terrain, const Imath::Box2d& area, double cell);

/// A vertical section from one point to another, between two heights: matter in grey, its outline as the zero of the field. `columns` pixels wide,
/// both axes to one scale.
Drawing draw_section(const SurveyedTerrain& terrain, const Vec2d& from, const Vec2d& to, const Interval& heights, int columns);

/// Contours of heights every `interval` metres, each fifth one heavier and with its height; a pixel is `scale` units wide. NaN has none.
Drawing draw_contours(const HeightImage& heights, double interval, double scale);

/// How far a mesh lies from the field: of each triangle's centroid, edge midpoints and corners, the distance to the field's zero along the gradient.
struct MeshError {
    std::uint64_t triangles = 0;
    double area = 0.0;                ///< m2
    double mean = 0.0, rms = 0.0;     ///< metres, by area, of centroids and midpoints
    double maximum = 0.0;             ///< metres, of all places; where no zero lies within `reach` it counts as `reach`
    std::uint64_t far_triangles = 0;  ///< with such a place
};
MeshError mesh_error(const SurveyedTerrain& terrain, const TriangleMesh& mesh, double reach);

}  // namespace hoodoo
