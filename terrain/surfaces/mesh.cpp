// Triangles from a file as a terrain: rocks, hosts' geometry, and the twin every comparison with other renderers needs.
//
// A vertex v of the file stands in the world at translate + origin + scale R (v - origin), R = Rz Ry Rx (first about x, then y, then z).
// The double-precision part, translate + origin, becomes the mesh's origin; what is left is small and stays single precision.
// Missing: a non-uniform scale, several materials in one file, instances.

#include "terrain/surfaces/rows.h"
#include "terrain/io/mesh_file.h"

#include <numbers>

namespace hoodoo
{

namespace
{

Schema mesh_schema()
{
    return {"mesh",
            "Triangles from a PLY, OBJ or STL file; front faces are counter-clockwise.",
            {
                {.name = "file", .type = ParameterType::path, .doc = "Mesh file (.ply, .obj, .stl), in metres", .required = true},
                {.name = "material", .type = ParameterType::text, .doc = "Name of its material", .fallback = std::string("rock")},
                {.name = "normals",
                 .type = ParameterType::choice,
                 .doc = "Shading: normals interpolated over a face, or one for each face",
                 .fallback = std::string("smooth"),
                 .choices = {"smooth", "flat"}},
                {.name = "up", .type = ParameterType::choice, .doc = "The file's vertical axis", .fallback = std::string("z"), .choices = {"y", "z"}},
                {.name = "scale",
                 .type = ParameterType::number,
                 .doc = "Size: metres a unit of the file",
                 .fallback = 1.0,
                 .minimum = 0.0,
                 .above_minimum = true},
                {.name = "rotate_deg",
                 .type = ParameterType::vector,
                 .doc = "Turned about x, then y, then z, in degrees",
                 .fallback = std::vector<double>{0, 0, 0},
                 .unit = "deg",
                 .min_count = 3,
                 .max_count = 3},
                {.name = "translate",
                 .type = ParameterType::vector,
                 .doc = "Then moved by",
                 .fallback = std::vector<double>{0, 0, 0},
                 .unit = "m",
                 .min_count = 3,
                 .max_count = 3},
                {.name = "origin",
                 .type = ParameterType::vector,
                 .doc = "The point of the file about which scale and rotate work",
                 .fallback = std::vector<double>{0, 0, 0},
                 .min_count = 3,
                 .max_count = 3},
            }};
}

Imath::M33d rotation(const Vec3d& degrees)
{
    const Vec3d a = degrees * (std::numbers::pi / 180.0);
    const double cx = std::cos(a.x), sx = std::sin(a.x), cy = std::cos(a.y), sy = std::sin(a.y), cz = std::cos(a.z), sz = std::sin(a.z);
    // Rows of the transpose: Imath multiplies a row vector from the left.
    return Imath::M33d(cz * cy, sz * cy, -sy, cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx, cz * sy * cx + sz * sx, sz * sy * cx - cz * sx,
                       cy * cx);
}

Shape make_mesh(const Values& values, const BuildContext& context)
{
    const std::string path = context.resolve(values.text("file"), values.where("file"));
    TriangleMesh mesh = read_mesh_file(path, {.smooth = values.text("normals") == "smooth", .y_up = values.text("up") == "y"}, values.where("file"));
    const Imath::M33d turn = rotation(values.vec3("rotate_deg"));
    const double scale = values.number("scale");
    const Vec3d pivot = values.vec3("origin");
    for (Vec3f& v : mesh.vertices) v = Vec3f((Vec3d(v) - pivot) * scale * turn);
    for (Vec3f& n : mesh.normals) n = Vec3f((Vec3d(n) * turn).normalized());
    mesh.origin = values.vec3("translate") + pivot;
    mesh.material = values.text("material");
    return mesh;
}

}  // namespace

CatalogueEntry mesh_row()
{
    return {"mesh", "", mesh_schema(), make_mesh};
}

}  // namespace hoodoo
