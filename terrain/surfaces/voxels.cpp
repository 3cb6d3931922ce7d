// A material function on a grid, traced as it is: trilinear between samples, an exact cubic in each cell, no polygons (voxels as in Jones2010).
// mu is matter where it is above `iso`; F = iso - mu (or a signed distance) is what fields/voxel_grid.h keeps, and only where the surface is. Samples
// come from a file (NumPy, OpenVDB) or from another terrain's field; edits (terrain/edit/voxel_tools.h) change them before the surface is made, among
// them the weathering that rounds blocks into goblins (Beardall2007). Around the samples there is air: every solid is closed. The geometric normal is
// the gradient in the cell; the shading normal central differences, which are continuous. Materials are those of the corners in matter of the hit's
// cell, weighed as the interpolation does. Missing: levels of detail; moving voxels;
// materials of matter that an edit adds (it is the first of the names).
#include "terrain/surfaces/voxels.h"

#include "terrain/edit/voxel_tools.h"
#include "terrain/error.h"
#include "terrain/fields/voxel_sample.h"
#include "terrain/io/voxel_file.h"
#include "terrain/march/voxel_patches.h"
#include "terrain/math/parallel.h"
#include "terrain/surfaces/refine.h"
#include "terrain/surfaces/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace hoodoo
{

namespace
{

class VoxelSurface final : public Surface
{
public:
    VoxelSurface(std::shared_ptr<const VoxelGrid> grid, const VoxelSurfaceOptions& options)
        : grid_(std::move(grid)),
          field_(grid_),
          patches_(grid_),
          normal_width_(options.normal_width * grid_->cell),
          build_seconds_(options.build_seconds)
    {
    }

    std::uint32_t patch_count(std::uint32_t) const override { return patches_.patch_count(); }
    Box3d patch_bounds(PatchId patch) const override { return patches_.patch_bounds(patch.index); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return patches_.intersect(patch.index, ray, hit); }

    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction at;
        const Refined refined = refine_crossing(field_, ray, hit.t, 1e-9, grid_->cell);
        at.t = refined.t;
        at.position = ray.at(refined.t);
        at.position_error = refined.error;
        at.geometric_normal = field_.gradient(at.position);
        if (!(at.geometric_normal.length() > 0.0)) at.geometric_normal = field_.smoothed_gradient(at.position, normal_width_);
        if (!(at.geometric_normal.length() > 0.0)) at.geometric_normal = -ray.direction;
        at.geometric_normal.normalize();
        wear(at);
        // Doubled until the field says air for certain.
        at.spawn_offset = std::max(2.0 * at.position_error, 1e-9 * grid_->cell);
        while (at.spawn_offset < grid_->cell && !(field_.value(at.position + at.geometric_normal * at.spawn_offset) > 2.0 * patches_.value_error()))
            at.spawn_offset *= 2.0;
        return at;
    }

    void dress(Interaction& at) const override { wear(at); }
    bool contains(const Vec3d& p) const override { return field_.value(p) <= 0.0; }
    std::vector<std::string> materials() const override { return grid_->names; }
    bool closed() const override { return true; }
    const Field* field() const override { return &field_; }

    SurfaceInfo info() const override
    {
        SurfaceInfo info;
        info.stack_bytes = grid_->memory_bytes();
        info.trace_bytes = patches_.memory_bytes() + field_.memory_bytes();
        info.patches = patches_.patch_count();
        info.build_seconds = build_seconds_;
        return info;
    }

private:
    void wear(Interaction& at) const
    {
        const Vec3d smooth = field_.smoothed_gradient(at.position, normal_width_);
        at.shading_normal = smooth.length() > 0.0 ? into_hemisphere(smooth.normalized(), at.geometric_normal) : at.geometric_normal;
        at.texture_point = at.position;
        if (grid_->materials) return blend(at);
        at.materials.add(0, 1.0f);
    }

    void blend(Interaction& at) const
    {
        const Vec3d q = grid_->local(at.position);
        const Index3 c{static_cast<int>(std::floor(q.x)), static_cast<int>(std::floor(q.y)), static_cast<int>(std::floor(q.z))};
        std::array<std::pair<std::uint8_t, double>, 8> seen;  // at most eight corners
        std::size_t count = 0;
        double sum = 0.0;
        for (int n = 0; n < 8; ++n) {
            const Index3 s{c[0] + (n >> 2), c[1] + ((n >> 1) & 1), c[2] + (n & 1)};
            if (!(grid_->at(s) < 0.0f)) continue;
            double weight = 1.0;
            for (int k = 0; k < 3; ++k) {
                const double u = std::clamp(q[k] - c[static_cast<std::size_t>(k)], 0.0, 1.0);
                weight *= ((n >> (2 - k)) & 1) ? u : 1.0 - u;
            }
            weight += 1e-9;  // a corner alone on the far side of the cell still says what it is
            const std::uint8_t material = grid_->materials->at(s);
            const auto known = std::find_if(seen.begin(), seen.begin() + count, [&](const auto& m) { return m.first == material; });
            if (known == seen.begin() + count) seen[count++] = {material, 0.0};
            known->second += weight;
            sum += weight;
        }
        for (std::size_t m = 0; m < count; ++m) at.materials.add(seen[m].first, static_cast<float>(seen[m].second / sum));
        if (count == 0) at.materials.add(0, 1.0f);
    }

    std::shared_ptr<const VoxelGrid> grid_;
    VoxelField field_;
    VoxelPatches patches_;
    double normal_width_, build_seconds_;
};

VoxelGrid from_file(const Values& values, const BuildContext& context)
{
    VoxelFileOptions options;
    options.array = values.text("array");
    const std::string& meaning = values.text("values");
    options.meaning = meaning == "density" ? VoxelMeaning::density : meaning == "distance" ? VoxelMeaning::distance : VoxelMeaning::automatic;
    if (values.has("iso")) options.iso = values.number("iso");
    if (values.has("cell")) options.cell = values.number("cell");
    if (values.has("origin")) options.origin = values.vec3("origin");
    options.material_array = values.text("material_array");
    options.materials = values.names("materials");
    return read_voxel_file(context.resolve(values.text("file"), values.where("file")), options, values.where("file"));
}

/// The material that most of the base shows at a point in its matter.
std::uint8_t material_at(const Surface& base, const Vec3d& p)
{
    Interaction at;
    at.position = p;
    const Vec3d slope = base.field()->gradient(p);
    at.geometric_normal = slope.length() > 0.0 ? slope.normalized() : Vec3d(0.0, 0.0, 1.0);
    base.dress(at);
    std::size_t most = 0;
    for (std::size_t m = 1; m < at.materials.count; ++m)
        if (at.materials.weight[m] > at.materials.weight[most]) most = m;
    return at.materials.index[most];
}

/// The base's material at each sample in matter of a cell that the surface crosses; `all`: at every sample in matter, for edits that lay it bare.
void take_materials(VoxelGrid& grid, const Surface& base, bool all)
{
    grid.names = base.materials();
    if (grid.names.size() < 2) return;
    const Index3& size = grid.values.size();
    grid.materials.emplace(size, std::uint8_t{0});
    const auto at = [&](const Index3& s) { return material_at(base, grid.world(Vec3d(s[0], s[1], s[2]))); };
    if (!all) {
        each_doubtful_block(grid.values, [&](const Index3& b) {
            each_crossed_cell(grid.values, b, [&](const Index3& c, const std::array<float, 8>&) {
                for (int n = 0; n < 8; ++n) {
                    const Index3 s{c[0] + (n >> 2), c[1] + ((n >> 1) & 1), c[2] + (n & 1)};
                    if (grid.at(s) < 0.0f) grid.materials->set(s, at(s));
                }
            });
        });
        return;
    }
    // Slabs of blocks: questions in parallel, answers in order.
    for (int first = 1; first < size[0] - 1; first += 8) {
        std::array<std::vector<std::uint8_t>, 8> found;
        parallel_items(8, [&](int n) {
            const int i = first + n;
            if (i >= size[0] - 1) return;
            auto& slice = found[static_cast<std::size_t>(n)];
            slice.reserve(static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]));
            for (int j = 1; j < size[1] - 1; ++j)
                for (int k = 1; k < size[2] - 1; ++k) slice.push_back(grid.at({i, j, k}) < 0.0f ? at({i, j, k}) : std::uint8_t{0});
        });
        for (int n = 0; n < 8; ++n) {
            std::size_t next = 0;
            if (found[static_cast<std::size_t>(n)].empty()) continue;
            for (int j = 1; j < size[1] - 1; ++j)
                for (int k = 1; k < size[2] - 1; ++k) {
                    const std::uint8_t material = found[static_cast<std::size_t>(n)][next++];
                    if (material != 0) grid.materials->set({first + n, j, k}, material);
                }
        }
    }
    grid.materials->prune();
}

