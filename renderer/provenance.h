// Where a picture comes from: everything its header states so that it can be understood, compared and made again.
#pragma once

#include "renderer/film/film.h"
#include "renderer/render.h"

#include <map>
#include <string>

namespace hoodoo
{

/// The header of the picture that `film` holds. Standard attributes under their standard names; our own begin with "hoodoo:". No paths of files,
/// nothing that names a person or a machine beyond its processor; hoodoo:renderTime (seconds) and hoodoo:memory (peak of the process, MB) only if
/// asked for.
std::map<std::string, Attribute> provenance(const LoadedScene& loaded, const RenderOptions& options, const Film& film, std::uint64_t seed,
                                            double render_seconds);

}  // namespace hoodoo
