// The tools that change voxels, one row each: sculpt, smooth, weather.
//
// sculpt: matter added or taken away where a ball passes, along a path of straight pieces whose radius changes evenly. F' = min(F, k d) or max(F, -k
// d), d the signed distance of the piece (1-Lipschitz) and k the grid's own mean slope, so that old and new surface are equally steep. smooth: the
// shares of matter averaged over the cube of (2 n + 1)^3 samples, which rounds what is sharper than that (a sampled convolution surface,
// Peytavie2009, section 3.3). weather: terrain/edit/weather.h, with durability by beds and noise. Missing: soft edges of sculpt; use smooth after it.
#include "terrain/edit/voxel_tools.h"

#include "terrain/edit/edit_table.h"
#include "terrain/edit/weather.h"
#include "terrain/error.h"
#include "terrain/fields/lattice_box.h"
#include "terrain/fields/round_cone.h"
#include "terrain/math/noise.h"
#include "terrain/math/parallel.h"
#include "terrain/math/smoothstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

// -- sculpt ----------------------------------------------------------------------------------------------------------

void sculpt_voxels(VoxelGrid& grid, const Values& v, std::uint64_t)
{
    const std::vector<Vec3d>& points = v.points("points");
    const std::vector<double>& radii = v.vector("radius");
    if (radii.size() != 1 && radii.size() != points.size())
        throw v.problem("radius", "the radii of a path", "one, or one for each of its points",
                        fmt::format("{} for {} points", radii.size(), points.size()));
    const bool adds = v.text("mode") == "add";
    const auto radius = [&](std::size_t n) { return radii[radii.size() == 1 ? 0 : n]; };
    // Without a surface there is no slope to match; one unit a cell is as good as any.
    const double own = mean_slope(grid), slope = own > 0.0 ? own : grid.values.outside() / grid.cell;
    const Index3& size = grid.values.size();
    for (std::size_t n = 0; n + 1 < points.size() || n == 0; ++n) {
        const std::size_t m = std::min(n + 1, points.size() - 1);
        const RoundCone piece{points[n], points[m], radius(n), radius(m)};
        const Box3d box = piece.bounds();
        const Vec3d lo = grid.local(box.min - Vec3d(2.0 * grid.cell)), hi = grid.local(box.max + Vec3d(2.0 * grid.cell));
        const auto from = [&](std::size_t k) { return static_cast<int>(std::clamp(std::ceil(lo[static_cast<int>(k)]), 1.0, size[k] - 1.0)); };
        const auto to = [&](std::size_t k) { return static_cast<int>(std::clamp(std::floor(hi[static_cast<int>(k)]), 0.0, size[k] - 2.0)); };
        for (int i = from(0); i <= to(0); ++i)
            for (int j = from(1); j <= to(1); ++j)
                for (int k = from(2); k <= to(2); ++k) {
                    const auto d = static_cast<float>(slope * piece.distance(grid.world(Vec3d(i, j, k))));
                    const float old = grid.at({i, j, k});
                    grid.set({i, j, k}, adds ? std::min(old, d) : std::max(old, -d));
                }
    }
}