VoxelGrid from_base(const Values& values, const BuildContext& context)
{
    const std::string& name = values.text("base");
    if (!context.base) throw values.problem("base", "there is no other terrain to sample", "the name of a terrain", "\"" + name + "\"");
    const std::shared_ptr<const Surface> base = context.base(name, values.where("base"));
    if (!base->field())
        throw values.problem("base", "this terrain cannot be sampled: it has no field", "a terrain with one field", "\"" + name + "\"");
    if (!values.has("cell")) throw values.problem("base", "voxels of a terrain need a cell", "a length `cell`");
    const double cell = values.number("cell");
    Box3d region;
    for (std::uint32_t tile = 0; tile < base->tile_count(); ++tile)
        for (std::uint32_t i = 0; i < base->patch_count(tile); ++i) region.extendBy(base->patch_bounds({tile, i}));
    region = Box3d(region.min - Vec3d(cell), region.max + Vec3d(cell));
    if (values.has("region_min")) region.min = values.vec3("region_min");
    if (values.has("region_max")) region.max = values.vec3("region_max");
    for (int k = 0; k < 3; ++k)
        if (!(region.min[k] < region.max[k]))
            throw values.problem(values.has("region_max") ? "region_max" : "base", "the region to sample is empty", "min below max");
    const Vec3d samples = region.size() / cell;
    if (!(samples.x * samples.y * samples.z < 4e9))
        throw values.problem("cell", "so many voxels cannot be sampled", "fewer than 4e9 in the region",
                             fmt::format("{:.4g} x {:.4g} x {:.4g}", samples.x, samples.y, samples.z));
    VoxelGrid grid = sample_field(*base->field(), region, cell);
    take_materials(grid, *base, !values.tables("edit").empty());
    return grid;
}

