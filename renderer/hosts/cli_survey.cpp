// A terrain as a researcher looks at it: samples, sections, contours, hillshade, the error of a mesh.
#include "renderer/hosts/cli.h"

#include "renderer/survey.h"
#include "terrain/analysis/slopes.h"
#include "terrain/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hoodoo::cli
{

namespace
{

[[noreturn]] void refuse(std::string what, std::string expected, std::string got = {})
{
    throw Error(ErrorKind::scene, Problem{{}, std::move(what), std::move(expected), std::move(got), {}});
}

/// x0,x1,y0,y1[,z0,z1] over the terrain's own; all sides finite.
Box3d box_of(const SurveyArguments& arguments, const SurveyedTerrain& terrain)
{
    Box3d box = terrain.bounds;
    for (std::size_t k = 0; 2 * k + 1 < arguments.bounds.size(); ++k) {
        box.min[static_cast<int>(k)] = arguments.bounds[2 * k];
        box.max[static_cast<int>(k)] = arguments.bounds[2 * k + 1];
    }
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(box.min[k]) || !std::isfinite(box.max[k])) refuse("the terrain has no end: say which part", "--bounds x0,x1,y0,y1,z0,z1");
        if (!(box.min[k] <= box.max[k])) refuse("--bounds are no bounds", "x0 < x1, y0 < y1, z0 < z1");
    }
    return box;
}

/// Of a scene's terrain, seen from above; or of an elevation model.
HeightImage heights_of(const SurveyArguments& arguments, Progress& progress)
{
    if (!arguments.scene.scene.ends_with(".toml")) {
        DemOptions options;
        options.cell_x = options.cell_y = arguments.cell;
        options.scale = arguments.scale;
        return import_dem(arguments.scene.scene, options);
    }
    const LoadedScene loaded = load(arguments.scene, progress);
    const SurveyedTerrain terrain = survey(loaded, arguments.terrain);
    const Box3d box = box_of(arguments, terrain);
    const double cell = arguments.cell > 0.0 ? arguments.cell : std::max(box.size().x, box.size().y) / 1024.0;
    HeightImage heights = heights_from_above(terrain, {{box.min.x, box.min.y}, {box.max.x, box.max.y}}, cell);
    if (std::none_of(heights.values.begin(), heights.values.end(), [](float z) { return std::isfinite(z); }))
        refuse("nothing of the terrain lies in the area", "--bounds over it");
    return heights;
}

}  // namespace

int run_sample(const SurveyArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const LoadedScene loaded = load(arguments.scene, progress);
    const SurveyedTerrain terrain = survey(loaded, arguments.terrain);
    const Box3d box = box_of(arguments, terrain);
    std::array<int, 3> count{1, 1, 1};
    std::copy(arguments.grid.begin(), arguments.grid.end(), count.begin());
    if (static_cast<double>(count[0]) * count[1] * count[2] > 2147483648.0)
        refuse("--grid has too many nodes", "at most 2147483648", fmt::format("{} x {} x {}", count[0], count[1], count[2]));
    const SampledGrid grid = sample_field(terrain, box, count);
    write_grid_file(arguments.output, grid);
    progress.finish();
    const auto [low, high] = std::minmax_element(grid.values.begin(), grid.values.end());
    if (!arguments.scene.quiet)
        fmt::print(stderr,
                   "wrote {}: {} x {} x {} values from {:.6g} to {:.6g}; first at ({:.6g}, {:.6g}, {:.6g}), step ({:.6g}, {:.6g}, {:.6g}) m\n",
                   arguments.output, count[0], count[1], count[2], *low, *high, grid.origin.x, grid.origin.y, grid.origin.z, grid.step.x, grid.step.y,
                   grid.step.z);
    return 0;
}

