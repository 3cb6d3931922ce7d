// [[node]] tables of a scene -> a blob tree.
#pragma once

#include "terrain/catalogue.h"
#include "terrain/fields/blob_tree.h"

#include <memory>
#include <string>
#include <vector>

namespace hoodoo
{

/// One schema for each kind of node.
std::vector<Schema> implicit_node_schemas();

struct ImplicitTree {
    BlobPtr root;
    std::vector<std::string> materials;                    ///< named by nodes: what BlobShares count
    std::vector<std::shared_ptr<const Surface>> terrains;  ///< what kTerrain + n counts
    Box3d primitives;                                      ///< of all skeletal primitives, and of terrains that end on all sides
    Box3d ground;                                          ///< of all terrains' patches; empty without
    bool open = false;                                     ///< some terrain does not end on all sides
};

/// The tree of the row's tables `node`; `root` names its top, or is empty: the last one. Throws Error (scene) at what cannot be: a name twice or
/// unknown, a circle, a node that nothing uses, shapes without size, terrains without a field.
ImplicitTree make_implicit_tree(const Values& row, const BuildContext& context);

}  // namespace hoodoo
