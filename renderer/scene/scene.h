// A world that can be lit: built from a Description, immutable afterwards, owner of everything in it.
#pragma once

#include "renderer/geometry/tracer.h"
#include "renderer/light/light.h"
#include "renderer/media/media.h"
#include "renderer/scene/camera.h"
#include "renderer/scene/description.h"
#include "renderer/shading/look.h"

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hoodoo
{

/// One terrain of the scene. Its index + 1 is the objectId in a picture.
struct SceneObject {
    std::string name;
    std::string type;                      ///< catalogue row
    std::vector<std::uint32_t> materials;  ///< index of MaterialWeights -> index into Scene::material_names()
    SurfaceInfo info;                      ///< of a Surface; of a mesh: trace_bytes and patches (triangles)
};

/// How a Scene is built; every member may stay empty.
struct SceneOptions {
    ColorConverter to_rendering;  ///< required as soon as the scene names a colour
    int threads = 0;
    std::function<void(double fraction, const std::string& what)> progress;
    bool brute_force = false;  ///< the oracle instead of Embree
    bool editable = false;     ///< layers may be edited afterwards
};

/// A scene made by code instead of a file. Materials without a look get the default one of their name.
struct SceneParts {
    Camera camera;
    std::vector<Light> lights;
    std::vector<SceneObject> objects;  ///< name and type; the rest is filled in
    std::vector<Shape> shapes;         ///< one an object
    std::map<std::string, std::unique_ptr<Look>> looks;
    std::map<std::string, Interior> interiors;  ///< of materials that light passes; one without look that is called water has clear water
    Media media;
};

class ColumnSet;
class EditableSurface;

/// Thread-safe, but for follow_edit().
class Scene
{
public:
    /// Throws Error (scene, file, memory) before the first ray.
    Scene(const Description& description, const SceneOptions& options);
    Scene(SceneParts parts, const SceneOptions& options);

    const Camera& camera() const { return camera_; }
    const std::vector<Light>& lights() const { return lights_; }
    const std::vector<SceneObject>& objects() const { return objects_; }
    const std::vector<std::string>& material_names() const { return material_names_; }
    const std::vector<Shape>& shapes() const { return shapes_; }
    const Tracer& tracer() const { return *tracer_; }

    /// Albedo, roughness, normal and coat at an interaction: the materials blended by their visible shares.
    Appearance appearance(std::uint32_t object, const Interaction& at, double footprint) const;

    /// What lies under the surface there, if light passes one of the materials seen; nullptr where none lets it. `share` becomes that material's
    /// part of what is seen, `which` its place in at.materials.
    const Interior* interior(std::uint32_t object, const Interaction& at, float* share = nullptr, std::size_t* which = nullptr) const;

    /// What the camera's eye is in at a time in [0, 1] of the shutter, to the nearer end of it; nullptr: air.
    const Interior* around_eye(double time) const { return around_eye_[time < 0.5 ? 0 : 1]; }

    const Media& media() const { return media_; }

    /// Whether there is nothing but air without haze, and surfaces that no light passes.
    bool is_plain() const { return plain_; }

    bool editable() const { return editable_; }
    /// The surface of an object whose layers may be edited; nullptr if they may not.
    EditableSurface* editable_surface(std::uint32_t object);
    /// The layers of editable_surface(object) were edited there and nowhere else. Not while others use the scene. Throws Error (memory); Error
    /// (scene) if the camera stands inside the ground now: all else is done then.
    void follow_edit(std::uint32_t object, const ColumnSet& changed);

    /// Union of the objects' bounds, metres; a side that is infinite does not count. Empty without objects. Edits only widen
    /// it.
    const Box3d& bounds() const { return bounds_; }

private:
    void name_materials(SceneParts& parts, const SceneOptions& options);
    void describe_objects();
    void describe(std::uint32_t object);
    void extend_bounds(const Surface& surface, std::uint32_t tile);
    void extend_bounds(const Instances& instances);
    void find_eye();
    const Interior* around(const Vec3d& eye, double time) const;

    Camera camera_;
    std::vector<Light> lights_;
    std::vector<Shape> shapes_;
    std::vector<SceneObject> objects_;
    std::vector<std::string> material_names_;
    std::vector<std::unique_ptr<Look>> looks_;
    std::vector<std::optional<Interior>> interiors_;  ///< as looks_
    Media media_;
    bool plain_ = true;
    std::array<const Interior*, 2> around_eye_{};
    std::unique_ptr<Tracer> tracer_;
    Box3d bounds_;
    bool editable_ = false;
};

}  // namespace hoodoo