int run_section(const SurveyArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const LoadedScene loaded = load(arguments.scene, progress);
    const SurveyedTerrain terrain = survey(loaded, arguments.terrain);
    const Vec2d from(arguments.from[0], arguments.from[1]), to(arguments.to[0], arguments.to[1]);
    const double length = (to - from).length();
    if (!(length > 0.0)) refuse("the section has no length", "--from and --to that differ");
    Interval heights{terrain.bounds.min.z, terrain.bounds.max.z};
    if (arguments.heights.size() == 2) heights = {arguments.heights[0], arguments.heights[1]};
    if (arguments.heights.empty()) {
        // Room below and above what can be hit.
        const double room = 0.05 * std::max(heights.hi - heights.lo, 0.02 * length);
        heights = {heights.lo - room, heights.hi + room};
    }
    if (!std::isfinite(heights.lo) || !std::isfinite(heights.hi) || !(heights.lo < heights.hi))
        refuse("the heights of the section", "--heights z0,z1 with z0 < z1");
    if (arguments.columns * (heights.hi - heights.lo) / length > 16384.0)
        refuse("the section would be too tall a picture", "--heights nearer to each other");
    draw_section(terrain, from, to, heights, arguments.columns).write(arguments.output);
    progress.finish();
    if (!arguments.scene.quiet)
        fmt::print(stderr, "wrote {}: {:.6g} m along, {:.6g} to {:.6g} m up, {:.6g} m a pixel\n", arguments.output, length, heights.lo, heights.hi,
                   length / arguments.columns);
    return 0;
}

int run_contours(const SurveyArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const HeightImage heights = heights_of(arguments, progress);
    const auto [low, high] =
        std::minmax_element(heights.values.begin(), heights.values.end(), [](float a, float b) { return !std::isnan(a) && !std::isnan(b) && a < b; });
    if (arguments.interval < (static_cast<double>(*high) - *low) / 2000.0)
        refuse("--interval makes too many contours", "at most 2000 over the terrain",
               fmt::format("{:.6g} m over {:.6g} m", arguments.interval, static_cast<double>(*high) - *low));
    draw_contours(heights, arguments.interval, std::max(1.0, std::round(1024.0 / heights.width))).write(arguments.output);
    progress.finish();
    if (!arguments.scene.quiet)
        fmt::print(stderr, "wrote {}: contours every {:.6g} m of {} x {} heights, {:.6g} m apart\n", arguments.output, arguments.interval,
                   heights.width, heights.height, heights.cell);
    return 0;
}

int run_hillshade(const SurveyArguments& arguments)
{
    check_output(arguments.output);
    Progress progress(arguments.scene.quiet);
    const HeightImage heights = heights_of(arguments, progress);
    // Where nothing is, the lowest height stands in, and is white in the end.
    std::vector<double> z(heights.values.begin(), heights.values.end());
    double low = kInfinity;
    for (const double h : z)
        if (std::isfinite(h)) low = std::min(low, h);
    for (double& h : z) h = std::isfinite(h) ? h : low;
    const std::vector<double> light =
        hillshade({z, heights.width, heights.height, heights.cell}, arguments.azimuth, arguments.altitude, arguments.exaggeration);
    std::vector<std::uint8_t> grey(light.size());
    for (std::size_t k = 0; k < light.size(); ++k)
        grey[k] = std::isfinite(heights.values[k]) ? static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(light[k], 0.0, 1.0))) : 255;
    write_png_bytes(arguments.output, heights.width, heights.height, 1, grey);
    progress.finish();
    if (!arguments.scene.quiet)
        fmt::print(stderr, "wrote {}: {} x {} pixels of {:.6g} m\n", arguments.output, heights.width, heights.height, heights.cell);
    return 0;
}

int run_mesh_error(const SurveyArguments& arguments)
{
    Progress progress(arguments.scene.quiet);
    const LoadedScene loaded = load(arguments.scene, progress);
    const SurveyedTerrain terrain = survey(loaded, arguments.terrain);
    MeshFileOptions options;
    options.y_up = arguments.y_up;
    const TriangleMesh mesh = read_mesh_file(arguments.mesh, options, {arguments.mesh, 0, 0, {}});
    const double reach = arguments.reach > 0.0 ? arguments.reach : 0.02 * mesh_bounds(mesh).size().length();
    const MeshError error = mesh_error(terrain, mesh, reach);
    progress.finish();
    print(fmt::format(
        "{{\"triangles\": {}, \"area\": {:.6g}, \"mean_error\": {:.6g}, \"rms_error\": {:.6g}, \"maximum_error\": {:.6g}, \"reach\": {:.6g}, "
        "\"far_triangles\": {}}}\n",
        error.triangles, error.area, error.mean, error.rms, error.maximum, reach, error.far_triangles));
    return 0;
}

}  // namespace hoodoo::cli
