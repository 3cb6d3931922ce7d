// What a named material looks like at a point: albedo, roughness, normal, from textures or procedures, projected triplanar or by uv.
#pragma once

#include "terrain/schema.h"
#include "terrain/surface.h"

#include <functional>
#include <memory>
#include <string>

namespace hoodoo
{

/// Schema of a [material.NAME] table.
const Schema& material_schema();

/// A colour as written in the scene -> the rendering space (three channels, linear). Given by the renderer, which owns colour management.
using ColorConverter = std::function<Vec3f(const ColorValue&)>;

/// What the light needs to know of a surface at one point. All in the rendering space.
struct Appearance {
    Vec3f albedo{0.5f};      ///< single-scattering albedo of the diffuse model, each channel in [0, 1]
    float roughness = 0.0f;  ///< of the rough diffuse model, in [0, 1]; 0 is Lambert
    Vec3d normal{0, 0, 1};   ///< unit, world space: the shading normal with bump applied, in the hemisphere of the geometric normal
    float coat = 0.0f;       ///< share of the surface under a smooth film of water, in [0, 1]
};

/// How one material of a scene looks. Immutable, thread-safe.
class Look
{
public:
    virtual ~Look() = default;
    /// `footprint` is the width in metres that one lookup should average over.
    virtual Appearance appearance(const Interaction& at, double footprint) const = 0;
};

/// Where texture files come from, as BuildContext::resolve.
using PathResolver = std::function<std::string(const std::string& path, const Source& where)>;

/// `name` ("sand", "bedrock", ...) chooses the procedural look that a table leaves out, and the seed of its variation.
std::unique_ptr<Look> make_look(const std::string& name, const Values& values, const ColorConverter& to_rendering, const PathResolver& resolve);

/// The look of a material that the scene names nowhere.
std::unique_ptr<Look> default_look(const std::string& name, const ColorConverter& to_rendering);

}  // namespace hoodoo
