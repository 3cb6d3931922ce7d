// A terrain of a scene as triangles in a file: fields are polygonised tile by tile, and the scene itself says what is seen at each vertex.
// A short ray towards each vertex finds the patch, and the patch's interaction has the materials: so any surface with a field can be exported.
#include "renderer/mesh_export.h"

#include "renderer/scene/terrain.h"
#include "terrain/io/mesh_writer.h"
#include "terrain/math/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

Box3d bounds_of(const Surface& surface)
{
    Box3d box;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile)
        for (std::uint32_t k = 0; k < surface.patch_count(tile); ++k) box.extendBy(surface.patch_bounds({tile, k}));
    return box;
}

/// One weight a material; all 0 if the ray finds another object or nothing. On the sides of `region` the ray passes just inside.
bool material_weights(const Scene& scene, std::uint32_t object, const Box3d& region, Vec3d p, const Vec3d& normal, double spacing, float* weights)
{
    for (int k = 0; k < 2; ++k) p[k] = std::clamp(p[k], region.min[k] + 1e-3 * spacing, region.max[k] - 1e-3 * spacing);
    for (const double above : {0.01 * spacing, 0.1 * spacing, 0.5 * spacing}) {
        Ray ray;
        ray.origin = p + normal * above;
        ray.direction = -normal;
        ray.t_max = 2.0 * above;
        const TraceHit hit = scene.tracer().intersect(ray);
        if (!hit.valid || hit.object != object) continue;
        const Interaction at = scene.tracer().interact(ray, hit);
        for (std::size_t m = 0; m < at.materials.count; ++m) weights[at.materials.index[m]] += at.materials.weight[m];
        return true;
    }
    return false;
}

double default_spacing(const SurfaceInfo& info, const Box3d& box)
{
    const Vec3d size = box.max - box.min;
    if (info.columns > 0) return std::sqrt(size.x * size.y / static_cast<double>(info.columns));
    return std::max({size.x, size.y, size.z}) / 512.0;
}

}  // namespace

MeshExportReport export_mesh(const LoadedScene& loaded, const std::string& path, const MeshExportOptions& options)
{
    const DescribedNode& node = choose_terrain(loaded.description, options.terrain);
    const auto& objects = loaded.scene->objects();
    const auto object = static_cast<std::uint32_t>(
        std::find_if(objects.begin(), objects.end(), [&](const SceneObject& o) { return o.name == node.name; }) - objects.begin());
    const auto* shape = std::get_if<std::unique_ptr<Surface>>(&loaded.scene->shapes()[object]);
    const std::vector<const Field*> fields = shape ? (*shape)->fields() : std::vector<const Field*>{};
    if (fields.empty())
        throw Error(
            ErrorKind::scene,
            Problem{node.where, "a terrain without a field has no mesh", "a type with a field, such as convolution", '"' + node.type + '"', {}});

    PolygoniseOptions polygons;
    polygons.region = bounds_of(**shape);
    MeshExportReport report;
    if (polygons.region.isEmpty() || !is_finite(polygons.region.min) || !is_finite(polygons.region.max))
        throw Error(ErrorKind::scene, Problem{node.where, "a mesh needs an end", "a terrain of finite size", "an endless one", {}});
    report.spacing = polygons.spacing = options.spacing > 0.0 ? options.spacing : default_spacing(objects[object].info, polygons.region);

    const std::vector<std::string> materials = (*shape)->materials();
    const double columns = std::max(1.0, (polygons.region.max.y - polygons.region.min.y) * (polygons.region.max.x - polygons.region.min.x));
    write_mesh_file(path, materials, [&](const MeshSink& sink) {
        std::vector<float> weights;
        std::vector<std::uint8_t> found;
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const std::uint32_t first = static_cast<std::uint32_t>(report.vertices);
            const PolygoniseReport one = polygonise(*fields[f], polygons, [&](const MeshPart& given) {
                MeshPart part = given;
                for (auto& t : part.triangles)
                    for (std::uint32_t& index : t) index += first;
                weights.assign(part.vertices.size() * materials.size(), 0.0f);
                found.assign(part.vertices.size(), 0);
                parallel_items((part.vertices.size() + 255) / 256, [&](std::size_t chunk) {
                    for (std::size_t i = 256 * chunk; i < std::min(part.vertices.size(), 256 * chunk + 256); ++i)
                        found[i] = material_weights(*loaded.scene, object, polygons.region, part.vertices[i], part.normals[i], polygons.spacing,
                                                    &weights[i * materials.size()]);
                });
                report.without_material += static_cast<std::uint64_t>(std::count(found.begin(), found.end(), 0));
                sink(part, weights);
                if (options.progress && !part.vertices.empty()) {
                    const Vec3d done = part.vertices.back() - polygons.region.min;
                    options.progress(
                        (static_cast<double>(f) + std::clamp(done.y * (polygons.region.max.x - polygons.region.min.x) / columns, 0.0, 1.0)) /
                            static_cast<double>(fields.size()),
                        "polygons");
                }
            });
            report.mean_error =
                report.area + one.area > 0.0 ? (report.mean_error * report.area + one.mean_error * one.area) / (report.area + one.area) : 0.0;
            report.area += one.area;
            report.vertices += one.vertices;
            report.triangles += one.triangles;
            report.unrefined += one.unrefined;
            report.far_triangles += one.far_triangles;
            report.maximum_error = std::max(report.maximum_error, one.maximum_error);
        }
    });
    return report;
}

}  // namespace hoodoo
