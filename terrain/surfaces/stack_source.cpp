// A stack as a scene writes it: a grid, layers from the bottom up, then edits in their order.
// Every layer is a height over the plane, read as `measure` says: the top the layer reaches, a thickness that is added, or a height above which
// everything is cut away. Heights come from a constant (flat), an image, a named shape (fields/height_shapes.h), or from the ground below (drift:
// sand where it is flat or low). Heights are metres above z = 0 of the world; they are stored as units above the datum, so that high ground wastes no
// steps. Instead of a grid and layers a file may be named (io/stack_file.h), which says all of them; edits follow in either case. Drift: the
// thickness shrinks from full at slopes up to `flat` to none at `steep`, and hollows (below the mean over `reach`) fill up by `fill`. Missing: wind,
// which would make the drift one-sided; layers that follow another layer's boundary in depth.
#include "terrain/surfaces/stack_source.h"

#include "terrain/error.h"
#include "terrain/fields/height_shapes.h"
#include "terrain/io/height_image.h"
#include "terrain/io/stack_file.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace hoodoo
{

namespace
{

using Grid = std::vector<double>;  // one height a column, i fastest

Parameter measure_parameter()
{
    return {.name = "measure",
            .type = ParameterType::choice,
            .doc = "What the height means: the top the layer reaches, its thickness, or above it everything is cut away.",
            .fallback = std::string("top"),
            .choices = {"top", "thickness", "cut"}};
}

std::vector<Schema> layer_schemas()
{
    Schema flat{"flat", "The same height everywhere.", {}};
    flat.parameters = {
        {.name = "top", .type = ParameterType::length, .doc = "Height the layer reaches.", .unit = "m"},
        {.name = "thickness", .type = ParameterType::length, .doc = "Its thickness; instead of `top`.", .unit = "m", .minimum = 0},
    };
    Schema image{"image", "Heights from an image: one pixel a column, row 0 in the north.", {}};
    image.parameters = {
        {.name = "file", .type = ParameterType::path, .doc = "Any image; its first channel.", .required = true},
        {.name = "scale",
         .type = ParameterType::length,
         .doc = "Metres for the value 1 (white, in images of integers).",
         .fallback = 1.0,
         .unit = "m"},
        {.name = "offset", .type = ParameterType::length, .doc = "Metres for the value 0.", .fallback = 0.0, .unit = "m"},
        measure_parameter(),
    };
    for (Parameter& p : bed_parameters()) image.parameters.push_back(std::move(p));
    Schema drift{"drift", "Loose material where the ground below is flat or low.", {}};
    drift.parameters = {
        {.name = "thickness", .type = ParameterType::length, .doc = "On flat ground.", .required = true, .unit = "m", .minimum = 0},
        {.name = "flat",
         .type = ParameterType::angle,
         .doc = "Slopes up to this bear all of it.",
         .fallback = 0.21,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.57},
        {.name = "steep",
         .type = ParameterType::angle,
         .doc = "Slopes from here on bear nothing.",
         .fallback = 0.58,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.57},
        {.name = "fill", .type = ParameterType::number, .doc = "Share of a hollow that is filled.", .fallback = 0.0, .minimum = 0, .maximum = 1},
        {.name = "reach",
         .type = ParameterType::length,
         .doc = "Half-width of the square whose mean height says what is a hollow; 8 cells by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    std::vector<Schema> all = {flat, image, drift};
    for (Schema& shape : height_shape_schemas()) {
        shape.parameters.push_back(measure_parameter());
        all.push_back(std::move(shape));
    }
    for (Schema& schema : all) {
        schema.parameters.push_back({.name = "material",
                                     .type = ParameterType::choice,
                                     .doc = "What the layer consists of.",
                                     .fallback = std::string("bedrock"),
                                     .choices = {"air", "water", "sand", "bedrock", "rock", "soil"}});
        schema.parameters.push_back(
            {.name = "name", .type = ParameterType::text, .doc = "Seeds the layer's noise; by default its number.", .fallback = std::string()});
    }
    return all;
}

/// The grid, and images already read: an image may say how large the grid is.
struct Plan {
    Vec2i size{0, 0};
    double cell = 0.0;
    Vec3d origin{0.0};
    std::vector<std::optional<HeightImage>> images;
};

Plan make_plan(const Values& values, const BuildContext& context)
{
    Plan plan;
    if (values.has("origin")) plan.origin = values.vec3("origin");
    if (values.has("cell")) plan.cell = values.number("cell");
    if (values.has("columns")) {
        const std::vector<double>& n = values.vector("columns");
        plan.size = Vec2i(static_cast<int>(n[0]), static_cast<int>(n[1]));
        if (plan.size.x != n[0] || plan.size.y != n[1]) throw values.problem("columns", "columns of the grid", "whole numbers");
    }
    for (const Values& layer : values.tables("layer")) {
        std::optional<HeightImage>& image = plan.images.emplace_back();
        if (layer.variant() != "image") continue;
        image = read_height_image(context.resolve(layer.text("file"), layer.where("file")));
        if (plan.size.x == 0) plan.size = Vec2i(image->width, image->height);
        if (plan.cell == 0.0) plan.cell = image->cell;
        if (plan.size != Vec2i(image->width, image->height)) {
            throw layer.problem("file", "size of the height image", fmt::format("{} x {} pixels, one a column", plan.size.x, plan.size.y),
                                fmt::format("{} x {}", image->width, image->height));
        }
    }
    if (plan.size.x == 0) throw values.problem("columns", "the size of the grid is not given", "columns = [nx, ny], or a layer from an image");
    if (plan.cell == 0.0) throw values.problem("cell", "the size of a column is not given", "cell = \"... m\", or an image that says it");
    if (static_cast<double>(plan.size.x) * plan.size.y > 134217728.0)
        throw values.problem("columns", "the grid is too large", "at most 134217728 columns");
    return plan;
}

/// The height (or thickness) a layer gives to each column, in metres; `ground` is the top of all layers below it.
Grid heights_of(const Values& layer, const std::optional<HeightImage>& image, std::uint64_t seed, const Plan& plan, const Grid& ground)
{
    Grid heights(ground.size());
    const std::string& shape = layer.variant();
    if (shape == "flat") {
        if (layer.has("top") == layer.has("thickness")) throw layer.problem("top", "a flat layer", "either top or thickness");
        std::fill(heights.begin(), heights.end(), layer.number(layer.has("top") ? "top" : "thickness"));
    } else if (shape == "drift") {
        const Drift drift{layer.number("thickness"), layer.number("flat"), layer.number("steep"), layer.number("fill"),
                          layer.has("reach") ? layer.number("reach") : 8.0 * plan.cell};
        if (!(drift.steep > drift.flat)) throw layer.problem("steep", "the slope that bears nothing", "more than `flat`");
        heights = drift_thickness(ground, plan.size, plan.cell, drift);
    } else if (image) {
        const double scale = layer.number("scale"), offset = layer.number("offset");
        for (int j = 0; j < plan.size.y; ++j) {
            for (int i = 0; i < plan.size.x; ++i) {
                heights[static_cast<std::size_t>(j) * plan.size.x + i] = offset + scale * image->at(i, plan.size.y - 1 - j);
            }
        }
        const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
        if (const auto beds = make_beds(layer, *low, *high, seed)) std::transform(heights.begin(), heights.end(), heights.begin(), beds);
    } else {
        const HeightFunction height = make_height_shape(layer, seed);
        for (int j = 0; j < plan.size.y; ++j) {
            for (int i = 0; i < plan.size.x; ++i) {
                heights[static_cast<std::size_t>(j) * plan.size.x + i] =
                    height(Vec2d(plan.origin.x + (i + 0.5) * plan.cell, plan.origin.y + (j + 0.5) * plan.cell));
            }
        }
    }
    return heights;
}

std::string measure_of(const Values& layer)
{
    if (layer.variant() == "flat") return layer.has("top") ? "top" : "thickness";
    return layer.variant() == "drift" ? "thickness" : layer.text("measure");
}

/// Tops of all layers, metres above z = 0 of the terrain: tops[k] belongs to layer k. A cut lowers all that came before.
std::vector<Grid> layer_tops(const Values& values, const BuildContext& context, const Plan& plan, double datum)
{
    const std::size_t n = static_cast<std::size_t>(plan.size.x) * static_cast<std::size_t>(plan.size.y);
    std::vector<Grid> tops;
    Grid ground(n, datum);
    const std::vector<Values>& layers = values.tables("layer");
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const std::string& name = layers[k].text("name");
        const Grid heights =
            heights_of(layers[k], plan.images[k], hash_name(context.seed, name.empty() ? fmt::format("layer {}", k) : name), plan, ground);
        const std::string measure = measure_of(layers[k]);
        // The first layer is the ground itself: what it says below the datum would be lost. A later one may well end below the ground.
        double lowest = k == 0 && measure == "top" ? *std::min_element(heights.begin(), heights.end()) : datum;
        if (measure == "cut") {
            for (Grid& top : tops)
                std::transform(top.begin(), top.end(), heights.begin(), top.begin(), [](double a, double b) { return std::min(a, b); });
            std::transform(ground.begin(), ground.end(), heights.begin(), ground.begin(), [](double a, double b) { return std::min(a, b); });
        } else {
            for (std::size_t c = 0; c < n; ++c)
                ground[c] = std::max(ground[c], measure == "top" ? heights[c] : ground[c] + std::max(0.0, heights[c]));
        }
        tops.push_back(ground);
        const auto [low, high] = std::minmax_element(ground.begin(), ground.end());
        lowest = std::min(lowest, *low);
        if (!(lowest >= datum) || !std::isfinite(*high)) {
            throw layers[k].problem("material", "heights of a layer",
                                    fmt::format("finite heights above the datum of {} m (set `datum` lower)", datum),
                                    fmt::format("{} to {} m", lowest, *high));
        }
    }
    return tops;
}

}  // namespace

std::vector<Parameter> stack_parameters()
{
    return {
        {.name = "columns",
         .type = ParameterType::vector,
         .doc = "Columns along x and y; by default those of the first image.",
         .minimum = 1,
         .maximum = 1048576,
         .min_count = 2,
         .max_count = 2},
        {.name = "cell",
         .type = ParameterType::length,
         .doc = "Width of a column; by default what the first image says.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "unit",
         .type = ParameterType::length,
         .doc = "Step of heights; by default the finest whole fraction of a cell with which the highest ground fits into 8191 steps.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "Where the south-west corner of the grid lies (0, 0, 0 by default); its z is added to all heights.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "datum",
         .type = ParameterType::length,
         .doc = "Lowest height that can be told (0 by default); below it there is bedrock.",
         .unit = "m"},
        {.name = "sigma",
         .type = ParameterType::length,
         .doc = "Half-width of the kernel's cube; overrides sigma_cells.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "sigma_cells",
         .type = ParameterType::number,
         .doc = "Half-width of the kernel's cube in cells.",
         .fallback = 1.0,
         .unit = "cell",
         .minimum = 0,
         .maximum = 64,
         .above_minimum = true},
        {.name = "stack",
         .type = ParameterType::path,
         .doc = "A deep EXR that hoodoo bake wrote: it says the grid and the layers, so none of them may be given beside it."},
        {.name = "layer",
         .type = ParameterType::tables,
         .doc = "Layers from the bottom up.",
         .min_count = 0,
         .max_count = 64,
         .discriminator = "shape",
         .items = layer_schemas()},
        {.name = "repose_sand",
         .type = ParameterType::angle,
         .doc = "Steepest slope that sand bears: where edits let it slide.",
         .fallback = Repose().sand,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.55},
        {.name = "repose_soil",
         .type = ParameterType::angle,
         .doc = "Steepest slope that soil bears.",
         .fallback = Repose().soil,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.55},
        {.name = "repose_rock",
         .type = ParameterType::angle,
         .doc = "Steepest slope that loose rock bears.",
         .fallback = Repose().rock,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.55},
        {.name = "edit",
         .type = ParameterType::tables,
         .doc = "Edits in their order.",
         .min_count = 0,
         .max_count = 100000,
         .discriminator = "tool",
         .items = edit_schemas()},
    };
}

double stack_kernel(const Values& values, double cell)
{
    const double sigma = values.has("sigma") ? values.number("sigma") : cell * values.number("sigma_cells");
    if (!(sigma <= 64.0 * cell)) throw values.problem(values.has("sigma") ? "sigma" : "sigma_cells", "the kernel is too wide", "at most 64 cells");
    return sigma;
}

/// The finest step that reaches the highest ground. A whole fraction of the cell where it can be: then the kernel is a whole number of steps high,
/// and the field takes integer values that the exact intersector stores without loss in a third of the space.
double default_unit(double highest, double cell)
{
    const double steps = std::floor(MaterialStack::max_top * cell / std::max(highest, 1e-3 * cell));
    return steps >= 1.0 ? cell / std::min(steps, 1024.0) : highest / MaterialStack::max_top;
}

namespace
{

std::shared_ptr<MaterialStack> stack_from_layers(const Values& values, const BuildContext& context)
{
    if (values.tables("layer").empty()) throw values.problem("layer", "a terrain without layers", "[[layer]] tables, or stack = \"FILE.exr\"");
    const Plan plan = make_plan(values, context);
    const double datum = values.has("datum") ? values.number("datum") : 0.0;
    const std::vector<Grid> tops = layer_tops(values, context, plan, datum);
    const double highest = *std::max_element(tops.back().begin(), tops.back().end()) - datum;
    const double unit = values.has("unit") ? values.number("unit") : default_unit(highest, plan.cell);
    if (!(highest / unit < MaterialStack::max_top + 0.5)) {
        throw values.problem("unit", "the ground is too high for this unit", fmt::format("at least {:.6g} m", highest / MaterialStack::max_top),
                             fmt::format("{} m", unit));
    }
    const auto stack = std::make_shared<MaterialStack>(plan.size, plan.cell, unit, plan.origin + Vec3d(0, 0, datum));
    const std::vector<Values>& layers = values.tables("layer");
    std::vector<Material> materials;
    for (const Values& layer : layers) materials.push_back(material_from_name(layer.text("material")));

    // Row by row of tiles, so that the unpacked columns never take much memory.
    for (int j0 = 0; j0 < plan.size.y; j0 += MaterialStack::tile_size) {
        const int j1 = std::min(j0 + MaterialStack::tile_size, plan.size.y);
        std::vector<std::vector<Layer>> columns;
        for (std::size_t c = static_cast<std::size_t>(j0) * plan.size.x; c < static_cast<std::size_t>(j1) * plan.size.x; ++c) {
            std::vector<Layer>& column = columns.emplace_back();
            for (std::size_t k = 0; k < layers.size(); ++k) {
                if (measure_of(layers[k]) != "cut")
                    column.push_back({materials[k], static_cast<std::int32_t>(std::lround((tops[k][c] - datum) / unit))});
            }
        }
        stack->set_columns({0, j0}, {plan.size.x, j1}, columns);
    }
    return stack;
}

std::shared_ptr<MaterialStack> stack_from_file(const Values& values, const BuildContext& context)
{
    for (const char* key : {"columns", "cell", "unit", "origin", "datum", "layer"}) {
        const bool given = std::string(key) == "layer" ? !values.tables(key).empty() : values.has(key);
        if (given) throw values.problem(key, fmt::format("`{}` beside `stack`", key), "one of them: the file says the grid and the layers");
    }
    return read_stack_file(context.resolve(values.text("stack"), values.where("stack")), values.where("stack"));
}

}  // namespace

EditContext edit_context(const Values& values, const BuildContext& context, double cell)
{
    return {
        .sigma = stack_kernel(values, cell),
        .repose = {values.number("repose_sand"), values.number("repose_soil"), values.number("repose_rock")},
        .resolve = context.resolve,
    };
}

std::shared_ptr<MaterialStack> make_stack(const Values& values, const BuildContext& context)
{
    const auto stack = values.has("stack") ? stack_from_file(values, context) : stack_from_layers(values, context);
    const std::vector<Values>& edits = values.tables("edit");
    const EditContext how = edit_context(values, context, stack->cell());
    for (std::size_t k = 0; k < edits.size(); ++k) apply_edit(*stack, edits[k], context.seed, k, how);
    return stack;
}

}  // namespace hoodoo
