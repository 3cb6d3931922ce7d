// A flat ground: the smallest representation that keeps all promises of a surface, and the one to copy for a new one.
// No paper; a ray o + t d meets {x: n.(x - p) = 0} at t = n.(p - o) / n.d.
// Rounding: t has a relative error of a few 2^-53 times (|o - p| / |n.d| t) at grazing rays, so the hit is projected back onto the plane once; the
// distance of the result from the plane is then at most 8 * 2^-53 * (|o - p| + t + |p|), the stated error.
// Deviation: it ends at a circle of the radius `extent`, since what is traced has a box.
#include "terrain/error.h"
#include "terrain/fields/height.h"
#include "terrain/surfaces/rows.h"

#include <algorithm>
#include <optional>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 8 * 0x1p-53;
constexpr double kUpright = 1e-6;  // below this a normal's upward part makes the plane a wall, which is no height

/// The height above the plane: the simplest field, and what a warp starts from.
class PlaneField final : public Field
{
public:
    PlaneField(const Vec3d& point, const Vec3d& normal) : point_(point), normal_(normal) {}
    double value(const Vec3d& p) const override { return normal_.dot(p - point_); }
    Vec3d gradient(const Vec3d&) const override { return normal_; }
    double slope_bound(const Segment& segment) const override
    {
        const Vec3d along = segment.b - segment.a;
        const double length = along.length();
        return (length > 0.0 ? std::abs(normal_.dot(along)) / length : 1.0) + rounding(segment.b);
    }
    Interval range(const Box3d& box) const override
    {
        const Vec3d half = box.size() * 0.5;
        const double centre = value(box.center()), reach = std::abs(normal_.x) * half.x + std::abs(normal_.y) * half.y + std::abs(normal_.z) * half.z;
        return {centre - reach - rounding(box.max), centre + reach + rounding(box.max)};
    }
    Box3d bounds() const override { return Box3d(Vec3d(-kInfinity), Vec3d(kInfinity)); }
    std::array<Interval, 3> gradient_range(const Box3d&) const override
    {
        return {Interval{normal_.x, normal_.x}, Interval{normal_.y, normal_.y}, Interval{normal_.z, normal_.z}};
    }
    double curvature_bound(const Box3d&) const override { return 0.0; }

private:
    double rounding(const Vec3d& p) const
    {
        return kRounding * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::abs(point_.x) + std::abs(point_.y) + std::abs(point_.z));
    }
    Vec3d point_, normal_;
};

/// The same as a height, where the plane is not upright.
class PlaneHeight final : public Height
{
public:
    PlaneHeight(const Vec3d& point, const Vec3d& normal, double extent)
        : point_(point), slope_(-normal.x / normal.z, -normal.y / normal.z), extent_(extent)
    {
    }
    double height(const Vec2d& p) const override
    {
        const Vec2d q = nearest(p);
        return point_.z + slope_.x * (q.x - point_.x) + slope_.y * (q.y - point_.y);
    }
    Vec2d gradient(const Vec2d& p) const override
    {
        const Vec2d q = nearest(p);
        return {q.x == p.x ? slope_.x : 0.0, q.y == p.y ? slope_.y : 0.0};
    }
    Interval range(const Box2d& area) const override
    {
        const Vec2d low = nearest(area.min), high = nearest(area.max), half = (high - low) * 0.5;
        const double centre = height((low + high) * 0.5), reach = std::abs(slope_.x) * half.x + std::abs(slope_.y) * half.y;
        const double rounding = 4.0 * kRounding * (std::abs(point_.z) + slope_.length() * 4.0 * extent_);
        return {centre - reach - rounding, centre + reach + rounding};
    }
    double slope_bound(const Box2d&) const override { return slope_.length() * (1.0 + 4.0 * kRounding); }
    Box2d domain() const override
    {
        // The box about the disc's outline from above.
        const Vec2d middle(point_.x, point_.y);
        return {middle - Vec2d(extent_), middle + Vec2d(extent_)};
    }

private:
    Vec2d nearest(const Vec2d& p) const
    {
        return {std::clamp(p.x, point_.x - extent_, point_.x + extent_), std::clamp(p.y, point_.y - extent_, point_.y + extent_)};
    }
    Vec3d point_;
    Vec2d slope_;
    double extent_;
};

