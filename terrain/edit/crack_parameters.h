// The parameters that cracks share, whether they are an edit of layers or a terrain, and the network these describe.
#pragma once

#include "terrain/fields/crack_network.h"
#include "terrain/schema.h"

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

/// n, sites, kappa, lambda, in this order. `sites` is the default one; `kappa` the default depth, at most `kappa_most`, of which `kappa_doc` says
/// what it is a share of.
std::vector<Parameter> crack_parameters(SiteKind sites, double kappa, double kappa_most, const std::string& kappa_doc);

/// region_min and region_max: a rectangle, (x, y) of its corners in metres. `doc` says which one, and what it is without.
std::vector<Parameter> crack_region_parameters(const std::string& doc);

/// The network of a table with these parameters over a rectangle of that size (metres), from whose lower corner its places count: cracks are lambda
/// times the mean spacing sqrt(area / n) wide.
CrackNetwork crack_network(const Values& values, std::uint64_t seed, const Vec2d& size);

}  // namespace hoodoo
