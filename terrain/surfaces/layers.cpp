// Bedrock, sand and water as maps over one grid: the layered height field, each layer a thickness on the one below.
// GalinCourse, "Layered representations"; Benes2001. h = bedrock + sand is the ground, h + water the water, each met as the two triangles a cell that
// heightfield has (march/grid_rays.h); the water is a body of its own, open at the sides of the grid. Sand at rest: the maps become columns in whole
// units (stack/layer_maps.h), slide as those do (edit/stabilise.h), and come back. Where a shore is dry the water's surface goes on level below the
// ground up to the next sample, so that the line between them is that of the ground, not of the grid. Sand covers rock where it is `cover` thick, and
// shows in proportion where it is thinner. Deviation: between samples layers are as wide as their triangles. Missing: overhangs (`convolution` has
// them); other materials.
#include "terrain/edit/stabilise.h"
#include "terrain/error.h"
#include "terrain/io/height_image.h"
#include "terrain/io/npz.h"
#include "terrain/io/stack_file.h"
#include "terrain/stack/layer_maps.h"
#include "terrain/surfaces/grid_hit.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>

namespace hoodoo
{

namespace
{

enum Shown : std::uint8_t { kBedrock, kSand, kWater };

/// Heights are kept as floats above `base`.
std::unique_ptr<HeightGrid> grid_of(const LayerMaps& maps, double base, const std::function<double(std::size_t)>& height)
{
    const Vec3d south_west(maps.origin.x + 0.5 * maps.cell, maps.origin.y + 0.5 * maps.cell, base);
    auto grid = std::make_unique<HeightGrid>(GridFrame{south_west, Vec2d(maps.cell), 1.0}, maps.size.x, maps.size.y, SampleType::f32);
    for (int j = 0; j < maps.size.y; ++j)
        for (int i = 0; i < maps.size.x; ++i) grid->set(i, j, height(maps.index(i, j)) - base);
    grid->summarise();
    return grid;
}

/// The water's surface at each column: where it is dry the highest of wet neighbours, but below the ground.
std::vector<double> water_heights(const LayerMaps& maps)
{
    std::vector<double> out(maps.water.size());
    for (int j = 0; j < maps.size.y; ++j) {
        for (int i = 0; i < maps.size.x; ++i) {
            const std::size_t k = maps.index(i, j);
            double level = maps.water[k] > 0.0 ? maps.top(k) : -kInfinity;
            for (int v = std::max(0, j - 1); maps.water[k] == 0.0 && v <= std::min(j + 1, maps.size.y - 1); ++v)
                for (int u = std::max(0, i - 1); u <= std::min(i + 1, maps.size.x - 1); ++u)
                    if (const std::size_t n = maps.index(u, v); maps.water[n] > 0.0) level = std::max(level, maps.top(n));
            // Far from water no ray asks; a millimetre is more than floats of a mountain's height lose.
            out[k] = maps.water[k] > 0.0 ? level : std::min(level, maps.ground(k) - 1e-3);
            if (!std::isfinite(out[k])) out[k] = maps.ground(k) - maps.cell;
        }
    }
    return out;
}

class LayersSurface final : public Surface
{
public:
    LayersSurface(const LayerMaps& maps, double cover) : cover_(cover)
    {
        const double base = *std::min_element(maps.bedrock.begin(), maps.bedrock.end());
        ground_ = grid_of(maps, base, [&](std::size_t k) { return maps.ground(k); });
        sand_ = grid_of(maps, 0.0, [&](std::size_t k) { return maps.sand[k]; });
        field_ = std::make_unique<HeightAsField>(*ground_);
        if (std::all_of(maps.water.begin(), maps.water.end(), [](double w) { return w == 0.0; })) return;
        const std::vector<double> heights = water_heights(maps);
        water_ = grid_of(maps, base, [&](std::size_t k) { return heights[k]; });
        for (int block = 0; block < water_->blocks_across() * water_->blocks_up(); ++block) {
            const int i0 = block % water_->blocks_across() * HeightGrid::kBlock, j0 = block / water_->blocks_across() * HeightGrid::kBlock;
            bool wet = false;
            for (int j = j0; j <= std::min(j0 + HeightGrid::kBlock, maps.size.y - 1); ++j)
                for (int i = i0; i <= std::min(i0 + HeightGrid::kBlock, maps.size.x - 1); ++i) wet = wet || maps.water[maps.index(i, j)] > 0.0;
            if (wet) wet_blocks_.push_back(block);
        }
    }
    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t tile_count() const override { return 2; }
    std::uint32_t patch_count(std::uint32_t tile) const override
    {
        return static_cast<std::uint32_t>(tile == 0 ? static_cast<std::size_t>(ground_->blocks_across() * ground_->blocks_up()) : wet_blocks_.size());
    }
    Box3d patch_bounds(PatchId patch) const override { return block_bounds(grid(patch), block(patch)); }

    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        Hit found = hit;
        Ray rest = ray;
        for (bool met = meet_grid(grid(patch), block(patch), rest, found); met; met = meet_grid(grid(patch), block(patch), rest, found)) {
            hit.evaluations = found.evaluations;
            const Vec3d p = ray.at(found.t);
            // Below the ground there is no water.
            if (patch.tile == 0 || p.z >= ground_->height({p.x, p.y})) {
                hit.t = found.t;
                hit.patch = patch;
                return true;
            }
            rest.t_min = found.t;
            found.t = hit.t;
        }
        hit.evaluations = found.evaluations;
        return false;
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        // The very crossing: those of water before it lie below the ground.
        Ray rest = ray;
        Hit found;
        while (hit.patch.tile == 1 && meet_grid(grid(hit.patch), block(hit.patch), rest, found) && found.t < hit.t) {
            rest.t_min = found.t;
            found.t = kInfinity;
        }
        Interaction at = grid_interaction(grid(hit.patch), block(hit.patch), rest, hit);
        if (hit.patch.tile == 0) {
            dress(at);
            return at;
        }
        at.shading_normal = at.geometric_normal;
        at.texture_point = at.position;
        at.materials.add(kWater, 1.0f);
        return at;
    }

