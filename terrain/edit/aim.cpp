// Tools are aimed at the surface of bedrock alone: what is loose on it moves out of the way afterwards.
// Peytavie2009, sections 3.3 ("sculpting uses the bedrock") and 4.1. The choice between nearest point and a direction is ours. Missing: nothing.
#include "terrain/edit/aim.h"

#include "terrain/edit/project.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

Ground bedrock_of(const MaterialStack& stack)
{
    return Ground(std::shared_ptr<const MaterialStack>(std::shared_ptr<void>(), &stack), material_set({Material::bedrock}), Border::extend);
}

Vec3d surface_normal(const ConvolutionField& field, const Vec3d& p)
{
    const Vec3d n = field.smoothed_gradient(p, 0.5 * field.sigma());
    return n.length() > 0.0 ? n.normalized() : Vec3d(0, 0, 1);
}

std::vector<Parameter> aim_parameters()
{
    return {
        {.name = "along",
         .type = ParameterType::vector,
         .doc = "Direction in which points are moved onto the surface (from rock: backwards); by default to the nearest place.",
         .min_count = 3,
         .max_count = 3},
        {.name = "sigma",
         .type = ParameterType::length,
         .doc = "Half-width of the kernel whose surface is meant; by default the terrain's.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
}

double kernel_of(const MaterialStack& stack, const Values& edit, const EditContext& context)
{
    const double sigma = edit.has("sigma") ? edit.number("sigma") : context.sigma > 0.0 ? context.sigma : stack.cell();
    if (!(sigma <= 64.0 * stack.cell()))
        throw edit.problem("sigma", "the kernel is too wide", fmt::format("at most 64 cells, {} m", 64.0 * stack.cell()));
    return sigma;
}

Vec3d aim(const MaterialStack& stack, double sigma, const Values& edit, const std::string& key, const Vec3d& target)
{
    const Vec3d low = stack.origin(), high = low + Vec3d(stack.size().x, stack.size().y, 0) * stack.cell();
    if (!(target.x >= low.x && target.x <= high.x && target.y >= low.y && target.y <= high.y)) {
        throw edit.problem(key, "the tool lies outside the terrain", fmt::format("x in [{}, {}] m and y in [{}, {}] m", low.x, high.x, low.y, high.y),
                           fmt::format("({}, {}) m", target.x, target.y));
    }
    return onto_surface(ConvolutionField(bedrock_of(stack), sigma), edit, key, target);
}

Vec3d onto_surface(const ConvolutionField& field, const Values& edit, const std::string& key, const Vec3d& target)
{
    const MaterialStack& stack = field.ground().stack();
    const double slope = std::sqrt(3.0) / field.sigma();
    const double height = MaterialStack::max_top * stack.unit() + std::abs(target.z - stack.origin().z);
    const double reach = height + Vec2d(stack.size()).length() * stack.cell();
    std::optional<Vec3d> found;
    if (edit.has("along")) {
        const Vec3d along = edit.vec3("along");
        if (!(along.length() > 0.0)) throw edit.problem("along", "a direction", "one number at least that is not 0");
        const double side = field.value(target) < 0.0 ? -1.0 : 1.0;
        found = first_crossing(field, target, along.normalized() * side, slope, reach);
    } else {
        found = project(field, target, slope, 8.0 * stack.cell(), reach);
    }
    if (!found) {
        throw edit.problem(key, "the tool meets no bedrock", "a point whose way along `along` meets the surface",
                           fmt::format("({}, {}, {}) m", target.x, target.y, target.z));
    }
    return *found;
}

void placed(const Values& edit, const std::string& key, const std::function<void()>& work)
{
    try {
        work();
    } catch (const Error& error) {
        std::vector<Problem> problems = error.problems();
        for (Problem& problem : problems) {
            if (problem.where.file.empty()) problem.where = edit.where(key);
        }
        throw Error(error.kind(), std::move(problems));
    }
}

}  // namespace hoodoo
