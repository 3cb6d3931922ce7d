// Any height over the plane as a surface: certified patches, one material, the height's own normals.
#pragma once

#include "terrain/fields/height.h"
#include "terrain/march/field_patches.h"
#include "terrain/schema.h"

#include <memory>
#include <string>

namespace hoodoo
{

struct HeightSurfaceSettings {
    Box2d area;                      ///< what is traced, finite
    Vec2d focus{0.0};                ///< patches grow with the distance from here
    double patch = 1.0;              ///< metres: of a patch there
    double growth = 0.0;             ///< metres a metre
    double texture = 1.0;            ///< metres for 1 of uv
    std::uint64_t stored_bytes = 0;  ///< memory of the height itself
    std::string material = "ground";
};

/// Throws Error (memory) if there would be too many patches.
std::unique_ptr<Surface> make_height_surface(std::unique_ptr<const Height> height, const HeightSurfaceSettings& settings);

/// `centre`, `extent`, `patch`, `growth`, `material`.
std::vector<Parameter> height_surface_parameters(double extent);

struct Viewpoint;
/// Reads them; without a centre it is the eye's place, else `middle`. `patch` falls back to `usual`.
HeightSurfaceSettings read_height_surface(const Values& values, const Viewpoint* view, const Vec2d& middle, double usual);

}  // namespace hoodoo