    void dress(Interaction& at) const override
    {
        const Vec2d over(at.position.x, at.position.y);
        at.shading_normal = into_hemisphere(ground_->smooth_normal(over), at.geometric_normal);
        at.texture_point = at.position;
        const double share = std::clamp(sand_->height(over) / cover_, 0.0, 1.0);
        if (share < 1.0) at.materials.add(kBedrock, static_cast<float>(1.0 - share));
        if (share > 0.0) at.materials.add(kSand, static_cast<float>(share));
    }

    bool contains(const Vec3d& p) const override
    {
        const Vec2d over(p.x, p.y);
        return p.z <= ground_->height(over) || (water_ && p.z <= water_->height(over));
    }
    std::vector<std::string> materials() const override { return {"bedrock", "sand", "water"}; }
    bool closed() const override { return false; }
    const Field* field() const override { return water_ ? nullptr : field_.get(); }
    std::vector<const Field*> fields() const override { return {field_.get()}; }
    /// With water there are two.
    const Height* height() const override { return water_ ? nullptr : ground_.get(); }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.columns = static_cast<std::uint64_t>(ground_->columns()) * static_cast<std::uint64_t>(ground_->rows());
        info.layers = info.columns * (water_ ? 3 : 2);
        info.trace_bytes = sizeof(*this) + wet_blocks_.capacity() * sizeof(int);
        for (const HeightGrid* grid : {ground_.get(), sand_.get(), water_.get()})
            if (grid) info.trace_bytes += grid->sample_bytes() + grid->summary_bytes();
        info.patches = patch_count(0) + patch_count(1);
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    const HeightGrid& grid(PatchId patch) const { return patch.tile == 0 ? *ground_ : *water_; }
    int block(PatchId patch) const { return patch.tile == 0 ? static_cast<int>(patch.index) : wet_blocks_[patch.index]; }

