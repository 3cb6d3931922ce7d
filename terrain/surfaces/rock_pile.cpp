// A pile of rocks by itself: a heap or a bed of rocks that touch, to lie on whatever ground the scene has.
//
// The rocks are those of Peytavie2009, section 5 (terrain/rocks): a heap is a cone of the repose angle with a rounded top, a bed a box. Seed points
// inside become rocks; those deep inside, which no air can see, are left out. The ground is the plane z = base: rocks are cut by it, as the paper's
// are by its terrain. Missing: a pile on uneven ground, which is a rock layer of a stack terrain (rocks = "instances").

#include "terrain/surfaces/rock_source.h"
#include "terrain/surfaces/rows.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

/// Under the roof z = base + height(distance from the axis), or in a box.
class Pile final : public RockVolume
{
public:
    Pile(const Vec3d& base, bool heap, const Vec3d& size) : base_(base), heap_(heap), size_(size) {}

    Box3d bounds() const override
    {
        const Vec3d half(0.5 * size_.x, 0.5 * size_.y, 0.0);
        return {base_ - half, base_ + half + Vec3d(0.0, 0.0, size_.z)};
    }
    Interval heights(const Vec2d& lo, const Vec2d& hi) const override
    {
        const Box3d box = bounds();
        if (hi.x < box.min.x || hi.y < box.min.y || lo.x > box.max.x || lo.y > box.max.y) return {1.0, 0.0};
        return {box.min.z, box.max.z};
    }
    bool holds(const Vec3d& p) const override
    {
        const Vec3d q = p - base_;
        return q.z >= 0.0 && depth(q) > 0.0;
    }
    bool air_within(const Vec3d& p, double distance) const override { return depth(p - base_) < distance; }
    bool ground(const Vec3d& p) const override { return p.z < base_.z; }

private:
    /// A lower bound of the distance to the air around the pile, positive inside.
    double depth(const Vec3d& q) const
    {
        if (!heap_) return std::min({0.5 * size_.x - std::abs(q.x), 0.5 * size_.y - std::abs(q.y), size_.z - q.z});
        // The roof h (1 - u) with u = sqrt(s^2 + 0.04) scaled to 1 at the rim: a cone with a round top. Its steepest slope is under 1.22 h / a.
        const double s = std::hypot(2.0 * q.x / size_.x, 2.0 * q.y / size_.y);
        const double top = 0.2, rim = std::sqrt(1.0 + top * top);
        const double roof = size_.z * (rim - std::sqrt(s * s + top * top)) / (rim - top);
        const double slope = 2.0 * size_.z / std::min(size_.x, size_.y) / (rim - top);
        return (roof - q.z) / std::sqrt(1.0 + slope * slope);
    }

    Vec3d base_;
    bool heap_;
    Vec3d size_;
};

Shape make_rock_pile(const Values& values, const BuildContext& context)
{
    const Pile pile(values.vec3("base"), values.text("form") == "heap", values.vec3("size"));
    Instances rocks = place_rocks(rock_options(values, context, 0.0), pile, values.vec3("base"));
    rocks.material = values.text("material");
    return rocks;
}

}  // namespace

CatalogueEntry rock_pile_row()
{
    Schema schema{"rock_pile", "Rocks that touch, heaped up: Voronoi cells worn everywhere but where they meet.", {}};
    schema.parameters = {
        {.name = "form",
         .type = ParameterType::choice,
         .doc = "A heap with a round top, or a bed as high everywhere.",
         .fallback = std::string("heap"),
         .choices = {"heap", "bed"}},
        {.name = "base",
         .type = ParameterType::vector,
         .doc = "Middle of the ground under the pile.",
         .fallback = std::vector<double>{0, 0, 0},
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "size",
         .type = ParameterType::vector,
         .doc = "Width along x and y, and height.",
         .fallback = std::vector<double>{12, 12, 3},
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 3,
         .max_count = 3},
        {.name = "material", .type = ParameterType::text, .doc = "Name of what the rocks consist of.", .fallback = std::string("rock")},
    };
    for (Parameter& p : rock_parameters(1.0)) schema.parameters.push_back(std::move(p));
    return {"rock_pile", "Peytavie2009", std::move(schema), make_rock_pile};
}

}  // namespace hoodoo
