// A point primitive is blended into the bedrock's field at its surface; the columns under it take over where that moves the surface.
//
// Peytavie2009, section 4.1, in our sign (negative inside): the target is projected onto the surface (project.h); n points to air; the centre is
//   c = v - delta n to add, f~ = f - g;   c = v + delta n to carve, f~ = f + g;   delta = R/2 by default.
// The printed n = grad f points into the rock, which would put c outside. The field is that of bedrock alone.
//
// Deviations. Thresholding f~ anew would erode every rim a little with every stroke (the kernel rounds it: 3.000 -> 2.667 m at the rim of a step two
// cells high), so only what changes its side changes (brush.h): air to bedrock where f~ < 0 <= f, bedrock to air where f < 0 <= f~. Near edges the
// field's surface is not the layers' own bound; there the bound moves by as much as the surface does, since material changed at the surface's height
// would leave slivers. Normals are central differences over half a kernel, because the field has creases.
//
// A column knows its axis only: on a vertical wall a stroke that moves the surface by less than the way to the next axis changes nothing; there a
// depth below R/2 helps, or a radius of 13 cells and more. Strokes repeat: each begins where the surface then crosses the last normal, scattered if
// wanted (Figure 9). Missing: other primitives than points.
#include "terrain/edit/sculpt.h"