    std::unique_ptr<HeightGrid> ground_, sand_, water_;
    std::unique_ptr<HeightAsField> field_;
    std::vector<int> wet_blocks_;
    double cover_;
    double build_seconds_ = 0.0;
};

// -- Reading -----------------------------------------------------------------------------------------------------------

/// The only array of an archive that has two dimensions, as a picture.
HeightImage read_array(const std::string& path, const Values& values, const std::string& name)
{
    const NpzFile archive(path);
    HeightImage image;
    for (const std::string& array : archive.names()) {
        const NumpyArray numbers = archive.read(array);
        if (numbers.shape.size() != 2) continue;
        if (image.width > 0) throw values.problem(name, "several maps in one archive", "one array with two dimensions");
        image.height = static_cast<int>(numbers.shape[0]);
        image.width = static_cast<int>(numbers.shape[1]);
        image.values.assign(numbers.values.begin(), numbers.values.end());
    }
    if (image.width == 0) throw values.problem(name, "no map in this archive", "one array with two dimensions");
    return image;
}

std::optional<HeightImage> read_map(const Values& values, const BuildContext& context, const std::string& name)
{
    if (!values.has(name)) return std::nullopt;
    const std::string path = context.resolve(values.text(name), values.where(name));
    return path.ends_with(".npz") ? read_array(path, values, name) : read_height_image(path);
}

LayerMaps maps_from_images(const Values& values, const BuildContext& context)
{
    LayerMaps maps;
    const auto bedrock = read_map(values, context, "bedrock");
    if (!bedrock) throw values.problem("bedrock", "layers without bedrock", "bedrock = \"FILE\", or stack = \"FILE.exr\"");
    maps.size = {bedrock->width, bedrock->height};
    maps.cell = values.has("cell") ? values.number("cell") : bedrock->cell;
    if (!(maps.cell > 0.0)) throw values.problem("bedrock", "how large its pixels are nobody says", "cell (metres), or an image that says it");
    maps.origin = values.vec2("origin");
    const auto fill = [&](const std::string& name, const std::optional<HeightImage>& image, std::vector<double>& out, double offset) {
        out.assign(static_cast<std::size_t>(maps.size.x) * static_cast<std::size_t>(maps.size.y), offset);
        if (!image) return;
        if (Vec2i(image->width, image->height) != maps.size)
            throw values.problem(name, "the size of a layer's map", fmt::format("{} x {} like the bedrock", maps.size.x, maps.size.y),
                                 fmt::format("{} x {}", image->width, image->height));
        for (int j = 0; j < maps.size.y; ++j) {
            for (int i = 0; i < maps.size.x; ++i) {
                const double z = offset + values.number(name + "_scale") * image->at(i, maps.size.y - 1 - j);
                if (!std::isfinite(z) || (name != "bedrock" && z < 0.0))
                    throw values.problem(name, "a number of a layer's map", name == "bedrock" ? "finite" : "a thickness, 0 or more",
                                         fmt::format("{} m at column {}, row {}", z, i, maps.size.y - 1 - j));
                out[maps.index(i, j)] = z;
            }
        }
    };
    fill("bedrock", bedrock, maps.bedrock, values.number("bedrock_offset"));
    fill("sand", read_map(values, context, "sand"), maps.sand, values.number("sand_depth"));
    fill("water", read_map(values, context, "water"), maps.water, 0.0);
    return maps;
}

/// All sand and water at rest.
LayerMaps settled(const LayerMaps& maps, double unit, double repose)
{
    MaterialStack stack = to_stack(maps, unit);
    std::vector<std::uint32_t> all(maps.bedrock.size());
    std::iota(all.begin(), all.end(), 0u);
    Repose angles;
    angles.sand = repose;
    stabilise(stack, ColumnSet(maps.size, std::move(all)), angles);
    return from_stack(stack, {});
}

LayerMaps make_maps(const Values& values, const BuildContext& context)
{
    LayerMaps maps;
    if (values.has("stack")) {
        for (const char* key : {"bedrock", "sand", "water", "cell"})
            if (values.has(key)) throw values.problem(key, fmt::format("`{}` beside `stack`", key), "one of them: the file says all layers");
        maps =
            from_stack(*read_stack_file(context.resolve(values.text("stack"), values.where("stack")), values.where("stack")), values.where("stack"));
    } else {
        maps = maps_from_images(values, context);
    }
    if (maps.size.x < 2 || maps.size.y < 2) throw values.problem("bedrock", "the layers are too few columns", "at least 2 x 2");
    const double unit = values.has("unit") ? values.number("unit") : finest_unit(maps);
    if (values.boolean("settle")) maps = settled(maps, unit, values.number("repose_sand"));
    if (values.has("water_level"))
        for (std::size_t k = 0; k < maps.water.size(); ++k) maps.water[k] = std::max(maps.water[k], values.number("water_level") - maps.ground(k));
    return maps;
}

Shape make_layers(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    if (context.progress) context.progress(0.0, "layers");
    auto surface = std::make_unique<LayersSurface>(make_maps(values, context), values.number("cover"));
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

std::shared_ptr<MaterialStack> make_layers_stack(const Values& values, const BuildContext& context)
{
    const LayerMaps maps = make_maps(values, context);
    return std::make_shared<MaterialStack>(to_stack(maps, values.has("unit") ? values.number("unit") : finest_unit(maps)));
}

void add_map(Schema& schema, const std::string& name, const std::string& doc)
{
    schema.parameters.push_back({.name = name,
                                 .type = ParameterType::path,
                                 .doc = doc + " Any image, its first channel, or a NumPy archive of one array; row 0 is the north."});
    schema.parameters.push_back({.name = name + "_scale",
                                 .type = ParameterType::length,
                                 .doc = "Metres for its 1 (for white, in images of integers).",
                                 .fallback = 1.0,
                                 .unit = "m"});
}

}  // namespace

CatalogueEntry layers_row()
{
    Schema schema{"layers", "Bedrock, sand on it and water on that, as maps: a layered height field whose sand can slide to rest.", {}};
    add_map(schema, "bedrock", "Height of the bedrock.");
    schema.parameters.push_back({.name = "bedrock_offset", .type = ParameterType::length, .doc = "Metres for its 0.", .fallback = 0.0, .unit = "m"});
    add_map(schema, "sand", "Thickness of the sand.");
    schema.parameters.push_back(
        {.name = "sand_depth", .type = ParameterType::length, .doc = "Sand everywhere, beside the map.", .fallback = 0.0, .unit = "m", .minimum = 0});
    add_map(schema, "water", "Depth of the water.");
    const std::vector<Parameter> more = {
        {.name = "water_level", .type = ParameterType::length, .doc = "Everything lower is filled with water up to here.", .unit = "m"},
        {.name = "stack",
         .type = ParameterType::path,
         .doc = "A deep EXR that hoodoo bake wrote, of columns that are bedrock, sand, water in that order."},
        {.name = "cell",
         .type = ParameterType::length,
         .doc = "Distance between samples; by default what the bedrock's file says.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "South-western corner of the grid; samples lie half a cell inwards.",
         .fallback = std::vector<double>{0, 0},
         .unit = "m",
         .min_count = 2,
         .max_count = 2},
        {.name = "settle", .type = ParameterType::boolean, .doc = "Sand and water come to rest.", .fallback = false},
        {.name = "repose_sand",
         .type = ParameterType::angle,
         .doc = "Steepest slope that sand bears.",
         .fallback = Repose().sand,
         .unit = "rad",
         .minimum = 0,
         .maximum = 1.55},
        {.name = "unit",
         .type = ParameterType::length,
         .doc = "Step of heights while they settle and in baked columns; by default the finest that holds them.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "cover",
         .type = ParameterType::length,
         .doc = "Sand this thick hides the rock.",
         .fallback = 0.2,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    schema.parameters.insert(schema.parameters.end(), more.begin(), more.end());
    return {"layers", "GalinCourse", std::move(schema), make_layers, make_layers_stack};
}

}  // namespace hoodoo
