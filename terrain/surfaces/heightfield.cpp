// Sampled elevation, traced as its own two triangles a cell: an image of heights that never becomes a mesh.
// GalinCourse, "Elevation maps"; fields/heightgrid.h has the samples and march/grid_rays.h the rays. What the tracer's tree holds is a box for every
// 16 x 16 cells. Samples stay as their file has them, in 8, 16 or 32 bits; a file larger than memory would allow as floats is read a row of tiles at
// a time. Metres come from the scene or from the file (import-dem's attributes, GeoTIFF tags). Normals are those of the triangles; `smooth` blends
// shading normals between the nodes. The surface ends at the samples on the border. Deviation: one height over each point, as ever; what hangs over
// is for other representations. Missing: geometry between samples finer than the triangles (`elevation` has it from noise).
#include "terrain/error.h"
#include "terrain/fields/grid_fill.h"
#include "terrain/io/height_file.h"
#include "terrain/surfaces/grid_hit.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace hoodoo
{

namespace
{

class HeightfieldSurface final : public Surface, public Georeferenced
{
public:
    HeightfieldSurface(std::unique_ptr<HeightGrid> grid, GeoReference place, bool smooth, std::string material)
        : grid_(std::move(grid)), field_(*grid_), place_(std::move(place)), smooth_(smooth), material_(std::move(material))
    {
    }
    void set_build_seconds(double seconds) { build_seconds_ = seconds; }

    std::uint32_t patch_count(std::uint32_t) const override { return static_cast<std::uint32_t>(grid_->blocks_across() * grid_->blocks_up()); }
    Box3d patch_bounds(PatchId patch) const override { return block_bounds(*grid_, static_cast<int>(patch.index)); }

    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        if (!meet_grid(*grid_, static_cast<int>(patch.index), ray, hit)) return false;
        hit.patch = patch;
        return true;
    }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at = grid_interaction(*grid_, static_cast<int>(hit.patch.index), ray, hit);
        dress(at);
        return at;
    }

    void dress(Interaction& at) const override
    {
        const Vec2d over(at.position.x, at.position.y);
        at.shading_normal = smooth_ ? into_hemisphere(grid_->smooth_normal(over), at.geometric_normal) : at.geometric_normal;
        const Box2d domain = grid_->domain();
        at.uv = Vec2d((over.x - domain.min.x) / (domain.max.x - domain.min.x), (over.y - domain.min.y) / (domain.max.y - domain.min.y));
        at.texture_point = at.position;
        at.materials.add(0, 1.0f);
    }

    bool contains(const Vec3d& p) const override { return p.z <= grid_->height({p.x, p.y}); }
    std::vector<std::string> materials() const override { return {material_}; }
    bool closed() const override { return false; }
    const Field* field() const override { return &field_; }
    const Height* height() const override { return grid_.get(); }
    std::vector<CoarserField> coarser_fields(double width) const override
    {
        struct Coarser {
            explicit Coarser(const HeightGrid& finer) : grid(halved(finer)), field(*grid) {}
            std::unique_ptr<HeightGrid> grid;
            HeightAsField field;
        };
        std::vector<CoarserField> coarser;
        const HeightGrid* finer = grid_.get();
        const Vec2d cell = grid_->frame().cell;
        for (double side = 2.0 * std::max(cell.x, cell.y); side < 2.0 * width && finer->columns() > 4 && finer->rows() > 4; side *= 2.0) {
            const auto own = std::make_shared<Coarser>(*finer);
            finer = own->grid.get();
            coarser.push_back({side, std::shared_ptr<const Field>(own, &own->field)});
        }
        return coarser;
    }

    GeoReference world_to_earth() const override
    {
        // Node (i, row) is the middle of a pixel; rows of the map count from the north.
        const GridFrame& f = grid_->frame();
        const auto& m = place_.map;
        const double column = 0.5 - f.origin.x / f.cell.x, row = grid_->rows() - 0.5 + f.origin.y / f.cell.y;
        return {place_.system,
                {m[0] + m[1] * column + m[2] * row, m[1] / f.cell.x, 0.0 - m[2] / f.cell.y, m[3] + m[4] * column + m[5] * row, m[4] / f.cell.x,
                 0.0 - m[5] / f.cell.y}};
    }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.columns = static_cast<std::uint64_t>(grid_->columns()) * static_cast<std::uint64_t>(grid_->rows());
        info.trace_bytes = sizeof(*this) + grid_->sample_bytes() + grid_->summary_bytes();
        info.patches = patch_count(0);
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    std::unique_ptr<HeightGrid> grid_;
    HeightAsField field_;
    GeoReference place_;
    bool smooth_;
    std::string material_;
    double build_seconds_ = 0.0;
};

/// Metres a stored 1, as told or as the file says.
double height_scale(const Values& values, const HeightFileInfo& file)
{
    if (values.has("white")) {
        if (values.has("height_scale")) throw values.problem("white", "white and height_scale say the same thing twice", "one of them");
        if (!file.is_unsigned) throw values.problem("white", "this file has no white: its numbers are heights", "height_scale, or neither");
        return values.number("white") / file.largest;
    }
    if (values.has("height_scale")) return values.number("height_scale");
    if (file.height_scale > 0.0) return file.height_scale;
    if (file.is_unsigned && !file.place.known())
        throw values.problem("file", "how high this image is nobody says", "white (metres) or height_scale (metres a step)", "unsigned integers");
    return 1.0;
}

