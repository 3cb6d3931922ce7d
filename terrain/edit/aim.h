// What tools that work on the bedrock's surface share: its field, and how a scene points at it.
#pragma once

#include "terrain/edit/tools.h"
#include "terrain/stack/convolution.h"

#include <functional>
#include <vector>

namespace hoodoo
{

/// Bedrock alone, its edge columns repeated for ever. Refers to the stack, which must outlive it.
Ground bedrock_of(const MaterialStack& stack);

/// Unit, towards air: central differences over half a kernel, since the field has creases.
Vec3d surface_normal(const ConvolutionField& field, const Vec3d& p);

/// `sigma` and `along`, for the schema of a tool that calls the functions below.
std::vector<Parameter> aim_parameters();

/// Half-width of the kernel, metres: the edit's `sigma`, else the terrain's, else one cell. Throws Error (scene) if it is too wide.
double kernel_of(const MaterialStack& stack, const Values& edit, const EditContext& context);

/// The point of the bedrock's surface that `target`, an entry of the parameter `key`, stands for: along the edit's `along` if it is given (backwards
/// if the target lies in rock), else nearby. Throws Error (scene) if the target does not lie over or under the grid, or if nothing is met.
Vec3d aim(const MaterialStack& stack, double sigma, const Values& edit, const std::string& key, const Vec3d& target);

/// The same without asking where the target lies: beyond the grid its edge columns go on.
Vec3d onto_surface(const ConvolutionField& field, const Values& edit, const std::string& key, const Vec3d& target);

/// Calls `work`; what it throws without a place gets that of the edit's `key`.
void placed(const Values& edit, const std::string& key, const std::function<void()>& work);

}  // namespace hoodoo
