// The list of terrain representations: open catalogue.cpp first. One row each; everything outsiders see follows from the row's schema.
#pragma once

#include "terrain/schema.h"
#include "terrain/shape.h"

#include <array>
#include <functional>
#include <span>
#include <string>

namespace hoodoo
{

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
