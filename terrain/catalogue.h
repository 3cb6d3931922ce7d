// The list of terrain representations: open catalogue.cpp first. One row each; everything outsiders see follows from the row's schema.
#pragma once

#include "terrain/schema.h"
#include "terrain/shape.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace hoodoo
{

/// Where a scene is seen from: what level of detail goes by.
struct Viewpoint {
    Vec3d eye{0.0};
    double spread = 0.0;  ///< width of a pixel's cone a metre of distance
};

/// What a factory may use beside its parameters.
struct BuildContext {
    std::string name;        ///< the node's name in the scene
    std::uint64_t seed = 0;  ///< hashed from that name (or the node's own `seed`)
    int threads = 0;         ///< 0 = all of the current TBB arena
    /// Seconds of the scene's time at which Ray::time is 0 and 1: the shutter's opening and closing. What moves is a function of that time.
    std::array<double, 2> shutter{0.0, 0.0};
    /// A file named in a scene -> the path to open. Confined to the declared roots; throws Error at `where` if it is outside or absent.
    std::function<std::string(const std::string& path, const Source& where)> resolve = [](const std::string& p, const Source&) { return p; };
    std::function<void(double fraction, const std::string& what)> progress;  ///< may be empty
    /// Another terrain of the scene by name, for a representation that stands on one; it is then not rendered itself. Throws Error at `where` if
    /// there is none, if it is a mesh, or if it stands on this one. Empty: there are no other terrains.
    std::function<std::shared_ptr<const Surface>(const std::string& name, const Source& where)> base;
    std::optional<Viewpoint> view;  ///< absent: full detail everywhere
    bool editable = false;          ///< ready for edits of its layers: for materials too that it has none of yet
};

class MaterialStack;

struct CatalogueEntry {
    std::string name;   ///< the `type` of a [terrain.NAME] table
    std::string paper;  ///< key in references.bib
    Schema schema;
    std::function<Shape(const Values&, const BuildContext&)> make;
    /// The layers the shape stands on, without building it; empty for a row that stands on none.
    std::function<std::shared_ptr<MaterialStack>(const Values&, const BuildContext&)> stack = {};
};

/// All rows, in a fixed order. Built once, thread-safe.
std::span<const CatalogueEntry> catalogue();

/// The row called `name`, or nullptr.
const CatalogueEntry* find_in_catalogue(const std::string& name);

}  // namespace hoodoo
