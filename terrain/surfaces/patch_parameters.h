// What every surface that is met in field patches (march/field_patches.h) lets a scene say about the search.
#pragma once

#include "terrain/march/field_patches.h"
#include "terrain/schema.h"

namespace hoodoo
{

/// `mode` and `epsilon`; the area's default in square metres, measured where `where` says.
std::vector<Parameter> search_parameters(const std::string& where, double epsilon);

/// Puts what they say into the settings.
void read_search(const Values& values, PatchSettings& settings);

}  // namespace hoodoo
