// One edit of a living scene: the layers change, then whatever read the columns that changed.
//
// The hash that names the scene in a picture's header takes up every edit.
#include "renderer/edit.h"

#include "renderer/scene/read.h"
#include "renderer/scene/terrain.h"
#include "terrain/editable.h"
#include "terrain/math/hash.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

ColumnSet edit_scene(LoadedScene& loaded, const std::string& terrain, const std::string& tool, const Node& parameters)
{
    const DescribedNode& node = choose_terrain(loaded.description, terrain);
    const auto problem = [&](const std::string& what, const std::string& expected) {
        return Error(ErrorKind::scene, Problem{node.where, what, expected, {}, {}});
    };
    if (!loaded.scene->editable()) throw problem("this scene was not loaded for edits", "a scene loaded with editable = true");
    const auto& objects = loaded.scene->objects();
    const auto object = static_cast<std::uint32_t>(
        std::find_if(objects.begin(), objects.end(), [&](const SceneObject& o) { return o.name == node.name; }) - objects.begin());
    EditableSurface* surface = object < objects.size() ? loaded.scene->editable_surface(object) : nullptr;
    if (!surface)
        throw problem(fmt::format("the terrain \"{}\" cannot be edited", node.name),
                      "type = \"convolution\", and no other terrain that stands on it");

    ColumnSet changed = surface->edit(tool, parameters);
    Node named;
    named.value = Node::Table{{node.name + "." + tool, parameters}};
    loaded.description.hash = hash_combine(loaded.description.hash, hash_of(named, 0));
    loaded.scene->follow_edit(object, changed);
    return changed;
}

}  // namespace hoodoo
