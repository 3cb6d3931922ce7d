// What one measures on an elevation model, as channels of an EXR.
#include "renderer/hosts/cli.h"

#include "terrain/analysis/drainage.h"
#include "terrain/analysis/slopes.h"
#include "terrain/io/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace hoodoo::cli
{

int run_analyse(const ImportArguments& arguments)
{
    check_output(arguments.output);
    const HeightImage heights = import_dem(arguments.input, arguments.options);
    const std::vector<double> z(heights.values.begin(), heights.values.end());
    const Elevation elevation{z, heights.width, heights.height, heights.cell};
    const std::vector<Curvature> bends = curvatures(elevation);
    const Drainage water = drainage(elevation);

    Raster raster{heights.width, heights.height, heights.cell, {}, {}, heights.place};
    const auto add = [&](const char* name, const std::vector<double>& values) {
        raster.names.emplace_back(name);
        raster.channels.emplace_back(values.begin(), values.end());
    };
    const auto add_bend = [&](const char* name, double Curvature::*member) {
        std::vector<double> values(bends.size());
        std::transform(bends.begin(), bends.end(), values.begin(), [&](const Curvature& c) { return c.*member; });
        add(name, values);
    };
    add("height", z);
    add("slope", slope(elevation));
    add("aspect", aspect(elevation));
    add_bend("plan", &Curvature::plan);
    add_bend("profile", &Curvature::profile);
    add_bend("contour", &Curvature::contour);
    add_bend("normal", &Curvature::normal);
    add_bend("tangential", &Curvature::tangential);
    add("drainage", water.area);
    add("wetness", wetness(water, heights.cell, WetnessKind::tangent));
    add("wetness_cover", wetness(water, heights.cell, WetnessKind::cover));
    write_raster(arguments.output, raster);
    if (arguments.quiet) return 0;
    fmt::print(stderr, "wrote {}: {} x {} cells of {:.6g} m\n", arguments.output, heights.width, heights.height, heights.cell);
    for (std::size_t c = 0; c < raster.names.size(); ++c) {
        const auto [low, high] = std::minmax_element(raster.channels[c].begin(), raster.channels[c].end());
        fmt::print(stderr, "  {:<14} {:.6g} to {:.6g}\n", raster.names[c], *low, *high);
    }
    return 0;
}

}  // namespace hoodoo::cli