GridFrame frame_of(const Values& values, const HeightFileInfo& file)
{
    GridFrame frame;
    frame.cell = values.has("cell") ? Vec2d(values.vector("cell").front(), values.vector("cell").back()) : file.cell;
    if (!(frame.cell.x > 0.0 && frame.cell.y > 0.0))
        throw values.problem("file", "how large its pixels are nobody says", "cell (metres), or a file with a projected coordinate system");
    frame.scale = height_scale(values, file);
    frame.origin = values.vec3("origin");
    if (values.boolean("centred")) {
        frame.origin.x -= 0.5 * (file.columns - 1) * frame.cell.x;
        frame.origin.y -= 0.5 * (file.rows - 1) * frame.cell.y;
    }
    return frame;
}

void fill_gaps(const Values& values, const HeightFileInfo& file, HeightGrid& grid)
{
    const std::optional<double> no_data = values.has("no_data") ? std::optional(values.number("no_data")) : file.no_data;
    if (grid.type() != SampleType::f32 && !no_data) return;
    const MissingSamples missing = find_missing(grid, no_data);
    if (missing.count == 0) return;
    const std::string& fill = values.text("fill");
    const auto all = static_cast<std::uint64_t>(grid.columns()) * static_cast<std::uint64_t>(grid.rows());
    if (fill == "none" || (fill == "around" && missing.count == all)) {
        throw values.problem("file", "heights are missing in the file",
                             fill == "none" ? "a height everywhere, or fill = \"around\" or \"level\"" : "any height",
                             fmt::format("{} of {} samples without one, the first at column {}, row {}", missing.count, all, missing.column,
                                         grid.rows() - 1 - missing.row));
    }
    if (fill == "around") return fill_missing_from_around(grid, no_data);
    const double sample = (values.number("fill_height") - grid.frame().origin.z) / grid.frame().scale;
    if (grid.type() != SampleType::f32 && !(std::round(sample) >= (grid.type() == SampleType::i16 ? -32768.0 : 0.0) &&
                                            std::round(sample) <= (grid.type() == SampleType::u8    ? 255.0
                                                                   : grid.type() == SampleType::u16 ? 65535.0
                                                                                                    : 32767.0)))
        throw values.problem("fill_height", "the file's numbers cannot hold this height", "a height among those of the file",
                             fmt::format("{} m", values.number("fill_height")));
    fill_missing_with(grid, no_data, grid.type() == SampleType::f32 ? sample : std::round(sample));
}

Shape make_heightfield(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    const HeightFile file(context.resolve(values.text("file"), values.where("file")));
    const HeightFileInfo& info = file.info();
    if (values.has("size")) {
        const Vec2d size = values.vec2("size");
        if (size.x != info.columns || size.y != info.rows)
            throw values.problem("size", "the file has another size", fmt::format("{} x {} samples", size.x, size.y),
                                 fmt::format("{} x {}", info.columns, info.rows));
    }
    auto grid = std::make_unique<HeightGrid>(frame_of(values, info), info.columns, info.rows, info.type);
    file.read(*grid, context.progress ? [&](double share) { context.progress(share, "heights"); } : std::function<void(double)>());
    fill_gaps(values, info, *grid);
    auto surface = std::make_unique<HeightfieldSurface>(std::move(grid), info.place, values.boolean("smooth"), values.text("material"));
    surface->set_build_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return surface;
}

}  // namespace

CatalogueEntry heightfield_row()
{
    Schema schema{
        "heightfield", "Heights from an image, two triangles a cell, never a mesh. Its uv run from 0 to 1 over the samples, v to the north.", {}};
    schema.parameters = {
        {.name = "file",
         .type = ParameterType::path,
         .doc = "PNG or TIFF of 8 or 16 bits, GeoTIFF, float EXR: any image; its first channel counts. The top is the north.",
         .required = true},
        {.name = "cell",
         .type = ParameterType::vector,
         .doc = "Distance between samples: one number, or one towards east and one towards north. By default what the file says.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true,
         .min_count = 1,
         .max_count = 2},
        {.name = "height_scale",
         .type = ParameterType::length,
         .doc = "Height for a stored 1 (of integers: for a step). By default what the file says; 1 m where its numbers are heights.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "white",
         .type = ParameterType::length,
         .doc = "Height of white above black, for images of 8 or 16 unsigned bits.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "Where the south-western sample would lie at height 0.",
         .fallback = std::vector<double>{0, 0, 0},
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "centred", .type = ParameterType::boolean, .doc = "Origin is the middle of the samples instead.", .fallback = false},
        {.name = "size",
         .type = ParameterType::vector,
         .doc = "Columns and rows that the file must have; absent: any.",
         .minimum = 2,
         .min_count = 2,
         .max_count = 2},
        {.name = "no_data",
         .type = ParameterType::number,
         .doc = "Stored number that means \"not measured\". By default what a GeoTIFF says. NaN always does."},
        {.name = "fill",
         .type = ParameterType::choice,
         .doc = "Heights for what was not measured: none (an error), from around, or a level.",
         .fallback = std::string("none"),
         .choices = {"none", "around", "level"}},
        {.name = "fill_height", .type = ParameterType::length, .doc = "That level.", .fallback = 0.0, .unit = "m"},
        {.name = "smooth", .type = ParameterType::boolean, .doc = "Shading normals blended between samples.", .fallback = false},
        {.name = "material", .type = ParameterType::text, .doc = "Its material.", .fallback = std::string("ground")},
    };
    return {"heightfield", "GalinCourse", std::move(schema), make_heightfield};
}

}  // namespace hoodoo
