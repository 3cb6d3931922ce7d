// Terrains built on demand: a warped terrain names its base, which is built first and then shared.
#include "renderer/scene/terrains.h"

#include "renderer/scene/terrain.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{
namespace
{

/// A pixel in the middle of the picture.
Viewpoint viewpoint(const Camera& camera, const Description& description)
{
    const Vec2i size(static_cast<int>(description.film.integer("width")), static_cast<int>(description.film.integer("height")));
    return {camera.eye(), camera.ray(Vec2d(0.5 * size.x, 0.5 * size.y), size, 0.0).footprint_spread};
}

/// A surface that others stand on and that is rendered too.
class SharedSurface final : public Surface
{
public:
    explicit SharedSurface(std::shared_ptr<const Surface> surface) : surface_(std::move(surface)) {}
    std::uint32_t tile_count() const override { return surface_->tile_count(); }
    std::uint32_t patch_count(std::uint32_t tile) const override { return surface_->patch_count(tile); }
    Box3d patch_bounds(PatchId patch) const override { return surface_->patch_bounds(patch); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override { return surface_->intersect(patch, ray, hit); }
    bool occluded(PatchId patch, const Ray& ray) const override { return surface_->occluded(patch, ray); }
    Interaction interact(const Ray& ray, const Hit& hit) const override { return surface_->interact(ray, hit); }
    void dress(Interaction& at) const override { surface_->dress(at); }
    bool contains(const Vec3d& p) const override { return surface_->contains(p); }
    std::vector<std::string> materials() const override { return surface_->materials(); }
    bool closed() const override { return surface_->closed(); }
    SurfaceInfo info() const override { return surface_->info(); }
    const Field* field() const override { return surface_->field(); }
    std::vector<CoarserField> coarser_fields(double width) const override { return surface_->coarser_fields(width); }
    std::vector<const Field*> fields() const override { return surface_->fields(); }
    const Height* height() const override { return surface_->height(); }
    const Instances* instances() const override { return surface_->instances(); }
    const Density* density() const override { return surface_->density(); }

private:
    std::shared_ptr<const Surface> surface_;
};

class TerrainBuilder
{
public:
    TerrainBuilder(const Description& description, const SceneOptions& options, const Camera& camera)
        : description_(description), options_(options), camera_(camera), slots_(description.terrains.size())
    {
    }

    BuiltTerrains build_all()
    {
        for (std::size_t i = 0; i < slots_.size(); ++i) build(i);
        BuiltTerrains built;
        for (std::size_t i = 0; i < slots_.size(); ++i) {
            const DescribedNode& node = description_.terrains[i];
            Slot& slot = slots_[i];
            if (!node.visible.value_or(slot.shared == nullptr)) continue;
            built.objects.push_back({node.name, node.type, {}, {}});
            built.shapes.push_back(slot.shared ? Shape(std::make_unique<SharedSurface>(slot.shared)) : std::move(*slot.shape));
        }
        return built;
    }

private:
    struct Slot {
        std::optional<Shape> shape;
        std::shared_ptr<const Surface> shared;  ///< instead of the shape, once another terrain stands on it
        bool building = false;
    };

    void build(std::size_t i)
    {
        Slot& slot = slots_[i];
        if (slot.shape || slot.shared) return;
        const DescribedNode& node = description_.terrains[i];
        const CatalogueEntry& row = terrain_row(node);
        slot.building = true;
        if (options_.progress) options_.progress(0.0, node.name);
        BuildContext context = terrain_context(node, description_, options_.threads, options_.progress);
        context.shutter = {description_.time + camera_.shutter_open(), description_.time + camera_.shutter_close()};
        context.view = viewpoint(camera_, description_);
        context.editable = options_.editable;
        context.base = [&](const std::string& name, const Source& where) { return base(name, where, node.name); };
        slot.shape = row.make(node.values, context);
        slot.building = false;
    }

    std::shared_ptr<const Surface> base(const std::string& name, const Source& where, const std::string& user)
    {
        const auto found =
            std::find_if(description_.terrains.begin(), description_.terrains.end(), [&](const DescribedNode& n) { return n.name == name; });
        if (found == description_.terrains.end()) {
            std::vector<std::string> names;
            for (const DescribedNode& node : description_.terrains)
                if (node.name != user) names.push_back(node.name);
            throw Error(ErrorKind::scene, Problem{where, "there is no terrain of this name", {}, "\"" + name + "\"", nearest_name(name, names)});
        }
        const auto i = static_cast<std::size_t>(found - description_.terrains.begin());
        if (slots_[i].building)
            throw Error(ErrorKind::scene, Problem{where, fmt::format("the terrain \"{}\" stands on itself", name), "bases without a circle", {}, {}});
        build(i);
        Slot& slot = slots_[i];
        if (!slot.shared) {
            auto* surface = std::get_if<std::unique_ptr<Surface>>(&*slot.shape);
            if (!surface)
                throw Error(ErrorKind::scene,
                            Problem{where, fmt::format("the terrain \"{}\" is a mesh", name), "a terrain with a surface of its own", {}, {}});
            slot.shared = std::move(*surface);
            slot.shape.reset();
        }
        return slot.shared;
    }

    const Description& description_;
    const SceneOptions& options_;
    const Camera& camera_;
    std::vector<Slot> slots_;
};

}  // namespace

BuiltTerrains build_terrains(const Description& description, const SceneOptions& options, const Camera& camera)
{
    return TerrainBuilder(description, options, camera).build_all();
}

}  // namespace hoodoo