Shape make_voxels(const Values& values, const BuildContext& context)
{
    const auto start = std::chrono::steady_clock::now();
    if (values.has("file") == values.has("base"))
        throw values.problem(
            "file", values.has("file") ? "voxels come from a file or from a terrain, not from both" : "voxels come from a file or from a terrain",
            "either `file` or `base`");
    if (context.progress) context.progress(0.0, "voxels");
    VoxelGrid grid = values.has("file") ? from_file(values, context) : from_base(values, context);
    const std::vector<Values>& edits = values.tables("edit");
    for (std::size_t n = 0; n < edits.size(); ++n) {
        if (context.progress) context.progress(0.2 + 0.7 * static_cast<double>(n) / static_cast<double>(edits.size()), edits[n].variant());
        apply_voxel_edit(grid, edits[n], context.seed, n);
    }
    if (!(grid.band() > 0.0))
        throw values.problem(values.has("file") ? "file" : "base", "there is no surface in the voxels", "values on both sides of the surface");
    VoxelSurfaceOptions options{values.number("normal_width"), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
    return make_voxel_surface(std::make_shared<VoxelGrid>(std::move(grid)), options);
}

}  // namespace

std::unique_ptr<Surface> make_voxel_surface(std::shared_ptr<const VoxelGrid> grid, const VoxelSurfaceOptions& options)
{
    return std::make_unique<VoxelSurface>(std::move(grid), options);
}

CatalogueEntry voxels_row()
{
    Schema schema{
        "voxels", "A material function on a grid, from a file or sampled from another terrain: sculpted, weathered, traced without polygons.", {}};
    schema.parameters = {
        {.name = "file", .type = ParameterType::path, .doc = "A NumPy array (.npy, .npz; [x, y, z]) or an OpenVDB grid (.vdb)."},
        {.name = "array", .type = ParameterType::text, .doc = "Which one of an .npz or .vdb; by default the only one.", .fallback = std::string()},
        {.name = "values",
         .type = ParameterType::choice,
         .doc = "What the file's numbers are: density, matter above iso; distance, metres, negative in matter; auto: what a VDB says of itself, else "
                "density.",
         .fallback = std::string("auto"),
         .choices = {"auto", "density", "distance"}},
        {.name = "iso", .type = ParameterType::number, .doc = "The number at the surface: 0.5 for densities, 0 for distances by default."},
        {.name = "cell",
         .type = ParameterType::length,
         .doc = "Between neighbouring samples; 1 m by default, a VDB has its own. Required with `base`.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "origin",
         .type = ParameterType::vector,
         .doc = "Where the file's sample (0, 0, 0) stands; a VDB has its own.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "materials",
         .type = ParameterType::names,
         .doc = "Names that the numbers in `material_array` count.",
         .fallback = std::vector<std::string>{"bedrock"},
         .min_count = 1,
         .max_count = 255},
        {.name = "material_array",
         .type = ParameterType::text,
         .doc = "Array of an .npz that says the material of each voxel.",
         .fallback = std::string()},
        {.name = "base",
         .type = ParameterType::text,
         .doc = "Name of a terrain whose field is sampled instead of a file. It is not rendered itself."},
        {.name = "region_min",
         .type = ParameterType::vector,
         .doc = "Lower corner of what is sampled of it; by default all.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "region_max",
         .type = ParameterType::vector,
         .doc = "Upper corner of what is sampled of it.",
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "normal_width",
         .type = ParameterType::number,
         .doc = "Half-width of the differences that give shading normals.",
         .fallback = 0.75,
         .unit = "cell",
         .minimum = 0.01,
         .maximum = 8},
        {.name = "edit",
         .type = ParameterType::tables,
         .doc = "What happens to the voxels, in this order.",
         .discriminator = "tool",
         .items = voxel_edit_schemas()},
    };
    return {"voxels", "Jones2010", std::move(schema), make_voxels};
}

}  // namespace hoodoo