VoxelTool sculpt_row()
{
    Schema schema{"sculpt", "A ball passes along a path and adds matter or takes it away.", {}};
    schema.parameters = {
        {.name = "points", .type = ParameterType::points, .doc = "The path; one point is one ball.", .required = true, .min_count = 1},
        {.name = "radius",
         .type = ParameterType::vector,
         .doc = "Of the ball: one, or one a point.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 65536},
        {.name = "mode",
         .type = ParameterType::choice,
         .doc = "Adds matter or takes it away.",
         .fallback = std::string("remove"),
         .choices = {"add", "remove"}},
    };
    return {std::move(schema), sculpt_voxels};
}

// -- smooth ----------------------------------------------------------------------------------------------------------

/// Running means along one axis of a box, `half` samples to each side; what is near the box's ends is left as it is.
void mean_along(LatticeBox& box, std::size_t axis, int half)
{
    std::vector<float> line(static_cast<std::size_t>(box.size[axis]));
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    Index3 p{};
    const auto value = [&]() -> float& { return box.values[box.index(p[0], p[1], p[2])]; };
    for (p[a] = 0; p[a] < box.size[a]; ++p[a])
        for (p[b] = 0; p[b] < box.size[b]; ++p[b]) {
            for (p[axis] = 0; p[axis] < box.size[axis]; ++p[axis]) line[static_cast<std::size_t>(p[axis])] = value();
            double sum = 0.0;
            for (int n = 0; n < box.size[axis]; ++n) {
                sum += line[static_cast<std::size_t>(n)];
                if (n >= 2 * half + 1) sum -= line[static_cast<std::size_t>(n - 2 * half - 1)];
                if (n < 2 * half) continue;
                p[axis] = n - half;
                value() = static_cast<float>(sum / (2 * half + 1));
            }
        }
}

void smooth_voxels(VoxelGrid& grid, const Values& v, std::uint64_t)
{
    const double half_cells = std::round(v.number("radius") / grid.cell);
    if (!(half_cells >= 1.0 && half_cells <= 16.0))
        throw v.problem("radius", "the radius of a smoothing", fmt::format("1 to 16 cells ({:.6g} to {:.6g} m)", grid.cell, 16.0 * grid.cell),
                        fmt::format("{:.6g} m", v.number("radius")));
    const int half = static_cast<int>(half_cells);
    const SparseLattice<float> shares = matter_shares(grid);
    SparseLattice<float> smooth = shares.copy();
    constexpr int kTile = 32;
    std::vector<Index3> corners;
    const Index3& n = shares.size();
    for (int x = 0; x < n[0]; x += kTile)
        for (int y = 0; y < n[1]; y += kTile)
            for (int z = 0; z < n[2]; z += kTile) corners.push_back({x, y, z});
    std::vector<LatticeBox> boxes(corners.size());
    parallel_items(corners.size(), [&](std::size_t t) {
        LatticeBox& box = boxes[t];
        box.lo = {corners[t][0] - half, corners[t][1] - half, corners[t][2] - half};
        box.size = {kTile + 2 * half, kTile + 2 * half, kTile + 2 * half};
        box.read(shares);
        const float first = box.values.front();
        if (std::all_of(box.values.begin(), box.values.end(), [&](float x) { return x == first; })) {
            box.values.clear();
            return;
        }
        for (std::size_t axis = 0; axis < 3; ++axis) mean_along(box, axis, half);
    });
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const LatticeBox& box = boxes[t];
        if (box.values.empty()) continue;
        for (int i = 0; i < kTile; ++i)
            for (int j = 0; j < kTile; ++j)
                for (int k = 0; k < kTile; ++k) {
                    const Index3 p{corners[t][0] + i, corners[t][1] + j, corners[t][2] + k};
                    if (p[0] < 1 || p[1] < 1 || p[2] < 1 || p[0] > n[0] - 2 || p[1] > n[1] - 2 || p[2] > n[2] - 2) continue;
                    smooth.set(p, box.values[box.index(i + half, j + half, k + half)]);
                }
    }
    set_matter_shares(grid, smooth);
}

