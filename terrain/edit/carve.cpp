// A sweep is a row of balls close enough that their union is a smooth tube; in each column every ball is one vertical interval.
// Peytavie2009, section 4, edits stacks by tools and then merges and sorts; its tools work on the field, this one on the columns themselves.
// Step h between balls of radius r leaves ridges of the height h^2/(8r): h = 2 sqrt(r unit) keeps them under half a unit, at least cell/8.
// Roughness: the radius at a wall point q is r (1 + roughness n(q / wavelength)), n the noise sum over its bound.
// Deviation: a column is cut where its middle is cut. Missing: the brushes and prisms of the paper.
#include "terrain/edit/carve.h"

#include "terrain/edit/rows.h"
#include "terrain/error.h"
#include "terrain/math/noise.h"
#include "terrain/stack/merge_and_sort.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace hoodoo
{

namespace
{

struct Ball {
    Vec3d centre;
    double radius;
};

void check(const Sweep& sweep)
{
    const auto refuse = [](const char* what, const char* expected, std::string got) {
        throw Error(ErrorKind::scene, Problem{{}, what, expected, std::move(got), {}});
    };
    if (sweep.points.empty()) refuse("a sweep", "at least one point", "none");
    if (sweep.radii.size() != 1 && sweep.radii.size() != sweep.points.size()) {
        refuse("radii of a sweep", "one, or one for each point", fmt::format("{} for {} points", sweep.radii.size(), sweep.points.size()));
    }
    for (const double r : sweep.radii) {
        if (!(std::isfinite(r) && r > 0.0)) refuse("radius of a sweep", "a positive length", fmt::to_string(r));
    }
    for (const Vec3d& p : sweep.points) {
        if (!is_finite(p)) refuse("point of a sweep", "finite coordinates", fmt::format("({}, {}, {})", p.x, p.y, p.z));
    }
    if (!(sweep.roughness >= 0.0 && sweep.roughness < 1.0)) refuse("roughness of a sweep", "0 or more, below 1", fmt::to_string(sweep.roughness));
    if (!(std::isfinite(sweep.wavelength) && sweep.wavelength > 0.0))
        refuse("wavelength of a sweep", "a positive length", fmt::to_string(sweep.wavelength));
}

std::vector<Ball> balls_of(const Sweep& sweep, double cell, double unit)
{
    const auto radius = [&](std::size_t k) { return sweep.radii.size() == 1 ? sweep.radii[0] : sweep.radii[k]; };
    std::vector<Ball> balls = {{sweep.points[0], radius(0)}};
    for (std::size_t k = 0; k + 1 < sweep.points.size(); ++k) {
        const double step = std::max(2.0 * std::sqrt(std::min(radius(k), radius(k + 1)) * unit), cell / 8.0);
        const double count = std::ceil((sweep.points[k + 1] - sweep.points[k]).length() / step);
        if (!(count + static_cast<double>(balls.size()) < 1e7)) throw Error(ErrorKind::scene, "a sweep takes more than 1e7 steps");
        for (int n = 1; n <= count; ++n) {
            const double u = n / count;
            balls.push_back({sweep.points[k] + (sweep.points[k + 1] - sweep.points[k]) * u, radius(k) + (radius(k + 1) - radius(k)) * u});
        }
    }
    return balls;
}

/// The columns a set of balls may touch, and what they remove from each.
struct Cuts {
    Vec2i from, to;  ///< [from, to)
    std::vector<std::vector<Run>> of;
    std::vector<Run>& at(int i, int j)
    {
        return of[static_cast<std::size_t>(j - from.y) * static_cast<std::size_t>(to.x - from.x) + static_cast<std::size_t>(i - from.x)];
    }
};

/// Columns whose middle lies in [low, high] (cells), cut to the grid.
Vec2i middles(double low, double high, int n)
{
    const auto clip = [n](double x) { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(n))); };
    return {clip(std::ceil(low - 0.5)), clip(std::floor(high - 0.5) + 1.0)};
}

void add_ball(const MaterialStack& stack, const Sweep& sweep, const Ball& ball, Cuts& cuts)
{
    const double cell = stack.cell(), reach = ball.radius * (1.0 + sweep.roughness);
    const Vec3d c = ball.centre - stack.origin();
    const Vec2i x = middles((c.x - reach) / cell, (c.x + reach) / cell, stack.size().x),
                y = middles((c.y - reach) / cell, (c.y + reach) / cell, stack.size().y);
    const Fractal fractal{4.0, 2.0, 0.5};
    const double scale = 2.0 * sweep.roughness / fbm_bound(kNoise3Bound, fractal).value;
    const auto height = [&](double rho2, const Vec3d& middle, double side) {
        double r = ball.radius;
        if (sweep.roughness > 0.0) {
            const Vec3d wall = middle + Vec3d(0, 0, side * std::sqrt(std::max(0.0, r * r - rho2)));
            r *= 1.0 + std::clamp(scale * fbm(wall / sweep.wavelength, sweep.seed, fractal).value, -sweep.roughness, sweep.roughness);
        }
        return r * r > rho2 ? std::sqrt(r * r - rho2) : -1.0;
    };
    for (int j = y.x; j < y.y; ++j) {
        for (int i = x.x; i < x.y; ++i) {
            const Vec2d offset((i + 0.5) * cell - c.x, (j + 0.5) * cell - c.y);
            const Vec3d middle = ball.centre + Vec3d(offset.x, offset.y, 0.0);
            const double up = height(offset.length2(), middle, 1.0), down = height(offset.length2(), middle, -1.0);
            if (up < 0.0 && down < 0.0) continue;
            const double low = std::round((c.z - std::max(down, 0.0)) / stack.unit()), high = std::round((c.z + std::max(up, 0.0)) / stack.unit());
            const double limit = MaterialStack::max_top;
            const Run cut{static_cast<std::int32_t>(std::clamp(low, 0.0, limit)), static_cast<std::int32_t>(std::clamp(high, 0.0, limit))};
            if (cut.bottom < cut.top) cuts.at(i, j).push_back(cut);
        }
    }
}