class Plane final : public Surface
{
public:
    Plane(const Vec3d& point, const Vec3d& normal, double extent, std::string material)
        : point_(point), normal_(normal.normalized()), extent_(extent), material_(std::move(material)), field_(point_, normal_)
    {
        orthonormal_frame(normal_, u_, v_);
        if (normal_.z > kUpright) height_.emplace(point_, normal_, extent_);
    }

    std::uint32_t patch_count(std::uint32_t) const override { return 1; }

    Box3d patch_bounds(PatchId) const override
    {
        // A disc reaches extent * sqrt(1 - n_k^2) along axis k.
        Vec3d reach;
        for (int k = 0; k < 3; ++k)
            reach[k] = extent_ * std::sqrt(std::max(0.0, 1.0 - normal_[k] * normal_[k])) + kRounding * (4 * extent_ + size(point_));
        return Box3d(point_ - reach, point_ + reach);
    }

    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        ++hit.evaluations;
        const double along = normal_.dot(ray.direction);
        if (along == 0.0 || (ray.crossing == Crossing::entering && along > 0.0)) return false;
        const double t = normal_.dot(point_ - ray.origin) / along;
        if (!(t > ray.t_min && t < hit.t)) return false;
        if (!((ray.at(t) - point_).length2() <= extent_ * extent_)) return false;
        hit.t = t;
        hit.patch = patch;
        return true;
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at;
        at.t = hit.t;
        at.position = ray.at(hit.t);
        at.position -= normal_ * normal_.dot(at.position - point_);
        at.position_error = kRounding * (size(ray.origin - point_) + hit.t + size(point_) + size(at.position));
        at.spawn_offset = 2 * at.position_error;
        at.geometric_normal = normal_;
        dress(at);
        return at;
    }

    void dress(Interaction& at) const override
    {
        at.shading_normal = normal_;
        at.uv = Vec2d(u_.dot(at.position - point_), v_.dot(at.position - point_));
        at.texture_point = at.position;
        at.materials.add(0, 1.0f);
    }

    bool contains(const Vec3d& p) const override { return normal_.dot(p - point_) <= 0.0; }
    std::vector<std::string> materials() const override { return {material_}; }
    bool closed() const override { return false; }
    const Field* field() const override { return &field_; }
    const Height* height() const override { return height_ ? &*height_ : nullptr; }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.trace_bytes = sizeof(*this);
        info.patches = 1;
        return info;
    }

private:
    static double size(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

    Vec3d point_, normal_, u_, v_;
    double extent_;
    std::string material_;
    PlaneField field_;
    std::optional<PlaneHeight> height_;
};

Shape make_plane(const Values& values, const BuildContext&)
{
    const Vec3d normal = values.vec3("normal");
    if (!(normal.length() > 0.0)) throw values.problem("normal", "the normal of a plane", "a vector with a length");
    return std::make_unique<Plane>(values.vec3("point"), normal, values.number("extent"), values.text("material"));
}

}  // namespace

CatalogueEntry plane_row()
{
    Schema schema{"plane", "A flat ground through a point. Its uv are metres along two axes of the plane.", {}};
    schema.parameters = {
        {.name = "point",
         .type = ParameterType::vector,
         .doc = "A point of the plane.",
         .fallback = std::vector<double>{0, 0, 0},
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "normal",
         .type = ParameterType::vector,
         .doc = "Direction towards air; any length.",
         .fallback = std::vector<double>{0, 0, 1},
         .min_count = 3,
         .max_count = 3},
        {.name = "extent",
         .type = ParameterType::length,
         .doc = "Radius of the circle that is left of the infinite plane.",
         .fallback = 1e5,
         .unit = "m",
         .minimum = 0,
         .maximum = 1e9,
         .above_minimum = true},
        {.name = "material", .type = ParameterType::text, .doc = "Its material.", .fallback = std::string("ground")},
    };
    return {"plane", "", std::move(schema), make_plane};
}

}  // namespace hoodoo