VoxelTool smooth_row()
{
    Schema schema{"smooth", "Averages over a cube: rounds what is sharper.", {}};
    schema.parameters = {
        {.name = "radius",
         .type = ParameterType::length,
         .doc = "Half the side of the cube; rounded to whole cells.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    return {std::move(schema), smooth_voxels};
}

// -- weather ---------------------------------------------------------------------------------------------------------

std::function<double(const Vec3d&)> durability_of(const Values& v, std::uint64_t seed)
{
    const std::vector<double> heights = v.has("bed_heights") ? v.vector("bed_heights") : std::vector<double>{};
    const std::vector<double> lasts = v.has("bed_durabilities") ? v.vector("bed_durabilities") : std::vector<double>{1.0};
    if (lasts.size() != heights.size() + 1)
        throw v.problem("bed_durabilities", "the durabilities of the beds", fmt::format("one more than bed_heights: {}", heights.size() + 1),
                        fmt::format("{}", lasts.size()));
    if (!std::is_sorted(heights.begin(), heights.end())) throw v.problem("bed_heights", "the heights between beds", "heights that rise");
    const double blend = v.number("bed_blend"), warp = v.number("bed_warp"), noise = v.number("noise"), wavelength = v.number("noise_wavelength");
    const auto bits = static_cast<std::uint32_t>(seed >> 32);
    return [=](const Vec3d& p) {
        const Noise3 n = fbm(p / wavelength, bits, Fractal{3.0, 2.0, 0.5});
        const double z = warp > 0.0 ? p.z + warp * fbm(Vec2d(p.x, p.y) / (4.0 * wavelength), bits + 1, Fractal{2.0, 2.0, 0.5}).value : p.z;
        double log_lasts = std::log(lasts.front());
        for (std::size_t b = 0; b < heights.size(); ++b)
            log_lasts += (std::log(lasts[b + 1]) - std::log(lasts[b])) * (blend > 0.0 ? smoothstep(0.5 + (z - heights[b]) / blend) : z >= heights[b]);
        return std::exp(log_lasts + noise * n.value);
    };
}

void weather_voxels(VoxelGrid& grid, const Values& v, std::uint64_t seed)
{
    WeatherOptions o;
    o.depth = v.number("depth");
    o.bubble = v.number("bubble");
    o.power = v.number("power");
    if (v.has("ground")) o.ground = v.number("ground");
    o.drop = v.boolean("drop");
    o.durability = durability_of(v, seed);
    try {
        weather(grid, o);
    } catch (const Error& error) {
        const Problem& problem = error.problems().front();
        throw v.problem(problem.what.find("bubble") != std::string::npos ? "bubble" : "depth", problem.what, problem.expected, problem.got);
    }
}

VoxelTool weather_row()
{
    Schema schema{"weather", "Spheroidal weathering: what sees more air decays faster, so that blocks become rounded goblins.", {}};
    const auto positive = [](const std::string& name, const std::string& doc, double fallback) {
        return Parameter{
            .name = name, .type = ParameterType::length, .doc = doc, .fallback = fallback, .unit = "m", .minimum = 0, .above_minimum = true};
    };
    schema.parameters = {
        {.name = "depth",
         .type = ParameterType::length,
         .doc = "By how much a flat face of durability 1 goes back.",
         .required = true,
         .unit = "m",
         .minimum = 0},
        {.name = "bubble",
         .type = ParameterType::length,
         .doc = "Radius of the ball in which air is counted: what is thinner is worn from all sides.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "power",
         .type = ParameterType::number,
         .doc = "Of the share of air in the rate: more rounds more.",
         .fallback = 1.0,
         .minimum = 0,
         .maximum = 8},
        {.name = "ground",
         .type = ParameterType::length,
         .doc = "Height of the ground: below it nothing decays. By default that of the lowest voxels.",
         .unit = "m"},
        {.name = "drop", .type = ParameterType::boolean, .doc = "Whether what has lost its support vanishes.", .fallback = true},
        {.name = "bed_heights",
         .type = ParameterType::vector,
         .doc = "Heights between beds of rock, from below.",
         .unit = "m",
         .min_count = 1,
         .max_count = 64},
        {.name = "bed_durabilities",
         .type = ParameterType::vector,
         .doc = "How much longer than others each bed lasts, from below: one more than there are heights.",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 65},
        {.name = "bed_blend",
         .type = ParameterType::length,
         .doc = "Over which height one bed passes into the next.",
         .fallback = 0.0,
         .unit = "m",
         .minimum = 0},
        {.name = "bed_warp", .type = ParameterType::length, .doc = "By how much beds rise and fall.", .fallback = 0.0, .unit = "m", .minimum = 0},
        {.name = "noise",
         .type = ParameterType::number,
         .doc = "Of the logarithm of the durability: 0.7 halves and doubles it.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 4},
        positive("noise_wavelength", "Of that noise.", 1.0),
    };
    return {std::move(schema), weather_voxels};
}

}  // namespace

std::span<const VoxelTool> voxel_tools()
{
    static const std::vector<VoxelTool> rows = {sculpt_row(), smooth_row(), weather_row()};
    return rows;
}

std::vector<Schema> voxel_edit_schemas()
{
    std::vector<Schema> schemas;
    for (const VoxelTool& tool : voxel_tools()) {
        Schema& schema = schemas.emplace_back(tool.schema);
        schema.parameters.push_back(edit_name_parameter());
    }
    return schemas;
}

void apply_voxel_edit(VoxelGrid& grid, const Values& edit, std::uint64_t seed, std::size_t number)
{
    tool_of(voxel_tools(), edit).apply(grid, edit, edit_seed(edit, seed, number));
    grid.trim();
}

void apply_voxel_edit(VoxelGrid& grid, const std::string& tool, const Node& parameters, std::uint64_t seed, std::size_t number)
{
    static const Schema schema = edit_list_schema(voxel_edit_schemas());
    apply_voxel_edit(grid, checked_edit(schema, tool, parameters), seed, number);
}

}  // namespace hoodoo