#include "terrain/edit/aim.h"
#include "terrain/edit/brush.h"
#include "terrain/edit/overwrite.h"
#include "terrain/edit/project.h"
#include "terrain/edit/rows.h"
#include "terrain/error.h"
#include "terrain/math/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hoodoo
{

namespace
{

/// Heights at which a column's own bedrock ends (tops) or begins (bottoms), in units.
std::vector<double> bounds_of(std::span<const Layer> column, bool tops)
{
    std::vector<double> bounds;
    bool inside = true;  // the base
    double below = 0.0;
    const auto visit = [&](bool bedrock, double top) {
        if (inside != bedrock && inside == tops) bounds.push_back(below);
        inside = bedrock;
        below = top;
    };
    for (const Layer& layer : column) visit(layer.material == Material::bedrock, layer.top);
    visit(false, kInfinity);
    return bounds;
}

/// The column's own bound that stands for the field's surface at `root`: the nearest of its kind before f changes its side again; else the root
/// itself.
double own_bound(std::span<const Layer> column, const std::vector<double>& roots, double root, bool top)
{
    const auto next = std::upper_bound(roots.begin(), roots.end(), root), at = std::lower_bound(roots.begin(), roots.end(), root);
    const double low = at == roots.begin() ? -kInfinity : *(at - 1), high = next == roots.end() ? kInfinity : *next;
    double best = root, distance = kInfinity;
    for (const double bound : bounds_of(column, top)) {
        if (bound <= low || bound >= high || std::abs(bound - root) >= distance) continue;
        best = bound;
        distance = std::abs(bound - root);
    }
    return best;
}

/// What a piece changes of the column, in whole units: an end on the old surface becomes the column's own bound, and the piece keeps its length.
Run to_units(const BrushedPiece& piece, std::span<const Layer> column, const std::vector<double>& roots, bool adds)
{
    // Upwards through the lower end of what is added, or the upper end of what is taken away, matter turns to air.
    const double lower = piece.lower_is_old ? own_bound(column, roots, piece.lower, adds) : piece.lower;
    const double upper = piece.upper_is_old ? own_bound(column, roots, piece.upper, !adds) : piece.upper;
    const double length = piece.upper - piece.lower;
    const auto run = [](double a, double b) {
        return Run{static_cast<std::int32_t>(std::lround(std::max(0.0, a))), static_cast<std::int32_t>(std::lround(std::max(0.0, b)))};
    };
    if (piece.lower_is_old == piece.upper_is_old) return run(lower, upper);
    return piece.lower_is_old ? run(lower, lower + length) : run(upper - length, upper);
}

Vec3d centre_of(const Stroke& stroke)
{
    return stroke.vertex + stroke.normal * (stroke.adds ? -stroke.depth : stroke.depth);
}

ColumnBox box_of(const MaterialStack& stack, const Stroke& stroke)
{
    const Vec3d centre = centre_of(stroke);
    const Vec2d middle(centre.x, centre.y), reach(stroke.radius);
    return columns_within(stack, middle - reach, middle + reach);
}

}  // namespace

ColumnSet sculpt(MaterialStack& stack, double sigma, const Stroke& stroke)
{
    const Ground bedrock = bedrock_of(stack);
    const Vec3d c = (centre_of(stroke) - stack.origin()) / stack.unit();
    const double cell = stack.cell() / stack.unit();
    const auto change = [&](int i, int j, std::vector<Layer> column) {
        Brush brush{c.z, stroke.radius / stack.unit(), 0.0, stroke.adds};
        brush.distance = Vec2d((i + 0.5) * cell - c.x, (j + 0.5) * cell - c.y).length();
        if (brush.distance >= brush.radius) return column;
        const AxisProfile f(bedrock, sigma, i + 0.5, j + 0.5);
        std::vector<Run> runs;
        const std::vector<BrushedPiece> pieces = brushed_pieces(f, brush);
        if (pieces.empty()) return column;
        const std::vector<double> roots = f.roots();
        for (const BrushedPiece& piece : pieces) runs.push_back(to_units(piece, column, roots, stroke.adds));
        unite(runs);
        if (!stroke.adds) return overwrite(column, runs, material_set({Material::bedrock}), Material::air);
        return overwrite(column, runs, kEverything, Material::bedrock);
    };
    return change_columns(stack, box_of(stack, stroke), change);
}

namespace
{

/// Where strokes go: from the projected target along the normal, each a little aside if scattered.
class Strokes
{
public:
    Strokes(MaterialStack& stack, double sigma, const Values& edit, const EditContext& context)
        : stack_(stack), sigma_(sigma), radius_(edit.number("radius")), scatter_(edit.number("scatter")), seed_(context.seed), changed_(stack.size())
    {
    }

    void add(const Values& edit, const char* key, const Vec3d& target, std::size_t number)
    {
        const bool adds = edit.text("mode") == "add";
        const double depth = edit.has("depth") ? edit.number("depth") : 0.5 * radius_;
        Vec3d base = aim(stack_, sigma_, edit, key, target);
        const std::int64_t strokes = edit.integer("strokes");
        for (std::int64_t k = 0; k < strokes; ++k) {
            const ConvolutionField field(bedrock_of(stack_), sigma_);
            Vec3d normal = surface_normal(field, base), vertex = base;
            if (scatter_ > 0.0) {
                vertex = scattered(field, base, normal, hash_cell(seed_, static_cast<std::int64_t>(number), k));
                normal = surface_normal(field, vertex);
            }
            const Stroke stroke{vertex, normal, radius_, depth, adds};
            before_.keep(stack_, box_of(stack_, stroke));
            changed_.add(sculpt(stack_, sigma_, stroke));
            if (k + 1 < strokes) base = moved(base, surface_normal(field, base), adds);
        }
    }

    const ColumnSet& changed() const { return changed_; }
    void undo() { before_.restore(stack_); }

private:
    /// A point of the surface within `scatter` of the base, evenly in the tangent plane.
    Vec3d scattered(const ConvolutionField& field, const Vec3d& base, const Vec3d& normal, std::uint64_t hash) const
    {
        Vec3d across, along;
        orthonormal_frame(normal, across, along);
        const double r = scatter_ * std::sqrt(unit_real(mix64(hash))), turn = 2.0 * std::numbers::pi * unit_real(mix64(hash + 1));
        const Vec3d aside = base + across * (r * std::cos(turn)) + along * (r * std::sin(turn));
        const double slope = std::sqrt(3.0) / sigma_;
        return project(field, aside, slope, radius_ + scatter_, 8.0 * (radius_ + scatter_) + 8.0 * sigma_).value_or(base);
    }

    /// Where the surface now crosses the line of the last normal; the base itself where it did not move.
    Vec3d moved(const Vec3d& base, const Vec3d& normal, bool adds) const
    {
        const ConvolutionField field(bedrock_of(stack_), sigma_);
        if ((field.value(base) < 0.0) != adds) return base;
        return first_crossing(field, base, adds ? normal : -normal, std::sqrt(3.0) / sigma_, 2.0 * radius_).value_or(base);
    }

    MaterialStack& stack_;
    double sigma_, radius_, scatter_;
    std::uint64_t seed_;
    ColumnSet changed_;
    KeptColumns before_;
};

Schema sculpt_schema()
{
    Schema schema{
        "sculpt", "Pulls bedrock out along its normal, or carves into it: a soft ball at the point of the surface nearest to the target.", {}};
    schema.parameters = {
        {.name = "target",
         .type = ParameterType::vector,
         .doc = "A point; projected onto the bedrock's surface.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "targets",
         .type = ParameterType::points,
         .doc = "Several, one after another; instead of `target`.",
         .unit = "m",
         .min_count = 1,
         .max_count = 100000},
        {.name = "mode",
         .type = ParameterType::choice,
         .doc = "Whether bedrock is added or carved away.",
         .fallback = std::string("add"),
         .choices = {"add", "carve"}},
        {.name = "radius",
         .type = ParameterType::length,
         .doc = "Of the ball of influence.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "depth",
         .type = ParameterType::length,
         .doc = "How far the ball's centre lies behind the surface it moves; half the radius by default, less where walls hardly move.",
         .unit = "m",
         .minimum = 0},
        {.name = "strokes",
         .type = ParameterType::integer,
         .doc = "Strokes at each target, each on what the last one left.",
         .fallback = std::int64_t{1},
         .minimum = 1,
         .maximum = 100000},
        {.name = "scatter",
         .type = ParameterType::length,
         .doc = "Each stroke falls this far aside at most, at random.",
         .fallback = 0.0,
         .unit = "m",
         .minimum = 0},
    };
    for (Parameter& p : aim_parameters()) schema.parameters.push_back(std::move(p));
    return schema;
}

}  // namespace

EditTool sculpt_tool()
{
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        if (edit.has("target") == edit.has("targets"))
            throw edit.problem("target", "a sculpting tool", "either target or targets", edit.has("target") ? "both" : "neither");
        if (edit.has("depth") && edit.number("depth") > edit.number("radius")) {
            throw edit.problem("depth", "depth of a sculpting tool", fmt::format("at most its radius, {} m", edit.number("radius")),
                               fmt::format("{} m", edit.number("depth")));
        }
        Strokes strokes(stack, kernel_of(stack, edit, context), edit, context);
        const std::vector<Vec3d> targets = edit.has("target") ? std::vector<Vec3d>{edit.vec3("target")} : edit.points("targets");
        const char* key = edit.has("target") ? "target" : "targets";
        try {
            for (std::size_t k = 0; k < targets.size(); ++k) placed(edit, key, [&] { strokes.add(edit, key, targets[k], k); });
        } catch (...) {
            strokes.undo();
            throw;
        }
        return strokes.changed();
    };
    return {sculpt_schema(), apply};
}

}  // namespace hoodoo
