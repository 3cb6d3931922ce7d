// Curves are centripetal Catmull-Rom splines, flattened once: straight stretches get few pieces, bends as many as their turn asks for.
#include "terrain/surfaces/path_tables.h"

#include "terrain/edit/skeleton.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr int kPiecesOfSpan = 8;      // at least, of a smooth curve between the two of its points that are nearest to each other
constexpr double kStraight = 0.9997;  // the cosine of 1.4 degrees: what the chord of a piece may turn by before a new piece begins

}  // namespace

Parameter smooth_parameter()
{
    return {
        .name = "smooth", .type = ParameterType::boolean, .doc = "A curve through the points, or straight pieces between them.", .fallback = true};
}

std::vector<double> one_a_point(const Values& v, const std::string& name, std::size_t points)
{
    std::vector<double> list = v.vector(name);
    if (list.size() == 1) list.assign(points, list[0]);
    if (list.size() != points)
        throw v.problem(name, "values along a path", "one, or one for each of its points", fmt::format("{} for {} points", list.size(), points));
    return list;
}

TablePath path_of(const Values& v, const std::string& along)
{
    const std::vector<Vec3d>& points = v.points("points");
    TablePath path{points, along.empty() ? std::vector<double>(points.size()) : one_a_point(v, along, points.size())};
    for (std::size_t n = 0; n + 1 < points.size(); ++n)
        if (points[n] == points[n + 1])
            throw v.problem("points", "neighbouring points of a path", "places apart", fmt::format("number {} twice", n + 1));
    if (points.size() < 3 || !v.boolean("smooth")) return path;
    Skeleton skeleton{points, {{}}};
    double shortest = kInfinity;
    for (std::size_t n = 0; n < points.size(); ++n) {
        skeleton.arcs[0].push_back(n);
        if (n > 0) shortest = std::min(shortest, (points[n] - points[n - 1]).length());
    }
    const std::vector<double> given = path.values;
    path = {};
    const SkeletonPath steps = arc_steps(skeleton, 0, shortest / kPiecesOfSpan, true);
    for (std::size_t n = 0; n < steps.size(); ++n) {
        const auto k = static_cast<std::size_t>(std::min(std::floor(steps[n].node), static_cast<double>(points.size() - 2)));
        const double u = steps[n].node - static_cast<double>(k);
        // Straight stretches need no steps; where the curve's own points are, its values may bend.
        const bool own = u == 0.0 || n + 1 == steps.size();
        if (!own && (steps[n + 1].at - path.points.back()).normalized().dot((steps[n].at - path.points.back()).normalized()) > kStraight) continue;
        path.points.push_back(steps[n].at);
        path.values.push_back(given[k] * (1.0 - u) + given[k + 1] * u);
    }
    return path;
}

}  // namespace hoodoo