/// Sorted, disjoint intervals.
void unite(std::vector<Run>& runs)
{
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.bottom < b.bottom; });
    std::size_t kept = 0;
    for (const Run& run : runs) {
        if (kept > 0 && run.bottom <= runs[kept - 1].top)
            runs[kept - 1].top = std::max(runs[kept - 1].top, run.top);
        else
            runs[kept++] = run;
    }
    runs.resize(kept);
}

std::vector<Layer> removed(std::span<const Layer> layers, std::span<const Run> cuts)
{
    std::vector<Layer> left;
    const auto put = [&](Material material, std::int32_t top) {
        if (top <= (left.empty() ? 0 : left.back().top)) return;
        if (!left.empty() && left.back().material == material)
            left.back().top = top;
        else
            left.push_back({material, top});
    };
    std::int32_t below = 0;
    std::size_t c = 0;
    for (const Layer& layer : layers) {
        while (c < cuts.size() && cuts[c].top <= below) ++c;
        for (std::size_t k = c; k < cuts.size() && cuts[k].bottom < layer.top; ++k) {
            put(layer.material, std::max(below, cuts[k].bottom));
            put(Material::air, std::min(layer.top, cuts[k].top));
        }
        put(layer.material, layer.top);
        below = layer.top;
    }
    return left;
}

}  // namespace

ColumnSet carve(MaterialStack& stack, const Sweep& sweep)
{
    check(sweep);
    const std::vector<Ball> balls = balls_of(sweep, stack.cell(), stack.unit());
    Box3d box;
    for (const Ball& ball : balls) {
        const Vec3d reach(ball.radius * (1.0 + sweep.roughness));
        box.extendBy(Box3d(ball.centre - stack.origin() - reach, ball.centre - stack.origin() + reach));
    }
    const Vec2i x = middles(box.min.x / stack.cell(), box.max.x / stack.cell(), stack.size().x);
    const Vec2i y = middles(box.min.y / stack.cell(), box.max.y / stack.cell(), stack.size().y);
    if (x.x >= x.y || y.x >= y.y) return ColumnSet(stack.size());
    Cuts cuts{{x.x, y.x}, {x.y, y.y}, {}};
    cuts.of.resize(static_cast<std::size_t>(x.y - x.x) * static_cast<std::size_t>(y.y - y.x));
    for (const Ball& ball : balls) add_ball(stack, sweep, ball, cuts);

    std::vector<std::uint32_t> changed;
    std::vector<std::vector<Layer>> columns;
    columns.reserve(cuts.of.size());
    for (int j = y.x; j < y.y; ++j) {
        for (int i = x.x; i < x.y; ++i) {
            std::vector<Layer> column = stack.column(i, j);
            unite(cuts.at(i, j));
            std::vector<Layer> rest = removed(column, cuts.at(i, j));
            if (rest != column) {
                changed.push_back(ColumnSet(stack.size()).index(i, j));
                rest = merge_and_sort(rest);
            }
            columns.push_back(std::move(rest));
        }
    }
    stack.set_columns(cuts.from, cuts.to, columns);
    return {stack.size(), std::move(changed)};
}

EditTool carve_tool()
{
    Schema schema{"carve", "Removes what a ball touches that moves along a line.", {}};
    schema.parameters = {
        {.name = "points", .type = ParameterType::points, .doc = "The line.", .required = true, .unit = "m", .min_count = 1, .max_count = 100000},
        {.name = "radius",
         .type = ParameterType::vector,
         .doc = "One radius, or one for each point.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 100000},
        {.name = "roughness",
         .type = ParameterType::number,
         .doc = "Share of the radius by which noise moves the wall.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 0.95},
        {.name = "wavelength",
         .type = ParameterType::length,
         .doc = "Size of that noise; the radius by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        Sweep sweep;
        sweep.points = edit.points("points");
        sweep.radii = edit.vector("radius");
        if (sweep.radii.size() != 1 && sweep.radii.size() != sweep.points.size()) {
            throw edit.problem("radius", "radii of a carving", fmt::format("one, or one for each of the {} points", sweep.points.size()),
                               fmt::to_string(sweep.radii.size()));
        }
        sweep.roughness = edit.number("roughness");
        sweep.wavelength = edit.has("wavelength") ? edit.number("wavelength") : sweep.radii[0];
        sweep.seed = static_cast<std::uint32_t>(context.seed);
        return carve(stack, sweep);
    };
    return {std::move(schema), apply};
}

}  // namespace hoodoo
