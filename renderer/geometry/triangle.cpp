// Ray and triangle in double precision by edge functions in a space where the ray is the z axis (Woop2013).
//
// The three edge functions of a shared edge are the same numbers with the opposite sign in both triangles (no contraction to fused operations),
// and zero counts as inside: hence no gap. Deviation: the paper falls back to double precision where a function is zero; here all is double.
// The error bound of a hit follows Higham2002, section 3.5 (products and sums in sequence): each coordinate of the position is a sum of three
// products of rounded vertices, so it is off by at most gamma(8) times the sum of their magnitudes.

#include "renderer/geometry/triangle.h"

#include <algorithm>
#include <utility>

namespace hoodoo
{
namespace
{

/// Vertices in world space.
std::array<Vec3d, 3> corners(const TriangleMesh& mesh, std::size_t triangle)
{
    const auto& index = mesh.triangles[triangle];
    return {mesh.origin + Vec3d(mesh.vertices[index[0]]), mesh.origin + Vec3d(mesh.vertices[index[1]]), mesh.origin + Vec3d(mesh.vertices[index[2]])};
}

/// The ray's dominant axis last, the others so that the winding is kept.
std::array<unsigned, 3> permutation(const Vec3d& d)
{
    const Vec3d a(std::abs(d.x), std::abs(d.y), std::abs(d.z));
    const unsigned kz = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
    unsigned kx = (kz + 1) % 3, ky = (kx + 1) % 3;
    if (d[static_cast<int>(kz)] < 0.0) std::swap(kx, ky);
    return {kx, ky, kz};
}

double gamma(int n)
{
    return n * 0x1p-53 / (1.0 - n * 0x1p-53);
}

double magnitude(const Vec3d& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

std::optional<TriangleHit> intersect_triangle(const TriangleMesh& mesh, std::size_t triangle, const Ray& ray)
{
    const std::array<Vec3d, 3> vertex = corners(mesh, triangle);
    const std::array<unsigned, 3> axis = permutation(ray.direction);
    const auto component = [&](const Vec3d& v, unsigned k) { return v[static_cast<int>(axis[k])]; };
    const double dz = component(ray.direction, 2);
    const double shear_x = component(ray.direction, 0) / dz, shear_y = component(ray.direction, 1) / dz;

    // Shear the corners into the space in which the ray runs along z.
    std::array<double, 3> x{}, y{}, z{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d v = vertex[k] - ray.origin;
        x[k] = component(v, 0) - shear_x * component(v, 2);
        y[k] = component(v, 1) - shear_y * component(v, 2);
        z[k] = component(v, 2) / dz;
    }

    const double u = x[2] * y[1] - y[2] * x[1];
    const double v = x[0] * y[2] - y[0] * x[2];
    const double w = x[1] * y[0] - y[1] * x[0];
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return std::nullopt;
    const double det = u + v + w;
    if (det == 0.0) return std::nullopt;
    TriangleHit hit;
    hit.t = (u * z[0] + v * z[1] + w * z[2]) / det;
    hit.barycentric = Vec2d(v / det, w / det);
    if (!(hit.t > ray.t_min && hit.t < ray.t_max)) return std::nullopt;
    return hit;
}

Interaction interact_triangle(const TriangleMesh& mesh, std::size_t triangle, const Ray& ray, const TriangleHit& found, double error)
{
    // Prefer the exact meeting point; near an edge the tracer may have rounded its way to a triangle that the ray misses.
    const std::optional<TriangleHit> exact = error > 0.0 ? intersect_triangle(mesh, triangle, ray) : std::optional(found);
    const TriangleHit hit = exact.value_or(found);
    const std::array<Vec3d, 3> vertex = corners(mesh, triangle);
    const double b1 = std::clamp(hit.barycentric.x, 0.0, 1.0), b2 = std::clamp(hit.barycentric.y, 0.0, 1.0 - b1), b0 = 1.0 - b1 - b2;

    Interaction it;
    it.t = hit.t;
    it.position = vertex[0] * b0 + vertex[1] * b1 + vertex[2] * b2;
    it.texture_point = it.position;
    it.geometric_normal = (vertex[1] - vertex[0]).cross(vertex[2] - vertex[0]).normalized();

    // Rounding of the corners and of their mean; of the ray's origin and length; and of the tracer's own triangles.
    const double size = std::max({magnitude(vertex[0]), magnitude(vertex[1]), magnitude(vertex[2])});
    const double rounding = std::sqrt(3.0) * gamma(8) * (size + magnitude(ray.origin) + std::abs(hit.t));
    it.position_error = exact ? std::max(rounding, (it.position - ray.at(hit.t)).length() + rounding) : error + rounding;
    it.spawn_offset = 2.0 * (error + rounding);

    const auto& index = mesh.triangles[triangle];
    it.shading_normal = it.geometric_normal;
    if (!mesh.normals.empty()) {
        const Vec3d n = Vec3d(mesh.normals[index[0]]) * b0 + Vec3d(mesh.normals[index[1]]) * b1 + Vec3d(mesh.normals[index[2]]) * b2;
        if (n.length() > 1e-6) it.shading_normal = n.normalized();  // shorter: opposite normals, which have no mean
        if (it.shading_normal.dot(it.geometric_normal) < 0.0) it.shading_normal = -it.shading_normal;
    }
    if (!mesh.uvs.empty()) it.uv = Vec2d(mesh.uvs[index[0]]) * b0 + Vec2d(mesh.uvs[index[1]]) * b1 + Vec2d(mesh.uvs[index[2]]) * b2;
    it.materials.add(0, 1.0f);
    return it;
}

}  // namespace hoodoo
